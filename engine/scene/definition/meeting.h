// Tells which bodies of a scene meet, which means that they touch and push each other, with how much friction, and how
// they bounce. Two bodies meet where both allow it (BodyContactDef) and nothing about them is in the way. Not here:
// contact with colliders (sim/contact/), and what is said of bodies that overlap (scene/building/body_depths.h,
// body_passings.h).
#pragma once

#include <cstddef>
#include <string>

namespace supple {

struct BodyDef;
struct ColliderDef;
struct SceneDef;

// Tells whether two bodies that are not the same one meet.
bool meet(const BodyDef& a, const BodyDef& b);

// Tells whether two bodies of a scene, given by their indices, meet; false where these are the same.
bool meet(const SceneDef& scene, std::size_t a, std::size_t b);

// Tells whether a body touches itself.
bool meets_itself(const BodyDef& body);

// Tells whether the definitions of both bodies allow that they meet.
bool both_allow_meeting(const BodyDef& a, const BodyDef& b);

// Tells whether a body's definition names the other one among those that it meets.
bool asks_to_meet(const BodyDef& body, const BodyDef& other);

// Says why two bodies cannot meet, whatever their definitions allow; empty where they can. Bodies that meet make their
// steps together, and so with one integrator and one precision of the factor.
std::string why_not_meet(const BodyDef& a, const BodyDef& b);

// Returns the coefficient of Coulomb's law between two bodies: the geometric mean of their shares.
double pair_friction(const BodyDef& a, const BodyDef& b);

// Returns the share of their speed that two bodies keep at least when they bounce off each other: the larger of theirs.
// It is 0 where one is a cloth, which has no motion as a whole.
double pair_restitution(const BodyDef& a, const BodyDef& b);

// Does the same for a body and a collider.
double pair_restitution(const BodyDef& body, const ColliderDef& collider);

}  // namespace supple
