// Finds where a body's vertices meet rigid colliders on their way through a step, and the planes that hold them: once
// for each iterate, with an exact look at those vertices alone that may have come near. Not here: the energies of these
// planes (contact.h).
#pragma once

#include <vector>

#include "base/threads.h"
#include "sim/contact/contact.h"
#include "sim/model/inputs.h"
#include "sim/model/model.h"
#include "sim/model/report.h"

namespace supple {

// Traits of a shape that a search asks for once.
struct ColliderTraits {
  double certainty;       // Shape::certainty
  double half_thickness;  // Shape::half_thickness [m]
};

// The memory of the search for contacts within a step, and its scratch; empty while there are no colliders.
struct ContactWork {
  std::vector<std::vector<Contact>> by_chunk;
  std::vector<double> clearance;          // signed distance at the start, colliders x free; NaN: not asked yet [m]
  std::vector<double> group_distance;     // least distance of a group's vertices at the start, colliders x groups [m]
  std::vector<double> group_move;         // largest of a group's vertices, start to iterate [m]
  std::vector<double> group_free_move;    // the same, start to prediction [m]
  std::vector<double> collider_move;      // of the collider's own points near a group, colliders x groups [m]
  std::vector<ColliderTraits> traits;     // by collider
  Positions start;                        // q of the free vertices [m]
  const Positions* prediction = nullptr;  // y of the step, the caller's, n x 3 [m]
  double stick_length = 0;                // friction is whole above this slip in a step [m]
  std::uint64_t set_before = 0, set_now = 0;
  ContactCounts counts;
};

// Prepares a step from q: what can touch at all. y must outlive the step.
void begin_contacts(const Model& model, const StepInputs& inputs, const Positions& q, const Positions& y,
                    ContactWork& work);

// Finds the contacts of the vertices at x, on their way from q: by collider and vertex.
void find_contacts(const Model& model, const StepInputs& inputs, const Positions& x, Threads* threads,
                   ContactWork& work, std::vector<Contact>& found);

// How much of the way from q to x the body can go before a vertex is deeper than `allowed` [m] below a surface that it
// enters on the way, 0 to 1.
double way_to_impact(const Model& model, const StepInputs& inputs, const Positions& x, double allowed,
                     ContactWork& work);

// Counts what changed between the contacts of two iterates, the later of which has just been accepted.
void count_contacts(const std::vector<Contact>& before, const std::vector<Contact>& now, ContactWork& work);

// Makes the next iterate the first one that counts.
void forget_counts(ContactWork& work);

}  // namespace supple
