// Finds where the parts of a joined model touch each other in a step: points of one part, which are the vertices of its
// surface, against the surface of another part, which is a solid (solid_pair.h) or a sheet (sheet_pair.h), or of the
// same one (own_points.h, own_sheet_points.h); and edges against edges (sheet_edges.h, solid_edges.h). Of two solids,
// all points of the finer one count, and of the other one those at sharp edges and corners. As for colliders, a point
// gets a plane before it touches: that of the place that holds it. This place is a triangle of the other surface with
// barycentric weights; the contact acts on the point and the triangle's vertices, equal and opposite
// (contact_stencil.h). Not here: which parts meet (StepInputs::meetings), the energies of the planes (contact.h).
//
// For a point that begins a step outside, the way through the step decides: it is held by the triangle through which it
// came, unless the closest place at the end is on the same side. A point that begins inside is held by the closest
// place, and by that of the step's beginning where the point has passed the middle of the other part meanwhile.
#pragma once

#include <memory>
#include <vector>

#include "base/threads.h"
#include "sim/contact/contact.h"
#include "sim/model/inputs.h"
#include "sim/model/model.h"

namespace supple {

// Holds the surfaces of a joined model's parts, and what a step knows of its beginning; empty while nothing meets.
class SurfaceWork {
 public:
  SurfaceWork();
  ~SurfaceWork();
  SurfaceWork(SurfaceWork&&) noexcept;
  SurfaceWork& operator=(SurfaceWork&&) noexcept;

  struct Parts;  // surface_work.h
  Parts& parts();

 private:
  std::unique_ptr<Parts> parts_;
};

// Prepares a step from q (n x 3, with the held vertices at the start of the step).
void begin_surfaces(const Model& model, const StepInputs& inputs, const Positions& q, const Positions& y,
                    SurfaceWork& work);

// Returns the thickness, on one side, of the thinnest layer of the model's sheets; infinite where there are none, or
// where nothing meets [m].
double thinnest_layer(const StepInputs& inputs, SurfaceWork& work);

// Finds the contacts between parts at x, ordered by surface and number of the point, and adds them to a list.
void find_surface_contacts(const Model& model, const StepInputs& inputs, const Positions& q, const Positions& y,
                           const Positions& x, Threads* threads, SurfaceWork& work, std::vector<Contact>& found);

// Lowers the shares, by part, of the ways from q to x that the parts can go: to where a point becomes deeper than usual
// (usual_depth.h) in the surface of another part or of its own. Both parts of an impact are stopped.
void stop_at_surfaces(const Model& model, const StepInputs& inputs, const Positions& q, const Positions& x,
                      SurfaceWork& work, std::vector<double>& shares);

}  // namespace supple
