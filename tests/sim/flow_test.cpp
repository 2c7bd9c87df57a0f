// Bodies that keep dents and bodies that creep (model/flow_step.h), against closed-form answers: a bar that is pulled
// and let go, one that hangs, and a block that is held sheared. And what every flow must leave alone: volume, momentum,
// the balance of energy, and forces as derivatives of energies.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "geometry/tetrahedra/tetrahedralize.h"
#include "geometry/triangles/surface_thickness.h"
#include "sim/elements/element_flow.h"
#include "sim/measures/energies.h"
#include "sim/measures/fields.h"
#include "sim/measures/measures.h"
#include "sim/model/flow_step.h"
#include "support/bodies.h"
#include "support/deformations.h"

namespace supple {
namespace flow_test {

const Lame lame = Lame::from_young(1e6, 0.3);
const Plasticity soft_metal{2e3, 1e5};  // [Pa]: yields at a strain of 0.002, and hardens by a tenth of E
const Creep jelly{0.6, 1000};           // [1], [s]

std::vector<std::int32_t> vertices_where(const Positions& rest, const std::function<bool(const Vec3&)>& is_one) {
  std::vector<std::int32_t> list;
  for (std::int32_t v = 0; v < rest.rows(); ++v)
    if (is_one(rest.row(v).transpose())) list.push_back(v);
  return list;
}

// Makes steps that are so long that inertia hardly resists, each followed by its flow.
struct Slow {
  Model model;
  StepInputs inputs;
  State state;
  OpenWorkspace w;
  std::vector<double> scratch;

  explicit Slow(const BodyDescription& body)
      : model(build_model(body)), inputs(test::still_inputs(model)), state(rest_state(model)) {
    inputs.gravity.setZero();
    inputs.solver.iterations = 500;
  }

  // Makes a step and returns the elastic energy that flow took afterwards [J].
  double step() {
    EXPECT_FALSE(supple::step(model, inputs, state, w).failed);
    state.v.setZero();
    const double before = state.flow.lost;
    let_flow(model, state, nullptr, scratch);
    return state.flow.lost - before;
  }

  // Returns the force along an axis that the body exerts on the held vertices of some places [N].
  double held_force(int axis, const std::function<bool(const Vec3&)>& is_one) {
    Positions back = state.x;
    for (int v = 0; v < model.vertices; ++v)
      if (is_one(model.rest.row(v).transpose())) back(v, axis) -= 1;
    return work_on_held(model, w, state.x, back);
  }
};

BodyDescription long_bar(const Material& material) {
  BodyDescription body;
  body.name = "bar";
  body.mesh = box_mesh(Vec3(1, 0.1, 0.1), {20, 2, 2});
  body.materials = {material};
  body.precision = Precision::double_precision;
  body.time_step = 50;
  body.handles.push_back({"left", vertices_where(body.mesh.rest, [](const Vec3& p) { return p.x() < 1e-9; }), 0});
  return body;
}

// Returns the logarithmic strain of the middle of a bar along its length.
double middle_strain(const Slow& bar) {
  double from = 0, to = 0;
  int count = 0;
  for (int v = 0; v < bar.model.vertices; ++v) {
    if (std::abs(bar.model.rest(v, 0) - 0.4) < 1e-9) from += bar.state.x(v, 0), ++count;
    if (std::abs(bar.model.rest(v, 0) - 0.6) < 1e-9) to += bar.state.x(v, 0);
  }
  return std::log((to - from) / count / 0.2);
}

TEST(Flow, APulledBarFollowsTheCurveOfLinearHardeningAndKeepsItsSet) {
  for (const Material& material :
       {Material(NeoHookean{lame.mu, lame.lambda}), Material(Corotated{lame.mu, lame.lambda}),
        Material(StVenantKirchhoff{lame.mu, lame.lambda})}) {
    BodyDescription body = long_bar(material);
    body.plastic = soft_metal;
    const auto is_right = [](const Vec3& p) { return p.x() > 1 - 1e-9; };
    body.handles.push_back({"right", vertices_where(body.mesh.rest, is_right), 0});
    Slow bar(body);
    const Positions at_rest = bar.inputs.targets;
    double stress = 0, strain = 0;
    const auto pull = [&](double stretch) {
      for (std::size_t i = 0; i < bar.model.handled.size(); ++i)
        if (bar.model.handled[i].handle == 1)
          bar.inputs.targets(Eigen::Index(i), 0) = at_rest(Eigen::Index(i), 0) + stretch;
      for (int i = 0; i < 40; ++i) EXPECT_GE(bar.step(), 0.0);
      strain = middle_strain(bar);
      // Kirchhoff's stress along a bar is the force over the section at rest, times the stretch.
      stress = bar.held_force(0, is_right) / 0.01 * std::exp(strain);
    };
    const auto expected = [&](double at) {  // while it is pulled
      const double yield = soft_metal.yield, hardening = soft_metal.hardening, young = 1e6;
      return at < yield / young ? young * at : (yield + hardening * at) / (1 + hardening / young);
    };
    pull(0.001);
    EXPECT_NEAR(stress / expected(strain), 1, 0.02) << name_of(material);
    EXPECT_EQ(bar.state.flow.lost, 0) << "below the yield stress";
    for (const double stretch : {0.004, 0.01, 0.02, 0.03}) {
      pull(stretch);
      EXPECT_NEAR(stress / expected(strain), 1, 0.02) << name_of(material) << " at " << stretch;
    }
    // Let go, it keeps what was beyond the elastic strain.
    const double set = strain - expected(strain) / 1e6, lost = bar.state.flow.lost;
    body.handles.pop_back();
    Slow released(body);
    released.state.x = bar.state.x;
    for (int v = 0; v < released.model.vertices; ++v)
      released.state.x.row(v) = bar.state.x.row(bar.model.internal_of[released.model.input_of[v]]);
    released.state.flow = bar.state.flow;
    released.state.time = bar.state.time;
    show_flow(released.state.flow, released.model);
    for (int i = 0; i < 10; ++i) released.step();
    EXPECT_NEAR(middle_strain(released) / set, 1, 0.02) << name_of(material);
    EXPECT_GE(released.state.flow.lost, lost);
    for (std::size_t e = 0; e < bar.state.flow.hardened.size(); ++e)
      EXPECT_NEAR(Eigen::Map<const Mat3>(&bar.state.flow.plastic[9 * e]).determinant(), 1, 1e-10);
  }
}

TEST(Flow, TheReturnMappingEndsOnTheYieldSurfaceAndNeverBeyondTheLimit) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.6, 1.6), rest(0, 0.5);
  for (const Material& material : test::all_materials()) {
    std::visit(
        [&](const auto& one) {
          int flowed = 0;
          for (int i = 0; i < 200; ++i) {
            const double s[3] = {uniform(random), uniform(random), uniform(random)};
            const LogStrains strains(s);
            const StressAtStrains before = stress_at(one, strains, 0);
            Plasticity rule{0.5 * before.equivalent + 1e-9, 0.2 * before.equivalent};
            const double hardened = rest(random), share = plastic_share(one, rule, 1.0, strains, hardened);
            ASSERT_GE(share, 0);
            ASSERT_LE(share, 1);
            if (share == 0) continue;
            ++flowed;
            const StressAtStrains after = stress_at(one, strains, share);
            const double more = share * std::sqrt(2.0 / 3) * strains.length();
            EXPECT_NEAR(after.equivalent, rule.yield + rule.hardening * (hardened + more), 1e-6 * rule.yield)
                << name_of(material);
            EXPECT_LE(after.density, before.density) << name_of(material);
            rule.limit = hardened + 0.5 * more;
            EXPECT_NEAR(plastic_share(one, rule, 1.0, strains, hardened), 0.5 * share, 1e-9);
            rule.limit = 0.5 * hardened;
            EXPECT_EQ(plastic_share(one, rule, 1.0, strains, hardened), 0);
          }
          EXPECT_GT(flowed, 50) << name_of(material);
        },
        material);
  }
}

TEST(Flow, TheStressOfASheetThatIsHeldShearedRelaxesAsTheMaxwellArmSays) {
  BodyDescription body;
  body.name = "block";
  body.mesh = box_mesh(Vec3(0.1, 0.1, 0.1), {2, 2, 2});
  body.materials = {NeoHookean{lame.mu, lame.lambda}};
  body.precision = Precision::double_precision;
  body.creep = jelly;
  body.handles.push_back(
      {"faces",
       vertices_where(body.mesh.rest, [](const Vec3& p) { return (p - Vec3(0.05, 0.05, 0.05)).norm() > 1e-9; }), 0});
  const auto is_top = [](const Vec3& p) { return p.y() > 0.1 - 1e-9; };
  for (const double steps_a_time : {4.0, 20.0}) {
    body.time_step = jelly.time / steps_a_time;
    Slow block(body);
    for (std::size_t i = 0; i < block.model.handled.size(); ++i)
      block.inputs.targets(Eigen::Index(i), 0) += 1e-3 * block.model.rest(block.model.handled[i].vertex, 1);
    EXPECT_GT(block.step(), 0) << "relaxing loses energy";
    // The flow of the first step has gone by.
    const double whole = lame.mu * 1e-3 * 0.01;  // G times the strain and the face
    for (int i = 1; i <= int(2 * steps_a_time); ++i) {
      const double expected = whole * (1 - jelly.share + jelly.share * std::exp(-i / steps_a_time));
      EXPECT_NEAR(block.held_force(0, is_top) / expected, 1, 0.02) << i << " of " << steps_a_time;
      EXPECT_GE(block.step(), 0);
    }
  }
}

TEST(Flow, AHangingBarCreepsAsTheStandardLinearSolidSays) {
  for (const double steps_a_time : {5.0, 20.0}) {
    BodyDescription body = long_bar(NeoHookean{lame.mu, lame.lambda});
    body.creep = jelly;
    body.time_step = jelly.time / steps_a_time;
    Slow bar(body);
    bar.inputs.gravity = Vec3(1, 0, 0);
    const double stress = 1000 * 0.5, bulk = lame.lambda + 2.0 / 3 * lame.mu, share = jelly.share;  // in the middle
    for (int i = 0; i <= int(4 * steps_a_time); ++i) {
      bar.step();
      const double time = i / steps_a_time;
      const double shear = (1 - share * std::exp(-(1 - share) * time)) / ((1 - share) * lame.mu);
      EXPECT_NEAR(middle_strain(bar) / (stress * (1 / (9 * bulk) + shear / 3)), 1, 0.02) << time;
    }
  }
}

// Returns a body that flows in both ways, thrown so that it yields.
BodyDescription thrown_body(const Material& material) {
  BodyDescription body = test::bar(material, test::Held::nothing);
  body.plastic = Plasticity{1e2, 1e3};
  body.creep = Creep{0.4, 0.1};
  return body;
}

TEST(Flow, ForcesAreDerivativesOfEnergiesAndPushNothingAsAWhole) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.1);
  for (const Material& material : test::all_materials()) {
    Model model = build_model(thrown_body(material));
    State state = rest_state(model);
    for (std::vector<double>* list : {&state.flow.plastic, &state.flow.viscous}) {
      for (std::size_t e = 0; e < list->size() / 9; ++e) {
        Mat3 kept = Mat3::Identity() + Mat3::NullaryExpr([&] { return normal(random); });
        kept /= std::cbrt(kept.determinant());
        for (int i = 0; i < 9; ++i) (*list)[9 * e + std::size_t(i)] = kept(i / 3, i % 3);
      }
    }
    show_flow(state.flow, model);
    StepInputs inputs = test::still_inputs(model);
    inputs.gravity.setZero();
    OpenWorkspace w;
    w.prepare(model, inputs.solver);
    state.x = test::shaken(model.rest, 0.01, 8);
    w.y = w.current.x = state.x;  // inertia adds nothing
    w.direction = test::shaken(Positions::Zero(model.free, 3), 1, 9);
    evaluate(model, w, w.current, Wanted::gradient);
    const Positions gradient = w.current.gradient;
    const double slope = (gradient.array() * w.direction.array()).sum();
    double best = 1e300;
    for (const double h : {1e-5, 1e-6, 1e-7}) {
      const double up = elastic_energy(model, w, state.x + h * w.direction),
                   down = elastic_energy(model, w, state.x - h * w.direction);
      best = std::min(best, std::abs((up - down) / (2 * h) - slope));
    }
    EXPECT_LT(best, 1e-6 * std::abs(slope)) << name_of(material);
    Vec3 torque = Vec3::Zero();
    for (int v = 0; v < model.free; ++v)
      torque += Vec3(state.x.row(v).transpose()).cross(Vec3(gradient.row(v).transpose()));
    EXPECT_LT(gradient.colwise().sum().norm(), 1e-12 * gradient.norm()) << name_of(material);
    EXPECT_LT(torque.norm(), 1e-12 * gradient.norm()) << name_of(material);
  }
}

struct Thrown {
  Model model;
  StepInputs inputs;
  State state;
  OpenWorkspace w;
  std::vector<double> scratch;

  explicit Thrown(const BodyDescription& body, const Mat3& turn = Mat3::Identity())
      : model(build_model(body)), inputs(test::still_inputs(model)), state(rest_state(model)) {
    inputs.gravity.setZero();
    const Positions from = model.rest * turn;  // as it was before it was turned
    state.v.col(0) = 8 * from.col(0);
    state.v.col(1) = 6 * from.col(0);
    state.v *= turn.transpose();
  }
  void play(int steps) {
    for (int i = 0; i < steps; ++i) {
      let_flow(model, state, nullptr, scratch);
      ASSERT_FALSE(step(model, inputs, state, w).failed);
    }
  }
};

TEST(Flow, LeavesEveryVertexWhereItIsAndKeepsItsVolume) {
  for (const Material& material : test::all_materials()) {
    Thrown body(thrown_body(material));
    body.play(10);
    const State before = body.state;
    let_flow(body.model, body.state, nullptr, body.scratch);
    EXPECT_GT(body.state.flow.lost, before.flow.lost) << name_of(material);
    EXPECT_EQ(body.state.x, before.x);
    EXPECT_EQ(body.state.v, before.v);
    const State after = body.state;
    let_flow(body.model, body.state, nullptr, body.scratch);
    EXPECT_EQ(state_hash(body.model, body.state), state_hash(body.model, after)) << "no time has gone by";
    for (const std::vector<double>* list : {&after.flow.plastic, &after.flow.viscous})
      for (std::size_t e = 0; e < list->size() / 9; ++e)
        EXPECT_NEAR(Eigen::Map<const Mat3>(&(*list)[9 * e]).determinant(), 1, 1e-10);
  }
}

TEST(Flow, ATurnedBodyFlowsAsTheOtherOne) {
  std::mt19937 random(2);
  const Mat3 turn = test::random_rotation(random);
  BodyDescription body = thrown_body(NeoHookean{1e4, 2e4}), turned = body;
  turned.mesh.rest = body.mesh.rest * turn.transpose();
  Thrown plain(body), other(turned, turn);
  for (Thrown* one : {&plain, &other}) {
    one->inputs.solver.iterations = 200;
    one->play(20);
  }
  EXPECT_GT(plain.state.flow.lost, 0);
  EXPECT_NEAR(other.state.flow.lost / plain.state.flow.lost, 1, 1e-4);
  EXPECT_LT((other.state.x * turn - plain.state.x).cwiseAbs().maxCoeff(), 1e-4 * plain.model.size);
}

TEST(Flow, IsMissingInTheBalanceOfEnergyAndGivesNoneInAnyStep) {
  for (const Material& material : test::all_materials()) {
    Thrown body(thrown_body(material));
    EnergyBudget budget;
    body.w.prepare(body.model, body.inputs.solver);
    budget.start(body.model, body.inputs, body.state, body.w);
    const double whole = budget.balance().total;
    double lost = 0, own = whole;
    for (int i = 0; i < 40; ++i) {
      const double before = elastic_energy(body.model, body.w, body.state.x);
      let_flow(body.model, body.state, nullptr, body.scratch);
      const double after = elastic_energy(body.model, body.w, body.state.x);
      EXPECT_NEAR(before - after, body.state.flow.lost - lost, 1e-9 * whole) << name_of(material);
      budget.before_step(body.model, body.inputs, body.state, body.w);
      EXPECT_GE(body.state.flow.lost, lost) << name_of(material);
      lost = body.state.flow.lost;
      const Positions q = body.state.x;
      ASSERT_FALSE(step(body.model, body.inputs, body.state, body.w).failed);
      budget.after_step(body.model, body.inputs, q, body.state, body.w);
      const EnergyBalance& balance = budget.balance();
      EXPECT_NEAR(balance.put_in, 0, 1e-9 * whole) << name_of(material);
      EXPECT_EQ(balance.flowed, lost);
      own = balance.total;
    }
    EXPECT_GT(lost, 0.01 * whole) << name_of(material);
    EXPECT_LE(own + lost, whole * (1 + 1e-3)) << name_of(material);
  }
}

TEST(Flow, StressInFieldsIsThatOfTheElementsAndTheirArms) {
  BodyDescription body = test::bar(NeoHookean{lame.mu, lame.lambda}, test::Held::nothing), creeping = body;
  creeping.creep = jelly;
  Model plain = build_model(body), both = build_model(creeping);
  const Positions x = test::shaken(plain.rest, 0.005, 4);
  const ElementFields one = element_fields(plain, x), two = element_fields(both, x);
  ASSERT_EQ(one.von_mises.size(), two.von_mises.size());
  for (std::size_t e = 0; e < one.von_mises.size(); ++e) {
    EXPECT_NEAR(two.von_mises[e] / one.von_mises[e], 1, 1e-9) << "nothing has flowed";
    EXPECT_NEAR(two.energy[e] / one.energy[e], 1, 1e-9);
  }
  EXPECT_EQ(deformation(both, x).stretch, deformation(plain, x).stretch);
  EXPECT_NEAR(both.strain_stiffness / plain.strain_stiffness, 1, 1e-12);
  EXPECT_LT((Eigen::MatrixXd(both.matrix) - Eigen::MatrixXd(plain.matrix)).norm(),
            1e-12 * Eigen::MatrixXd(plain.matrix).norm())
      << "A is that of the whole stiffness";
  // Long after, only the elastic share is left.
  State state = rest_state(both);
  state.x = x;
  state.time = 100 * jelly.time;
  std::vector<double> scratch;
  let_flow(both, state, nullptr, scratch);
  const ElementFields late = element_fields(both, x);
  const double bulk_free = 1e-3;  // the arm keeps its pressure, which von Mises does not see
  for (std::size_t e = 0; e < late.von_mises.size(); ++e)
    EXPECT_NEAR(late.von_mises[e] / one.von_mises[e], 1 - jelly.share, bulk_free + 0.05);
}

}  // namespace flow_test
}  // namespace supple
