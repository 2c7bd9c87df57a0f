// Tests every element kind with every material: forces against differences of energies, and against the requirements of
// rigid motion, Newton's third law and the conservation of angular momentum. The table of the worst errors is kept in
// docs/derivatives.md.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <fstream>
#include <functional>
#include <iostream>
#include <set>

#include "sim/elements/element.h"
#include "support/bodies.h"
#include "support/deformations.h"
#include "support/places.h"

namespace supple {
namespace derivative_table_test {

using test::kinds;
using test::random_rotation;
using test::uniform;

// Describes an element by its energy and its force on all corners, at a deformation gradient applied to its rest shape.
using Corners = Eigen::Matrix<double, Eigen::Dynamic, 3>;
struct Subject {
  std::string element, material;
  Corners rest;
  std::function<double(const Corners&, Corners*)> energy;
  double scale;  // of forces [N]
};

template <class Formula, int corners = Formula::corners, int fields = Formula::fields>
double evaluate_one(const Formula& formula, const double (&field)[fields], const Corners& x, Corners* force) {
  double at[corners][3], out[corners - 1][3];
  for (int k = 0; k < corners; ++k) {
    for (int c = 0; c < 3; ++c) at[k][c] = x(k, c);
  }
  const double energy = formula.energy(at, field, out);
  if (force != nullptr) {
    force->setZero(corners, 3);
    for (int k = 0; k < corners - 1; ++k) {
      for (int c = 0; c < 3; ++c) {
        (*force)(k + 1, c) += out[k][c];
        (*force)(0, c) -= out[k][c];
      }
    }
  }
  return energy;
}

Subject tetrahedron(const Material& material, const std::optional<Fibre>& fibre) {
  Corners rest(4, 3);
  rest << 0.1, 0.2, -0.1, 1.1, 0.3, 0, 0.2, 1.1, 0.1, 0, 0.1, 0.9;
  double corner[4][3];
  for (int k = 0; k < 4; ++k) {
    for (int c = 0; c < 3; ++c) corner[k][c] = rest(k, c);
  }
  std::array<double, Tetrahedron::fields> field;
  double filled[Tetrahedron::fields];
  Tetrahedron::fill(corner, filled);
  std::copy(filled, filled + Tetrahedron::fields, field.begin());
  const auto energy = [material, fibre, field](const Corners& x, Corners* force) {
    double f[Tetrahedron::fields];
    std::copy(field.begin(), field.end(), f);
    return std::visit(
        [&]<class M>(const M& m) {
          return fibre ? evaluate_one(TetrahedronFormula<M, true>(m, &*fibre), f, x, force)
                       : evaluate_one(TetrahedronFormula<M, false>(m, nullptr), f, x, force);
        },
        material);
  };
  return {"tetrahedron", std::string(name_of(material)) + (fibre ? " + fibre" : ""), rest, energy, 1e4 / 6};
}

Subject spring() {
  Corners rest(2, 3);
  rest << 0, 0, 0, 0.6, 0.8, 0;
  const auto energy = [](const Corners& x, Corners* force) {
    const double field[2] = {1, 1e4};
    return evaluate_one(SpringElement{}, field, x, force);
  };
  return {"spring", "cloth", rest, energy, 1e4};
}

Subject triangle(const Membrane& membrane) {
  Corners rest(3, 3);
  rest << 0, 0, 0, 0.9, 0.1, 0, 0.2, 1.1, 0;
  std::array<double, Triangle::fields> field;
  double filled[Triangle::fields];
  Triangle::fill({0.9, 0.2, 0.1, 1.1}, filled);
  std::copy(filled, filled + Triangle::fields, field.begin());
  const auto energy = [membrane, field](const Corners& x, Corners* force) {
    double f[Triangle::fields];
    std::copy(field.begin(), field.end(), f);
    return std::visit([&]<class M>(const M& m) { return evaluate_one(TriangleFormula<M>(m), f, x, force); }, membrane);
  };
  return {"triangle", std::string(name_of(membrane)), rest, energy, 500};
}

std::vector<Subject> subjects() {
  std::vector<Subject> list;
  int splines = 0;
  for (const Material& material : test::all_materials()) {
    list.push_back(tetrahedron(material, std::nullopt));
    if (std::holds_alternative<Spline>(material)) list.back().material += splines++ == 0 ? " A" : " B";
  }
  list.push_back(tetrahedron(test::all_materials()[2], Fibre{3e4, {0.6, 0, 0.8}}));
  list.push_back(spring());
  for (const Membrane& membrane : test::all_membranes()) list.push_back(triangle(membrane));
  for (std::size_t m : {2, 4}) list[list.size() - m].material += ", gives way";
  return list;
}

// Returns the best of several steps: a large step suffers from curvature, a small one from round-off.
double difference_error(const Subject& subject, const Corners& x, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Corners direction(x.rows(), 3), force;
  for (double& value : direction.reshaped()) value = normal(random);
  direction /= direction.norm();
  subject.energy(x, &force);
  const double slope = force.cwiseProduct(direction).sum();
  double best = 1e300;
  for (const double h : {1e-2, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 1e-7}) {
    const double step = h * std::max(0.1, 0.1 * x.norm());
    const double difference =
        (subject.energy(x + step * direction, nullptr) - subject.energy(x - step * direction, nullptr)) / (2 * step);
    best = std::min(best, std::abs(difference - slope));
  }
  return best / std::max(force.norm(), 1e-2 * subject.scale);
}

struct Row {
  std::string element, material;
  std::vector<double> derivative;  // worst error, for each kind of deformation
  double rigid = 0, net_force = 0, net_torque = 0;
};

Row measure(const Subject& subject) {
  Row row{subject.element, subject.material, {}};
  std::mt19937 random(17);
  for (const test::Kind& kind : kinds) {
    double worst = 0;
    for (int sample = 0; sample < 60; ++sample) {
      const Mat3 f = test::deformation(kind, random);
      const Corners x = subject.rest * f.transpose();
      worst = std::max(worst, difference_error(subject, x, random));
      Corners force;
      subject.energy(x, &force);
      const double sum = force.rowwise().norm().sum();
      if (sum < 1e-6 * subject.scale) continue;
      row.net_force = std::max(row.net_force, force.colwise().sum().norm() / sum);
      Vec3 torque = Vec3::Zero();
      double arms = 0;
      for (Eigen::Index k = 0; k < x.rows(); ++k) {
        torque += Vec3(x.row(k)).cross(Vec3(force.row(k)));
        arms += x.row(k).norm() * force.row(k).norm();
      }
      row.net_torque = std::max(row.net_torque, torque.norm() / arms);
    }
    row.derivative.push_back(worst);
  }
  for (int sample = 0; sample < 60; ++sample) {
    Corners x = subject.rest * random_rotation(random).transpose(), force;
    x.rowwise() += Eigen::RowVector3d(uniform(random, -5, 5), uniform(random, -5, 5), uniform(random, -5, 5));
    subject.energy(x, &force);
    row.rigid = std::max(row.rigid, force.norm() / subject.scale);
  }
  return row;
}

std::string table_of(const std::vector<Row>& rows) {
  std::string table = "| element | material |";
  for (const test::Kind& kind : kinds) table += fmt::format(" {} |", kind.name);
  table += " rigid motion | net force | net torque |\n|---|---|";
  for (std::size_t i = 0; i < std::size(kinds) + 3; ++i) table += "---|";
  table += '\n';
  for (const Row& row : rows) {
    table += fmt::format("| {} | {} |", row.element, row.material);
    for (const double error : row.derivative) table += fmt::format(" {:.0e} |", error);
    table += fmt::format(" {:.0e} | {:.0e} | {:.0e} |\n", row.rigid, row.net_force, row.net_torque);
  }
  return table;
}

TEST(Derivatives, ForcesOfEveryElementAreTheDerivativesOfItsEnergyAndBalance) {
  std::set<std::size_t> models;
  for (const Material& material : test::all_materials()) models.insert(material.index());
  EXPECT_EQ(models.size(), std::variant_size_v<Material>) << "a material is missing from all_materials()";
  std::set<std::size_t> membranes;
  for (const Membrane& membrane : test::all_membranes()) membranes.insert(membrane.index());
  EXPECT_EQ(membranes.size(), std::variant_size_v<Membrane>) << "a membrane is missing from all_membranes()";
  std::vector<Row> rows;
  for (const Subject& subject : subjects()) rows.push_back(measure(subject));
  const std::string page = test::read_file(test::source_folder / "docs" / "derivatives.md");
  for (const Row& row : rows) {
    const std::string name = row.element + " " + row.material;
    for (std::size_t i = 0; i < row.derivative.size(); ++i)
      EXPECT_LT(row.derivative[i], 1e-6) << name << ", " << kinds[i].name;
    EXPECT_LT(row.rigid, 1e-12) << name;
    EXPECT_LT(row.net_force, 1e-14) << name;
    EXPECT_LT(row.net_torque, 1e-10) << name;
    EXPECT_NE(page.find(fmt::format("| {} | {} |", row.element, row.material)), std::string::npos)
        << "docs/derivatives.md has no row for " << name << "; build/release/derivatives.md has";
  }
  std::cout << table_of(rows);
  std::ofstream(test::build_folder / "derivatives.md") << table_of(rows);
}

TEST(Derivatives, NetForceAndTorqueOfAWholeBodyVanishAtEveryIteration) {
  std::vector<BodyDescription> bodies;
  for (const Material& material : test::all_materials()) bodies.push_back(test::bar(material, test::Held::nothing));
  bodies.push_back(bodies[2]);
  bodies.back().fibres = {Fibre{3e4, {0.6, 0, 0.8}}};
  bodies.push_back(test::spring_net(6));
  for (const Membrane& membrane : test::all_membranes())
    bodies.push_back(test::sheet({0.4, 0.4}, {6, 6}, {membrane, 0.01}));
  for (const BodyDescription& body : bodies) {
    const Model model = build_model(body);
    StepInputs inputs = test::still_inputs(model);
    State start = rest_state(model);
    start.x = test::shaken(model.rest, 0.01, 1);
    start.v = test::shaken(Positions::Zero(model.vertices, 3), 0.5, 2);
    for (int iterations = 1; iterations <= 10; ++iterations) {
      inputs.solver.iterations = iterations;
      State state = start;
      OpenWorkspace w;
      step(model, inputs, state, w);
      // The force is the elastic part of the gradient at the end of the step.
      begin_step(model, inputs, start, w);
      const Positions y = w.y;
      w.current.x = state.x;
      evaluate(model, w, w.current, Wanted::gradient);
      Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
      double forces = 0, torques = 0;
      for (int v = 0; v < model.vertices; ++v) {
        const double weight = model.mass[v] / (model.time_step * model.time_step);
        const Vec3 f = w.current.gradient.row(v) - weight * (state.x.row(v) - y.row(v)), x = state.x.row(v);
        force += f;
        torque += x.cross(f);
        forces += f.norm();
        torques += x.norm() * f.norm();
      }
      EXPECT_LT(force.norm(), 1e-10 * forces) << iterations;
      EXPECT_LT(torque.norm(), 1e-10 * torques) << iterations;
    }
  }
}

}  // namespace derivative_table_test
}  // namespace supple
