// Tests contacts whose stencils have signed weights: a vertex against a place of a triangle, and a place of an edge
// against one of another edge. Their energies and forces act between vertices of the same model.
#include "sim/contact/contact_stencil.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/contact_scene.h"

namespace supple {
namespace contact_stencil_test {

using test::bar;
using test::ContactScene;
using test::Held;
using test::shaken;

struct NamedStencil {
  const char* name;
  ContactStencil stencil;
};

// vertices: ascending, at least four.
std::vector<NamedStencil> stencils_of(const std::array<std::int32_t, 4>& vertices) {
  const double s = 0.3, t = 0.8;
  return {{"vertex and triangle", {vertices, {-0.2, 1, -0.5, -0.3}, 4, 4}},
          {"two edges", {vertices, {1 - s, t - 1, s, -t}, 4, 4}}};
}

// Returns contacts with friction that are 1 mm below their planes at x.
std::vector<Contact> pressed_contacts(const std::vector<NamedStencil>& stencils, const Positions& x) {
  std::vector<Contact> contacts;
  for (const NamedStencil& named : stencils) {
    Contact contact{named.stencil, {}, Vec3(0.6, 0, 0.8), 0, 1e3, 0.001};
    contact.offset = contact.normal.dot(named.stencil.at(x)) + 0.001;
    contact.friction = 0.2;
    contact.stick = 1e-3;
    contact.origin = named.stencil.at(x) - Vec3(0.8, 0.4, -0.6) * 1e-4;
    contacts.push_back(contact);
  }
  return contacts;
}

TEST(ContactStencil, GradientsAreThoseOfTheEnergy) {
  const ContactScene scene(bar(Corotated{1e4, 3e4}, Held::hard_end), {});
  const Positions& x = scene.model.rest;
  const double step = 1e-7;
  for (const NamedStencil& named : stencils_of({1, 5, 8, 13})) {
    const std::vector<Contact> contacts = pressed_contacts({named}, x);
    Positions gradient = Positions::Zero(scene.model.free, 3);
    add_contacts(contacts, x, nullptr, gradient, &gradient);
    const auto energy = [&](const Positions& at) {
      return contact_energy(contacts, at) + friction_energy(contacts, at);
    };
    for (const std::int32_t v : named.stencil.vertex) {
      for (int c = 0; c < 3; ++c) {
        Positions up = x, down = x;
        up(v, c) += step;
        down(v, c) -= step;
        EXPECT_NEAR((energy(up) - energy(down)) / (2 * step), gradient(v, c), 1e-5 * gradient.norm())
            << named.name << ", vertex " << v << ", coordinate " << c;
      }
    }
  }
}

TEST(ContactStencil, ForcesBetweenSurfacesAddNoMomentum) {
  const ContactScene scene(bar(Corotated{1e4, 3e4}, Held::hard_end), {});
  const Positions& x = scene.model.rest;
  const std::vector<Contact> contacts = pressed_contacts(stencils_of({1, 5, 8, 13}), x);
  Positions gradient = Positions::Zero(scene.model.free, 3);
  add_contacts(contacts, x, nullptr, gradient, &gradient);
  ASSERT_GT(gradient.norm(), 1);
  EXPECT_LT(gradient.colwise().sum().norm(), 1e-15 * gradient.norm());
  std::vector<Vec3> by_collider;
  add_forces(contacts, x, by_collider);  // none of them is a collider's
}

TEST(ContactStencil, MassIsThatWhichAForceHasToMove) {
  const ContactScene scene(bar(Corotated{1e4, 3e4}, Held::hard_end), {});
  for (const auto& [name, stencil] : stencils_of({1, 5, 8, 13})) {
    Positions acceleration = Positions::Zero(scene.model.free, 3);
    stencil.spread(Vec3(Vec3::UnitX()), acceleration);
    for (const std::int32_t v : stencil.vertex) acceleration.row(v) /= scene.model.mass[v];
    EXPECT_NEAR(stencil.of_free(acceleration).x() * stencil.mass(scene.model.mass), 1, 1e-12) << name;
  }
}

// Compares (A + K)^-1 by the Woodbury identity with a dense inverse of A + K, where contacts of colliders and between
// surfaces are coupled.
TEST(ContactStencil, DirectionsSolveTheSystemWithContactsBetweenSurfaces) {
  ContactScene scene(bar(Corotated{1e4, 3e4}, Held::hard_end), {});
  const Model& model = scene.model;
  std::vector<Contact> contacts = pressed_contacts(stencils_of({1, 5, 8, 13}), model.rest);
  for (const NamedStencil& more : stencils_of({2, 5, 7, 15}))
    contacts.push_back({more.stencil, {}, Vec3(0, 0.28, 0.96), 0, 2e4, 0.001});
  contacts.push_back({ContactStencil::at_vertex(8), {0}, Vec3::UnitZ(), 0, 1e4, 0.001});
  scene.w.prepare(model, scene.inputs.solver);
  begin_step(model, scene.inputs, scene.state, scene.w);
  ContactCorrection& correction = scene.w.correction;
  find_stiff_directions(model, contacts, model.rest, correction);
  ASSERT_GE(correction.wanted.size(), 5u);
  ASSERT_GT(model.free, 15);
  Eigen::MatrixXd system = test::dense_system(model);
  for (const StiffDirection& s : correction.wanted) {
    Positions n = Positions::Zero(model.free, 3);
    s.add(1, n);
    const Eigen::VectorXd column = test::stacked(n);
    system += s.stiffness * column * column.transpose();
  }
  Positions r = shaken(Positions::Zero(model.free, 3), 1, 2), z(model.free, 3);
  const Eigen::VectorXd wanted = system.ldlt().solve(test::stacked(r));
  apply_inverse(model, {}, correction, scene.w.solve_scratch, r, z);
  EXPECT_LT((test::stacked(z) - wanted).norm(), 1e-4 * wanted.norm());
}

}  // namespace contact_stencil_test
}  // namespace supple
