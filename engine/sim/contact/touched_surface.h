// Describes one iterate of a step in which points of a part meet a part's surface: what its triangles are like there,
// and which contact a place of it makes with a point. All searches of surface_contacts.cpp derive from this class:
// those of two parts (solid_pair.h, sheet_pair.h), those of a part with itself (own_points.h, own_sheet_points.h), and
// those of edges (touched_edges.h).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "sim/contact/contact.h"
#include "sim/contact/surface_work.h"

namespace supple {

class TouchedSurface {
 public:
  using Work = SurfaceWork::Parts;
  using Place = MovingSurface::Place;
  using Entry = MovingSurface::Entry;

  // All that is passed must outlive this object. q, y, x: start of the step, prediction and iterate, of the joined
  // model.
  TouchedSurface(const Model& model, const StepInputs& inputs, const Meeting& meeting, const Positions& q,
                 const Positions& y, const Positions& x, const Work& work);

 protected:
  static constexpr double same_way = 0.5;   // cosine of normals; a point is not held by a face that faces the same way
  static constexpr double opposite = -0.3;  // cosine of normals below which they belong to opposite sides

  std::int32_t corner(std::int32_t triangle, int k) const;

  // Returns how far from the surface a vertex needs a plane [m]. way: how far the vertex has moved beside the surface's
  // common motion [m].
  double reach_at(std::int32_t v, double way) const;

  // Tells whether a point is over a place's face, and neither beside nor below it by more than the usual depth. Equal
  // boxes on one another have their edges in one place: round-off alone would decide whether a lid carries them.
  bool is_over_face(const Place& place, const Vec3& p, const Positions& x) const;

  // Returns how far what is drawn reaches beyond a place of the surface [m].
  double overhang_at(const Place& place) const;

  // Returns the unit normal of a triangle; zero where it has no area.
  Vec3 normal_of(std::int32_t triangle, const Positions& x) const;

  // Returns the place of a triangle with these weights at the end of the step, and its distance from a point; nothing
  // where the triangle has no area.
  std::optional<Place> place_at_end(std::int32_t triangle, const Vec3& weights, const Vec3& p) const;

  // Returns how far a point that moves from a to b comes in the step into the side on which it enters, beside the
  // triangle's own motion [m].
  double way_into(const Entry& entry, const Vec3& a, const Vec3& b) const;

  // Returns the share of the way from q to x at which a point that enters is deeper than usual; 1: it never is. layer:
  // how far above the surface contact begins [m].
  double share_to_impact(const Entry& entry, const Vec3& a, const Vec3& b, double layer = 0) const;

  // Adds the contact with the plane through a place, lowered by as much of the depth as need not be corrected in this
  // step. field: the distance where the step began, negative inside [m]. layer: how far above the place the plane lies
  // [m]; distances count from there.
  void add(std::int32_t v, const Place& place, double field, std::vector<Contact>& list, double layer = 0) const;
  // Adds the contact of a stencil, whose plane has this normal. number: Contact::number.
  void add(const ContactStencil& stencil, std::int32_t number, const Vec3& normal, double field,
           std::vector<Contact>& list, double layer) const;

  // Makes the stencil of a vertex, `point`, against a place.
  ContactStencil stencil_of(std::int32_t point, const Place& place) const;
  // Makes a stencil of vertices with weights that are not 0.
  template <std::size_t N>
  ContactStencil stencil_of(const std::array<std::int32_t, N>& vertices, const std::array<double, N>& weights) const {
    ContactStencil stencil{};
    stencil.count = stencil.free = 0;
    for (std::size_t k = 0; k < N; ++k) add_vertex(vertices[k], weights[k], stencil);
    return stencil;
  }

  const Model& model_;
  const SolverSettings& solver_;
  const Meeting& meeting_;
  const Positions &q_, &y_, &x_;
  const Part& part_;
  const Work::Surface& surface_;
  double size_;  // of the smaller part [m]
  // How far a body falls in one step from rest: one part may rest on what holds it while the other falls [m].
  double fall_;

 private:
  void add_vertex(std::int32_t vertex, double weight, ContactStencil& stencil) const;
};

// Tells of each meeting whether only the sharp points (SurfaceWork) of the part `Meeting::points` are looked at. Of two
// solids whose points touch each other, those of the coarser one follow from those of the finer one, but for edges and
// corners: if all were looked at, each contact of two surfaces that lie on one another would count twice, and the
// contacts would nearly depend on each other. Of a sheet and a solid, all points of the sheet are looked at, and all
// points of the solid where it is the finer one, but otherwise its sharp ones alone. Of two sheets all are looked at:
// with those of one alone, ten layers that fall on a ball come through each other.
std::vector<char> only_sharp_points(const Model& model, const StepInputs& inputs, const SurfaceWork::Parts& work);

// Tells whether the two parts of a meeting are so far apart, on all of their ways to an iterate, that no point of the
// one needs a plane of the other. It compares boxes alone. The surfaces must be at the iterate.
bool are_apart(const Model& model, const StepInputs& inputs, const Meeting& meeting, const SurfaceWork::Parts& work);

}  // namespace supple
