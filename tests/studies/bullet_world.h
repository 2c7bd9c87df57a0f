// Holds Bullet's deformable world with the bodies of a scene, for studies that compare it with this program. It has the
// settings of Bullet's own examples of deformable bodies: steps of 1/240 s, which are 8 a frame, implicit forces, up to
// 100 iterations of contact, a margin that is given.
#pragma once

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMassSpringForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "scene/building/assemble.h"
#include "scene/building/body.h"
#include "sim/materials/parameters.h"

namespace supple {

inline btVector3 vector_of(const Vec3& v) { return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())}; }

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
    add(std::move(soft),
        std::make_unique<btDeformableNeoHookeanForce>(btScalar(material.mu), btScalar(material.lambda), btScalar(0.01)),
        mass);
  }

  // Adds a cloth of springs along the edges of its triangles, whose vertices have the masses that are given.
  // stretch: of a spring [N/m]; bend: of springs between vertices that are two edges apart [N/m]; held: its vertices
  // that do not move.
  void add_cloth(const Positions& x, const Triangles& triangles, const std::vector<double>& mass, double stretch,
                 double bend, const std::vector<int>& held, double friction) {
    std::vector<btVector3> places;
    for (const auto& row : x.rowwise()) places.push_back(vector_of(row.transpose()));
    auto soft = std::make_unique<btSoftBody>(&world_.getWorldInfo(), int(places.size()), places.data(), nullptr);
    std::set<std::pair<int, int>> edges;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      soft->appendFace(triangles(t, 0), triangles(t, 1), triangles(t, 2));
      for (int k = 0; k < 3; ++k) edges.insert(std::minmax(int(triangles(t, k)), int(triangles(t, (k + 1) % 3))));
    }
    for (const auto& [a, b] : edges) soft->appendLink(a, b, nullptr, true);
    soft->generateBendingConstraints(2);
    soft->getCollisionShape()->setMargin(btScalar(margin_));
    for (int v = 0; v < soft->m_nodes.size(); ++v) soft->setMass(v, btScalar(mass[std::size_t(v)]));
    for (const int v : held) soft->setMass(v, 0);
    soft->m_cfg.kKHR = soft->m_cfg.kCHR = 1;
    soft->m_cfg.kDF = btScalar(friction);
    soft->m_cfg.collisions = btSoftBody::fCollision::SDF_RD | btSoftBody::fCollision::SDF_RDN;
    soft->setSelfCollision(false);
    soft->m_sleepingThreshold = 0;
    constexpr double damping = 0.05;  // of springs [N s/m], as in the examples
    add(std::move(soft),
        std::make_unique<btDeformableMassSpringForce>(btScalar(stretch), btScalar(damping), true, btScalar(bend)),
        mass);
  }

  // Adds an obstacle that stands.
  void add_obstacle(std::unique_ptr<btConvexInternalShape> shape, const Vec3& center, double friction) {
    shapes_.push_back(std::move(shape));
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
  void add(std::unique_ptr<btSoftBody> soft, std::unique_ptr<btDeformableLagrangianForce> force,
           const std::vector<double>& mass) {
    world_.addSoftBody(soft.get());
    forces_.push_back(std::move(force));
    world_.addForce(soft.get(), forces_.back().get());
    if (!world_.getGravity().fuzzyZero()) {
      forces_.push_back(std::make_unique<btDeformableGravityForce>(world_.getGravity()));
      world_.addForce(soft.get(), forces_.back().get());
    }
    masses_.push_back(mass);
    bodies_.push_back(std::move(soft));
  }

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

}  // namespace supple
