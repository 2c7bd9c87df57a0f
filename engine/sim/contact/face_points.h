// Chooses points of a body's edges and faces that need contact of their own, because a collider is finer there than the
// body's surface: where a triangle lies deeper in the collider, or closer to it, than its corners do. Contact of these
// points begins a little below the surface (`slack`), so that a triangle whose corners hold it needs none, and the
// energy is continuous as a point becomes deeper than that. A point that was found stays for the rest of the step:
// minimising over more and more points of the surface solves the problem over all of them (the exchange method for
// semi-infinite programs: Hettich and Kortanek 1993, "Semi-infinite programming: theory, methods, and applications").
// Not here: the planes (find_contacts.h).
#pragma once

#include <vector>

#include "base/threads.h"
#include "geometry/shapes/shape_pieces.h"
#include "sim/contact/collider_view.h"
#include "sim/contact/contact_stencil.h"
#include "sim/model/model.h"

namespace supple {

struct FacePoint {
  ContactStencil stencil;
  double slack;          // depth below which contact begins [m]
  Vec3 out;              // offset from the point to where its distance is measured, in the collider's frame [m]
  double field;          // distance at the start of the step, negative inside [m]
  QueryMemory near;      // memory of the point's queries
  std::int32_t earlier;  // the previous point with the same first vertex; -1: none
};

// Holds the points for one collider in one step, and what is needed to find more; it is empty where the collider is
// nowhere finer than the surface.
struct FacePoints {
  struct Piece {
    ShapePiece piece;
    double most_slack;  // the largest slack for a body of any size [m]
    Bounds box;         // around it, in the collider's frame
  };
  std::vector<Piece> pieces;          // parts of the collider that may be finer than the surface
  double thickness = 0;               // of the collider's layer [m]
  std::vector<double> distance;       // lower bound of the distances of a group's triangles at the start [m]
  std::vector<double> collider_move;  // how far the collider's own points near a group move at most [m]
  std::vector<FacePoint> points;
  std::vector<std::int32_t> newest;  // the newest point of each first vertex; -1: none

  struct Candidate {
    ContactStencil stencil;
    double slack;
    Vec3 out;
    QueryMemory near;
  };
  std::vector<std::vector<Candidate>> by_chunk;  // scratch memory
};

// Prepares a step from q towards y (both n x 3): finds which pieces of a collider may need points, and the points that
// triangles need on their way.
void begin_face_points(const Model& model, const Collider& collider, const ColliderView& view, const Positions& q,
                       const Positions& y, Threads* threads, FacePoints& faces);

// Adds the points that triangles need at x (n x 3), where a triangle is deeper than the points found so far allow.
void find_face_points(const Model& model, const ColliderView& view, const Positions& q, const Positions& x,
                      const Positions& y, Threads* threads, FacePoints& faces);

// Finds the plane that holds a point of an edge or face at the end of its way, in the collider's frame; nothing when
// there is no surface within `reach`. At a collider's edge, the closest point of a point inside jumps between the two
// sides. So distances are measured from a place a little outside, straight away from the face or the edge of the body
// as it lay when the point was found: there the normal turns evenly, and where the distance is least it stands straight
// on the face.
std::optional<SurfacePoint> plane_of(const ColliderView& view, const FacePoint& face, const Way& way, double reach,
                                     QueryMemory& near);

}  // namespace supple
