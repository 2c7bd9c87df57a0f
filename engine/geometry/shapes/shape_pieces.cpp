#include "geometry/shapes/shape_pieces.h"

#include <algorithm>
#include <limits>

namespace supple {
namespace {

// Returns the smallest radius of curvature of a primitive where it bulges [m].
double bulge_of(const Primitive& primitive) {
  struct Visitor {
    double operator()(const Sphere& s) const { return s.radius; }
    double operator()(const Ellipsoid& e) const {
      const double thin = e.radii.minCoeff();
      return thin * thin / e.radii.maxCoeff();
    }
    double operator()(const Capsule& c) const { return c.radius; }
    double operator()(const RoundCone& c) const { return std::min(c.from_radius, c.to_radius); }
    double operator()(const Box& b) const { return b.round; }
    double operator()(const Cylinder& c) const { return c.round; }
    double operator()(const Torus& t) const { return t.tube; }
    double operator()(const HalfSpace&) const { return std::numeric_limits<double>::infinity(); }
    double operator()(const ClosedSurface&) const { return 0; }
    double operator()(const ShapeGroup&) const { return 0; }
  };
  return std::visit(Visitor{}, primitive);
}

// Tells whether a primitive is known to be convex.
bool is_convex(const Primitive& primitive) {
  struct Visitor {
    bool operator()(const Sphere&) const { return true; }
    bool operator()(const Ellipsoid&) const { return true; }
    bool operator()(const Capsule&) const { return true; }
    bool operator()(const RoundCone&) const { return true; }
    bool operator()(const Box&) const { return true; }
    bool operator()(const Cylinder&) const { return true; }
    bool operator()(const Torus&) const { return false; }
    bool operator()(const HalfSpace&) const { return true; }
    bool operator()(const ClosedSurface&) const { return false; }
    bool operator()(const ShapeGroup&) const { return false; }
  };
  return std::visit(Visitor{}, primitive);
}

bool is_union(const ShapeGroup& group) {
  return std::all_of(group.parts.begin(), group.parts.end(),
                     [](const ShapePart& part) { return part.combine == Combine::add && part.blend <= 0; });
}

// Adds the pieces of a group. They and their radii are in the frame of the group.
void add_pieces(const ShapeGroup& group, std::vector<ShapePiece>& pieces) {
  if (!is_union(group)) {
    pieces.emplace_back().shape.root = group;
    return;
  }
  for (const ShapePart& part : group.parts) {
    const auto* inner = std::get_if<ShapeGroup>(&part.primitive);
    if (inner == nullptr || part.mirror_x) {
      ShapePiece& piece = pieces.emplace_back();
      piece.shape.root.parts = {part};
      piece.bulge = part.mirror_x ? 0 : part.scale * bulge_of(part.primitive);
      piece.convex = !part.mirror_x && is_convex(part.primitive);
      continue;
    }
    const std::size_t first = pieces.size();
    add_pieces(*inner, pieces);
    for (std::size_t i = first; i < pieces.size(); ++i) {
      ShapePart around = part;
      around.primitive = pieces[i].shape.root;
      pieces[i].shape.root.parts = {around};
      pieces[i].bulge *= part.scale;
    }
  }
}

}  // namespace

std::vector<ShapePiece> pieces_of(const Shape& shape) {
  std::vector<ShapePiece> pieces;
  add_pieces(shape.root, pieces);
  for (ShapePiece& piece : pieces) piece.half_thickness = piece.shape.half_thickness();
  return pieces;
}

}  // namespace supple
