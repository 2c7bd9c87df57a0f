// Plays scenes of bodies that meet beside Bullet's deformable world, on the same meshes: two cubes that fly into each
// other, and creatures that fall into a box. It prints markdown. Bullet has the settings of its own examples of
// deformable bodies: steps of 1/240 s, which are 8 a frame, implicit forces, up to 100 iterations of contact, a margin
// that is given. Usage: supple_bullet_study ASSETS
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <set>
#include <utility>

#include "app/bench/comparison.h"
#include "app/bench/touching_film.h"
#include "base/timing.h"
#include "scene/building/assemble.h"
#include "scene/building/body_depths.h"

using namespace supple;

namespace {

constexpr double side = 0.55;            // half of the box's width [m]
constexpr double patience_ms = 180'000;  // for a film in Bullet

struct Lame {
  double mu, lambda;
};

Lame lame(double young, double poisson) {
  return {young / (2 * (1 + poisson)), young * poisson / ((1 + poisson) * (1 - 2 * poisson))};
}

btVector3 vector_of(const Vec3& v) { return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())}; }

// Holds Bullet's world with the bodies of a scene.
class BulletWorld {
 public:
  BulletWorld(const Vec3& gravity, double margin)
      : margin_(margin),
        dispatcher_(&configuration_),
        world_((solver_.setDeformableSolver(&deformable_), &dispatcher_), &broadphase_, &solver_, &configuration_,
               &deformable_) {
    world_.setGravity(vector_of(gravity));
    btSoftBodyWorldInfo& info = world_.getWorldInfo();
    info.m_gravity = vector_of(gravity);
    info.m_dispatcher = &dispatcher_;
    info.m_broadphase = &broadphase_;
    info.m_sparsesdf.setDefaultVoxelsz(0.25);
    info.m_sparsesdf.Reset();
    world_.setImplicit(true);
    world_.setLineSearch(false);
    world_.setUseProjection(true);
    world_.getSolverInfo().m_deformable_erp = 0.3;
    world_.getSolverInfo().m_deformable_maxErrorReduction = 200;
    world_.getSolverInfo().m_leastSquaresResidualThreshold = 1e-3;
    world_.getSolverInfo().m_splitImpulse = true;
    world_.getSolverInfo().m_numIterations = 100;
  }
  ~BulletWorld() {
    for (const auto& body : bodies_) world_.removeSoftBody(body.get());
    for (const auto& wall : walls_) world_.removeRigidBody(wall.get());
  }

  void add(const Body& body, const Lame& material, double density, double friction, const Vec3& velocity) {
    const Positions x = first_positions(body);
    std::vector<btVector3> places;
    for (const auto& row : x.rowwise()) places.push_back(vector_of(row.transpose()));
    auto soft = std::make_unique<btSoftBody>(&world_.getWorldInfo(), int(places.size()), places.data(), nullptr);
    std::set<std::pair<int, int>> edges;
    const Tetrahedra& tets = body.description.mesh.tets;
    for (Eigen::Index t = 0; t < tets.rows(); ++t) {
      soft->appendTetra(tets(t, 0), tets(t, 1), tets(t, 2), tets(t, 3));
      for (int i = 0; i < 4; ++i)
        for (int k = i + 1; k < 4; ++k) edges.insert(std::minmax(int(tets(t, i)), int(tets(t, k))));
    }
    for (const auto& [a, b] : edges) soft->appendLink(a, b, nullptr, true);
    btSoftBodyHelpers::generateBoundaryFaces(soft.get());
    soft->initializeDmInverse();
    soft->m_tetraScratches.resize(soft->m_tetras.size());
    soft->m_tetraScratchesTn.resize(soft->m_tetras.size());
    soft->getCollisionShape()->setMargin(btScalar(margin_));
    // Vertices get the masses that they have in the other program.
    for (int v = 0; v < soft->m_nodes.size(); ++v) soft->setMass(v, 0);
    std::vector<double> mass(places.size(), 0.0);
    for (Eigen::Index t = 0; t < tets.rows(); ++t) {
      const Vec3 a = x.row(tets(t, 0)), b = x.row(tets(t, 1)), c = x.row(tets(t, 2)), d = x.row(tets(t, 3));
      const double quarter = density * std::abs((b - a).cross(c - a).dot(d - a)) / 24;
      for (int k = 0; k < 4; ++k) mass[std::size_t(tets(t, k))] += quarter;
    }
    for (int v = 0; v < soft->m_nodes.size(); ++v) soft->setMass(v, btScalar(mass[std::size_t(v)]));
    soft->m_cfg.kKHR = soft->m_cfg.kCHR = 1;
    soft->m_cfg.kDF = btScalar(friction);
    soft->m_cfg.collisions =
        btSoftBody::fCollision::SDF_RD | btSoftBody::fCollision::SDF_RDN | btSoftBody::fCollision::VF_DD;
    soft->setSelfCollision(false);
    soft->setVelocity(vector_of(velocity));
    soft->m_sleepingThreshold = 0;
    world_.addSoftBody(soft.get());
    forces_.push_back(std::make_unique<btDeformableNeoHookeanForce>(btScalar(material.mu), btScalar(material.lambda),
                                                                    btScalar(0.01)));
    world_.addForce(soft.get(), forces_.back().get());
    if (!world_.getGravity().fuzzyZero()) {
      forces_.push_back(std::make_unique<btDeformableGravityForce>(world_.getGravity()));
      world_.addForce(soft.get(), forces_.back().get());
    }
    masses_.push_back(std::move(mass));
    bodies_.push_back(std::move(soft));
  }

  void add_wall(const Vec3& center, const Vec3& half, double friction) {
    shapes_.push_back(std::make_unique<btBoxShape>(vector_of(half)));
    shapes_.back()->setMargin(btScalar(margin_));
    btTransform place;
    place.setIdentity();
    place.setOrigin(vector_of(center));
    walls_.push_back(std::make_unique<btRigidBody>(
        btRigidBody::btRigidBodyConstructionInfo(0, nullptr, shapes_.back().get(), btVector3(0, 0, 0))));
    walls_.back()->setWorldTransform(place);
    walls_.back()->setFriction(btScalar(friction));
    world_.addRigidBody(walls_.back().get());
  }

  void play() { world_.stepSimulation(btScalar(1.0 / 30), 8, btScalar(1.0 / 240)); }

  std::vector<Positions> places() const {
    std::vector<Positions> all;
    for (const auto& body : bodies_) {
      Positions& x = all.emplace_back(body->m_nodes.size(), 3);
      for (int v = 0; v < body->m_nodes.size(); ++v)
        for (int k = 0; k < 3; ++k) x(v, k) = body->m_nodes[v].m_x[k];
    }
    return all;
  }
  Vec3 momentum(std::size_t body) const {
    Vec3 sum = Vec3::Zero();
    for (int v = 0; v < bodies_[body]->m_nodes.size(); ++v) {
      const btVector3& speed = bodies_[body]->m_nodes[v].m_v;
      sum += masses_[body][std::size_t(v)] * Vec3(speed.x(), speed.y(), speed.z());
    }
    return sum;
  }
  double mass(std::size_t body) const {
    double sum = 0;
    for (const double one : masses_[body]) sum += one;
    return sum;
  }
  double kinetic_energy() const {
    double sum = 0;
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      for (int v = 0; v < bodies_[b]->m_nodes.size(); ++v)
        sum += 0.5 * masses_[b][std::size_t(v)] * double(bodies_[b]->m_nodes[v].m_v.length2());
    return sum;
  }

 private:
  double margin_;
  std::vector<std::vector<double>> masses_;
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btDeformableBodySolver deformable_;
  btDeformableMultiBodyConstraintSolver solver_;
  btDeformableMultiBodyDynamicsWorld world_;
  std::vector<std::unique_ptr<btDeformableLagrangianForce>> forces_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> walls_;
  std::vector<std::unique_ptr<btSoftBody>> bodies_;
};

// Returns how deep bodies are in each other at most, by their vertices, over the smaller one's size.
double deepest(const std::vector<Body>& bodies, const std::vector<Positions>& places) {
  double most = 0;
  for (const BodyDepth& pair : overlaps_of_bodies(bodies, places)) most = std::max(most, pair.share);
  return most;
}

bool is_finite(const std::vector<Positions>& places) {
  return std::ranges::all_of(places, [](const Positions& x) { return x.allFinite(); });
}

std::vector<Positions> places_of(const TouchingFilm& film, std::size_t bodies) {
  std::vector<Positions> all;
  for (std::size_t b = 0; b < bodies; ++b) all.push_back(film.places(b));
  return all;
}

std::string supple_text(int substeps) { return fmt::format("supple, {} a frame", substeps); }

struct Result {
  std::vector<double> ms, depth, kinetic;
  std::string end = "whole";
};

// Plays Bullet's world, and calls after() at the end of each frame.
Result play(BulletWorld& world, const std::vector<Body>& bodies, int frames, const std::function<void()>& after) {
  Result result;
  const Stopwatch whole;
  for (int frame = 0; frame < frames; ++frame) {
    if (whole.elapsed_ms() > patience_ms) {
      result.end = fmt::format("given up after {} frames", frame);
      break;
    }
    const Stopwatch watch;
    world.play();
    result.ms.push_back(watch.elapsed_ms());
    const std::vector<Positions> places = world.places();
    if (!is_finite(places)) {
      result.end = fmt::format("not finite in frame {}", frame);
      break;
    }
    for (std::size_t b = 0; b < places.size() && result.end == "whole"; ++b) {
      if (bounds_of(places[b]).diagonal() > 3 * bounds_of(bodies[b].description.mesh.rest).diagonal())
        result.end = fmt::format("torn in frame {}", frame);
    }
    result.depth.push_back(deepest(bodies, places));
    result.kinetic.push_back(world.kinetic_energy());
    after();
  }
  return result;
}

void print_times(const char* scene, const char* program, const Result& result, const std::string& more) {
  if (result.ms.empty()) {
    fmt::print("| {} | {} | | | | | {} |\n", scene, program, result.end);
    return;
  }
  const double peak = *std::ranges::max_element(result.kinetic);
  fmt::print("| {} | {} | {:.3g}, {:.3g} | {:.2g}, {:.2g} | {:.2g} | {} | {} |\n", scene, program,
             rank_of(result.ms, 0), rank_of(result.ms, 0.5), 100 * rank_of(result.depth, 0.5),
             100 * rank_of(result.depth, 1), result.kinetic.back() / peak, more, result.end);
}

std::string cube_text(const char* name, double x, double speed) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nbox = {{ extent = [0.2, 0.2, 0.2], cells = [4, 4, 4] }}\nposition = [{:g}, -0.1, 0]\n"
      "velocity = [{:g}, 0, 0]\nmaterial = {{ model = \"stable-neo-hookean\", young = 1e5, poisson = 0.4 }}\n"
      "density = 1000\ncontact = {{ friction = 0 }}\n",
      name, x, speed);
}

// Two cubes: how fast they leave, and what becomes of the momentum that they exchange.
void compare_head_on(double speed, Threads& threads) {
  constexpr int frames = 60;
  const std::string text =
      "frames = 60\ngravity = [0, 0, 0]\n" + cube_text("left", -0.25, speed) + cube_text("right", 0.25, -speed);
  const std::string name = fmt::format("two cubes at {:g} m/s", speed);
  const std::vector<Body> bodies = assemble(scene_of_text(text, "cubes"));
  const auto more = [&](const Vec3& left, const Vec3& right, double mass, double exchanged) {
    return fmt::format("leave at {:.3g} m/s, momentum {:.1e}", 0.5 * (left.norm() + right.norm()) / mass,
                       (left + right).norm() / exchanged);
  };
  for (const int substeps : {1, 8}) {
    TouchingFilm film(fmt::format("substeps = {}\n", substeps) + text, threads);
    Result result;
    Vec3 before = film.momentum(0);
    double exchanged = 0;
    for (int frame = 0; frame < frames && film.play(); ++frame) {
      result.ms.push_back(film.work().ms);
      result.depth.push_back(deepest(bodies, places_of(film, 2)));
      result.kinetic.push_back(film.kinetic_energy());
      exchanged += (film.momentum(0) - before).norm();
      before = film.momentum(0);
    }
    print_times(name.c_str(), supple_text(substeps).c_str(), result,
                more(film.momentum(0), film.momentum(1), before.norm() / film.velocity(0).norm(), exchanged));
  }
  for (const double margin : {0.002, 0.015}) {
    BulletWorld world(Vec3::Zero(), margin);
    world.add(bodies[0], lame(1e5, 0.4), 1000, 0, Vec3(speed, 0, 0));
    world.add(bodies[1], lame(1e5, 0.4), 1000, 0, Vec3(-speed, 0, 0));
    Vec3 before = world.momentum(0);
    double exchanged = 0;
    const Result result = play(world, bodies, frames, [&] {
      exchanged += (world.momentum(0) - before).norm();
      before = world.momentum(0);
    });
    print_times(name.c_str(), fmt::format("Bullet, 8 a frame, margin {:g} mm", 1000 * margin).c_str(), result,
                more(world.momentum(0), world.momentum(1), world.mass(0), exchanged));
  }
}

// Returns the bodies of the scene of the bowl, above a box.
std::string pile_text(const std::string& assets) {
  std::ifstream file(assets + "/scenes/bowl.toml");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  text.resize(text.find("[[collider]]"));
  text += "[[collider]]\nname = \"ground\"\nshape = { half_space = { normal = [0, 1, 0] } }\nfriction = 0.5\n";
  for (const char* normal : {"[1, 0, 0]", "[-1, 0, 0]", "[0, 0, 1]", "[0, 0, -1]"}) {
    const Vec3 n(normal[1] == '1' ? 1 : normal[1] == '-' ? -1 : 0, 0, 0);
    const double z = n.x() != 0 ? 0 : normal[7] == '1' ? 1 : -1;
    text += fmt::format(
        "[[collider]]\nshape = {{ half_space = {{ normal = {} }} }}\nposition = [{:g}, 0, {:g}]\nfriction = 0.5\n"
        "visible = false\n",
        normal, -side * n.x(), -side * z);
  }
  return text;
}

void compare_pile(const std::string& assets, Threads& threads) {
  constexpr int frames = 150;
  const std::string text = pile_text(assets);
  const std::vector<Body> bodies = assemble(scene_of_text(text, "pile"));
  for (const int substeps : {1, 8}) {
    TouchingFilm film(fmt::format("substeps = {}\n", substeps) + text, threads);
    Result result;
    for (int frame = 0; frame < frames && film.play(); ++frame) {
      result.ms.push_back(film.work().ms);
      result.depth.push_back(deepest(bodies, places_of(film, bodies.size())));
      result.kinetic.push_back(film.kinetic_energy());
    }
    print_times("pile", supple_text(substeps).c_str(), result, "");
  }
  for (const double margin : {0.002, 0.015}) {
    BulletWorld world(Vec3(0, -9.81, 0), margin);
    for (const Body& body : bodies) world.add(body, lame(4e4, 0.4), body.description.density, 0.5, Vec3::Zero());
    world.add_wall(Vec3(0, -0.5, 0), Vec3(3, 0.5, 3), 0.5);
    for (const double sign : {-1.0, 1.0}) {
      world.add_wall(Vec3(sign * (side + 0.5), 1, 0), Vec3(0.5, 3, 3), 0.5);
      world.add_wall(Vec3(0, 1, sign * (side + 0.5)), Vec3(3, 3, 0.5), 0.5);
    }
    const Result result = play(world, bodies, frames, [] {});
    print_times("pile", fmt::format("Bullet, 8 a frame, margin {:g} mm", 1000 * margin).c_str(), result, "");
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: supple_bullet_study ASSETS\n");
    return 2;
  }
  Threads threads(1);
  fmt::print(
      "| scene | program | ms a frame: least, median | deepest vertex [% of size]: median, most | kinetic energy at "
      "the end "
      "over its most | | end |\n|---|---|---|---|---|---|---|\n");
  compare_head_on(2, threads);
  compare_head_on(8, threads);
  compare_pile(argv[1], threads);
}
