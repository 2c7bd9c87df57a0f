// Finds where a body's vertices, and the points of its edges and faces that need it (face_points.h), meet colliders on
// their path through a step, and the planes that hold them: for each iterate whose contacts are not kept
// (solver/place_iterate.h), with an exact test of those points alone that may have come near. The contacts between the
// parts of a joined model, which surface_contacts.h finds, come in the same list. Some functions of this header have
// files of their own: impacts are found in first_impact.cpp, and contacts are counted in contact_counts.cpp. Not here:
// the energies of these planes (contact.h).
#pragma once

#include <memory>
#include <vector>

#include "base/threads.h"
#include "sim/contact/collider_view.h"
#include "sim/contact/contact.h"
#include "sim/contact/face_points.h"
#include "sim/contact/surface_contacts.h"
#include "sim/model/model.h"
#include "sim/model/report.h"

namespace supple {

// Remembers what queries for a body's vertices have found on a collider that is one closed surface, also from earlier
// steps: this saves work and changes no answer.
struct VertexMemories {
  std::shared_ptr<const TriangleSolid> solid;  // null: the collider is not one closed surface
  std::vector<QueryMemory> by_vertex;          // by free vertex; empty without a solid
};

// Holds the memory of the search for contacts within a step, and its scratch memory; empty where nothing may touch.
struct ContactWork {
  std::vector<std::vector<Contact>> by_chunk;
  std::vector<double> clearance;  // signed distance at the start, colliders x free; NaN: not asked yet [m]
  // Where vertices start as seen from colliders that deform, colliders x free; empty where none does. NaN: not asked
  // yet.
  std::vector<Vec3> carried;
  std::vector<VertexMemories> memories;  // by collider
  QueryMemory no_memory;                 // used for colliders of which nothing is remembered
  std::vector<double> group_distance;    // lower bound of a group's vertex distances at q, colliders x groups [m]
  std::vector<double> group_move;        // largest move of a group's vertices, start to iterate [m]
  std::vector<double> group_free_move;   // the same, start to prediction [m]
  std::vector<double> collider_move;     // largest motion of a collider's points near a group, colliders x groups [m]
  std::vector<ColliderTraits> traits;    // by collider
  // The way by which each part leaves each collider, colliders x parts; zero: the part does not start deep inside.
  std::vector<Vec3> way_out;
  Positions start;                // the places of the free vertices that touch colliders, at q [m]
  Positions drawn_offset;         // from all vertices to these places; empty: the places are the vertices [m]
  std::vector<FacePoints> faces;  // by collider
  SurfaceWork surfaces;           // for contacts of the model's parts with each other and with themselves
  // How deep the vertices that touch are pressed into colliders when a film begins, colliders x free; empty in every
  // other step, and where nothing touches a collider with friction (solver/first_forces.h) [m].
  std::vector<double> pressed_at_first;
  double kept_way = 0;               // contacts are found anew once a vertex has moved further; 0: at each iterate [m]
  const Positions* begin = nullptr;  // q of the step, the caller's, n x 3 [m]
  const Positions* prediction = nullptr;  // y of the step, the caller's, n x 3 [m]
  std::uint64_t set_before = 0, set_now = 0;
  ContactCounts counts;

  // Returns the place of a free vertex that touches colliders, at positions of the step [m]. Its offset from the vertex
  // is that at the start of the step, so that its contact is linear in the positions.
  Vec3 place(const Positions& x, std::int32_t v) const { return x.row(v).transpose() + offset(v); }
  Vec3 offset(std::int32_t v) const { return drawn_offset.rows() == 0 ? Vec3(0, 0, 0) : Vec3(drawn_offset.row(v)); }
};

// Returns by vertex the offset to the place of the drawn skin that touches colliders in its stead; empty where the
// vertices themselves touch colliders [m].
Positions drawn_offsets(const Model& model, const Positions& x, Threads* threads);

// Prepares a step from q: finds what can touch at all. q and y must outlive the step.
void begin_contacts(const Model& model, const StepInputs& inputs, const Positions& q, const Positions& y,
                    Threads* threads, ContactWork& work);

// Finds the contacts at x, on the path from q, ordered by what is touched and number of the point (contact_order.h).
void find_contacts(const Model& model, const StepInputs& inputs, const Positions& x, Threads* threads,
                   ContactWork& work, std::vector<Contact>& found);

// Holds the share of a step after which a point of a part is deeper below a surface than it may be.
struct Impact {
  double share = 1;   // 1: there is no impact
  int collider = -1;  // -1: there is none, or the surface is that of a part
};

// Finds how much of the way from q to x each part can go before a point of it is deeper than usual (usual_depth.h)
// below a surface that it enters on the way, or that comes to it. Returns impacts by part.
std::vector<Impact> first_impacts(const Model& model, const StepInputs& inputs, const Positions& x, ContactWork& work);

// Returns the motion of a collider in the rest of a step, after a share of it. Of a collider that deforms it is the
// motion of the surface that is closest to the middle of a part at the start of the step. q: n x 3 [m].
Eigen::Isometry3d motion_after(const StepInputs& inputs, int collider, double share, const Part& part,
                               const Positions& q);
// Returns where a collider carries a place of the world to, over a whole step.
Vec3 carried_by(const StepInputs& inputs, int collider, const Vec3& place);

// Returns the collider that most points of a part touch; -1 when they touch none.
int most_touched(const Model& model, const Part& part, const std::vector<Contact>& contacts, std::size_t colliders);

// Counts what changed between the contacts of two iterates, the later of which has just been accepted.
void count_contacts(const std::vector<Contact>& before, const std::vector<Contact>& now, ContactWork& work);
// Counts the contacts of an iterate, where it is known how many began or ceased to touch.
void count_contacts(int changes, const std::vector<Contact>& now, ContactWork& work);

// Forgets the counts of the step so far: counting begins with the next iterate.
void forget_counts(ContactWork& work);

}  // namespace supple
