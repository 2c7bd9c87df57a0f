#include "scene/building/support.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/stretches.h"
#include "geometry/shapes/rounded_prism.h"
#include "scene/definition/rotation.h"

namespace supple {
namespace {

// Sizes over the diagonal of the body's box. They are as small as can be seen in a picture of 640 pixels.
constexpr double pin_radius = 0.012, rod_radius = 0.01;
constexpr double largest_pin = 0.03;  // largest pin on a small part of a figure, such as the tip of an ear
constexpr double small_part = 0.15;   // the largest such part
constexpr double thinnest_plate = 0.012, thickest_plate = 0.03;
constexpr double over_skin = 0.6;        // least radius of a pin over an element whose skin is finer
constexpr double plate_by_face = 0.12;   // thickness over the face's size
constexpr double margin_by_plate = 0.4;  // by how much a plate is wider than its face, over its thickness
constexpr double inside_by_plate = 0.3;  // how far a plate reaches over the body, to hide the seam
constexpr double below_ground = 0.1;     // how far a plate lies below a standing body, over its thickness
constexpr double widest_ring = 0.12;     // over the body's length
constexpr double least_fill = 0.6;       // least held share of the hull that a clamp on cloth covers
constexpr std::size_t most_pins = 6;     // in a part that neither a plate nor a ring would fit

// Holds what supports are made from: the body at rest in the directions of its file.
struct Frame {
  Mat3 turn;         // from the file's directions to the world's
  Positions places;  // by vertex [m]
  Bounds box;
  double size = 0;               // diagonal of the box [m]
  double edge = 0;               // mean edge of the surface [m]
  double pin = 0, rod = 0;       // radii of pins and rods [m]
  std::vector<char> on_surface;  // by vertex
  Triangles surface;             // the surface that is seen
  bool finer_skin = false;       // whether a skin finer than the mesh is drawn
  std::vector<char> held = {};   // by vertex: whether the present handle holds it
};

Frame frame_of(const Body& body) {
  Frame frame;
  const TetMesh& mesh = body.description.mesh;
  frame.turn = rotation_from_degrees(body.def.turn_deg).toRotationMatrix();
  frame.places = mesh.rest * frame.turn;
  frame.box = bounds_of(frame.places);
  frame.size = frame.box.diagonal();
  frame.surface = surface_of(body);
  frame.on_surface.assign(std::size_t(mesh.rest.rows()), 0);
  double sum = 0;
  for (Eigen::Index t = 0; t < frame.surface.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = frame.surface(t, k), b = frame.surface(t, (k + 1) % 3);
      frame.on_surface[std::size_t(a)] = 1;
      sum += (frame.places.row(a) - frame.places.row(b)).norm();
    }
  }
  frame.edge = sum / std::max(1.0, 3.0 * static_cast<double>(frame.surface.rows()));
  // A skin that is finer than the mesh may lie half an element outside it.
  frame.finer_skin = !body.def.shape.empty() || !body.def.surface.empty();
  const double least = frame.finer_skin ? over_skin * frame.edge : 0;
  frame.pin = std::max(pin_radius * frame.size, least);
  frame.rod = std::max(rod_radius * frame.size, least);
  return frame;
}

using HeldPart = std::vector<std::int32_t>;  // vertices of a handle that hang together by edges

// Returns the parts of a handle, in the order of their first vertices.
std::vector<HeldPart> parts_of(const Body& body, const Handle& handle, Frame& frame) {
  DisjointSets joined(frame.on_surface.size());
  frame.held.assign(joined.size(), 0);
  for (const std::int32_t v : handle.vertices) frame.held[std::size_t(v)] = 1;
  const auto join = [&](const auto& elements) {
    for (Eigen::Index e = 0; e < elements.rows(); ++e) {
      for (Eigen::Index i = 0; i < elements.cols(); ++i) {
        for (Eigen::Index k = 0; k < i; ++k) {
          const std::int32_t a = elements(e, i), b = elements(e, k);
          if (frame.held[std::size_t(a)] == 0 || frame.held[std::size_t(b)] == 0) continue;
          joined.join(std::size_t(a), std::size_t(b));
        }
      }
    }
  };
  body.def.cloth ? join(frame.surface) : join(body.description.mesh.tets);
  std::map<std::size_t, HeldPart> parts;
  for (const std::int32_t v : handle.vertices) parts[joined.of(std::size_t(v))].push_back(v);
  std::vector<HeldPart> result;
  for (auto& [first, part] : parts) result.push_back(std::move(part));
  return result;
}

Bounds box_of(const Frame& frame, const HeldPart& part) {
  Bounds box;
  for (const std::int32_t v : part) box.include(frame.places.row(v).transpose());
  return box;
}

// Turns a mesh whose third coordinate is along an axis of the frame back into the frame's coordinates [m].
TriMesh stood_along(int axis, TriMesh mesh) {
  const Positions flat = mesh.points;
  mesh.points.col((axis + 1) % 3) = flat.col(0);
  mesh.points.col((axis + 2) % 3) = flat.col(1);
  mesh.points.col(axis) = flat.col(2);
  return mesh;
}

std::vector<Eigen::Vector2d> seen_along(int axis, const Frame& frame, const HeldPart& part) {
  std::vector<Eigen::Vector2d> points;
  for (const std::int32_t v : part)
    points.emplace_back(frame.places(v, (axis + 1) % 3), frame.places(v, (axis + 2) % 3));
  return points;
}

double plate_thickness(const Frame& frame, const Bounds& part, int axis) {
  Vec3 extent = part.extent();
  extent[axis] = 1;
  return std::clamp(plate_by_face * std::sqrt(std::max(0.0, extent.prod())), thinnest_plate * frame.size,
                    thickest_plate * frame.size);
}

// Makes a plate, ring or clamp along an axis around the held vertices of a part.
TriMesh prism_around(const Frame& frame, const HeldPart& part, int axis, double low, double high, double thickness) {
  const double margin = margin_by_plate * thickness;
  return stood_along(
      axis, surface_of({seen_along(axis, frame, part), margin, low, high, std::min(margin, 0.25 * (high - low))}));
}

TriMesh ball_at(const Vec3& place, double radius) {
  TriMesh mesh = surface_of({{Eigen::Vector2d::Zero()}, radius, -radius, radius, radius});
  mesh.points.rowwise() += place.transpose();
  return mesh;
}

// Tells whether a part is a line, and gives its ends.
bool is_line(const Frame& frame, const HeldPart& part, Vec3& from, Vec3& to) {
  const auto farthest_from = [&](const Vec3& place) {
    return Vec3(frame.places.row(*std::ranges::max_element(
        part, {}, [&](std::int32_t v) { return (Vec3(frame.places.row(v)) - place).squaredNorm(); })));
  };
  from = farthest_from(frame.places.row(part.front()).transpose());
  to = farthest_from(from);
  const Vec3 along = (to - from).normalized();
  return std::ranges::all_of(part, [&](std::int32_t v) {
    const Vec3 off = Vec3(frame.places.row(v)) - from;
    return (off - along.dot(off) * along).norm() <= 0.02 * (to - from).norm();
  });
}

TriMesh rod_between(const Vec3& from, const Vec3& to, double radius) {
  const double half = 0.5 * (to - from).norm();
  TriMesh mesh = surface_of({{{-half, 0}, {half, 0}}, radius, -radius, radius, radius});
  Mat3 turn;  // some turn about the rod's own axis, because the rod is round
  turn.col(0) = (to - from).normalized();
  turn.col(1) = turn.col(0).unitOrthogonal();
  turn.col(2) = turn.col(0).cross(turn.col(1));
  mesh.points = (mesh.points * turn.transpose()).rowwise() + 0.5 * (from + to).transpose();
  return mesh;
}

// Describes an end of a body: the axis along which a part is the end, and on which side.
struct End {
  int axis;
  bool high;
};
std::optional<End> end_of(const Frame& frame, const Bounds& part) {
  std::optional<End> end;
  double least = 1e300;
  for (int axis = 0; axis < 3; ++axis) {
    const double near = std::min(0.5 * frame.edge, 0.1 * frame.box.extent()[axis]);
    const bool at_low = part.lower[axis] <= frame.box.lower[axis] + near;
    const bool at_high = part.upper[axis] >= frame.box.upper[axis] - near;
    const double share = part.extent()[axis] / std::max(frame.box.extent()[axis], 1e-300);
    if (at_low == at_high || share >= least) continue;
    least = share;
    end = {axis, at_high};
  }
  return end;
}

// Tells whether a side of the body lies on the ground, which is drawn at y = 0. The plate is then below the ground, and
// seen when the handle lifts the body.
bool stands(const Frame& frame, const End& end, double side) {
  const Vec3 along = frame.turn.col(end.axis);
  if (along.y() * (end.high ? 1 : -1) > -0.99) return false;
  Vec3 place = frame.box.center();
  place[end.axis] = side;
  return (frame.turn * place).y() < 1e-3 * frame.size;
}

// Makes a plate on the outermost layer of an end.
TriMesh plate_on(const Frame& frame, const HeldPart& part, const Bounds& box, const End& end) {
  const double side = end.high ? box.upper[end.axis] : box.lower[end.axis];
  HeldPart outer;
  for (const std::int32_t v : part) {
    if (std::abs(frame.places(v, end.axis) - side) <= frame.edge) outer.push_back(v);
  }
  // On a pointed tip, a plate would be too small to be seen, and would lie inside a skin that is finer than the mesh.
  Vec3 across = box_of(frame, outer).extent();
  across[end.axis] = 0;
  if (across.norm() < 4 * frame.pin) outer = part;
  const double thickness = plate_thickness(frame, box_of(frame, outer), end.axis);
  const double inside = (stands(frame, end, side) ? -below_ground : inside_by_plate) * thickness;
  const double outside = thickness - inside;
  return prism_around(frame, outer, end.axis, side - (end.high ? inside : outside),
                      side + (end.high ? outside : inside), thickness);
}

// Returns the axis along which a part is a whole slice of the body; nothing where it is not one.
std::optional<int> slice_of(const Frame& frame, const Bounds& part) {
  for (int axis = 0; axis < 3; ++axis) {
    const double near = 1e-6 * frame.size;
    if (part.lower[axis] <= frame.box.lower[axis] + near && part.upper[axis] >= frame.box.upper[axis] - near) continue;
    bool alone = true;
    for (Eigen::Index v = 0; v < frame.places.rows() && alone; ++v) {
      const double at = frame.places(v, axis);
      alone = frame.held[std::size_t(v)] != 0 || at < part.lower[axis] - near || at > part.upper[axis] + near;
    }
    if (alone) return axis;
  }
  return std::nullopt;
}

TriMesh ring_around(const Frame& frame, const HeldPart& part, const Bounds& box, int axis) {
  const double middle = box.center()[axis], widest = widest_ring * frame.box.extent()[axis];
  const double reach = 0.5 * std::min(box.extent()[axis], widest);
  HeldPart around;
  for (const std::int32_t v : part) {
    if (std::abs(frame.places(v, axis) - middle) <= reach + frame.edge) around.push_back(v);
  }
  const double thickness = plate_thickness(frame, box_of(frame, around), axis);
  const double half = std::max(0.5 * thickness, reach);
  return prism_around(frame, around, axis, middle - half, middle + half, thickness);
}

// Returns the area of the surface's triangles that are held. [m^2]
double held_area(const Frame& frame) {
  double area = 0;
  for (Eigen::Index t = 0; t < frame.surface.rows(); ++t) {
    Vec3 corners[3];
    bool whole = true;
    for (int k = 0; k < 3; ++k) {
      whole = whole && frame.held[std::size_t(frame.surface(t, k))] != 0;
      corners[k] = frame.places.row(frame.surface(t, k));
    }
    if (whole) area += 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
  }
  return area;
}

// Makes a clamp around a part of a cloth; nothing where the part is not flat, or the clamp would hide much more than it
// holds.
std::optional<TriMesh> clamp_on(const Frame& frame, const HeldPart& part, const Bounds& box) {
  int axis = 0;
  const Vec3 extent = box.extent();
  extent.minCoeff(&axis);
  if (extent[axis] > 0.05 * frame.size) return std::nullopt;
  if (held_area(frame) < least_fill * extent[(axis + 1) % 3] * extent[(axis + 2) % 3]) return std::nullopt;
  const double half = 0.5 * extent[axis] + frame.rod, middle = box.center()[axis];
  return prism_around(frame, part, axis, middle - half, middle + half, 2 * frame.rod);
}

// Makes pins in vertices that are far from each other.
std::vector<TriMesh> pins_in(const Frame& frame, const HeldPart& part) {
  HeldPart seen;
  for (const std::int32_t v : part) {
    if (frame.on_surface[std::size_t(v)] != 0) seen.push_back(v);
  }
  std::vector<TriMesh> pins;
  std::vector<double> away(seen.size(), 1e300);  // squared distance from the nearest pin
  while (!seen.empty() && pins.size() < most_pins) {
    const auto next = std::ranges::max_element(away) - away.begin();
    const double radius = frame.pin;
    if (away[std::size_t(next)] < 16 * radius * radius) break;
    const Vec3 place = frame.places.row(seen[std::size_t(next)]);
    pins.push_back(ball_at(place, radius));
    for (std::size_t i = 0; i < seen.size(); ++i)
      away[i] = std::min(away[i], (Vec3(frame.places.row(seen[i])) - place).squaredNorm());
  }
  return pins;
}

std::vector<TriMesh> supports_in(const Frame& frame, const HeldPart& part, bool cloth) {
  const bool seen = std::ranges::any_of(part, [&](std::int32_t v) { return frame.on_surface[std::size_t(v)] != 0; });
  if (!seen) return {};
  const Bounds box = box_of(frame, part);
  if (box.diagonal() <= 1e-6 * frame.size) return {ball_at(box.center(), frame.pin)};
  Vec3 from, to;
  if (is_line(frame, part, from, to)) return {rod_between(from, to, frame.rod)};
  if (cloth) {
    if (const auto clamp = clamp_on(frame, part, box)) return {*clamp};
    return pins_in(frame, part);
  }
  const auto end = end_of(frame, box);
  const double across = box.diagonal();
  const bool grabbed = frame.finer_skin && across < small_part * frame.size;
  if (grabbed && !(end && stands(frame, *end, end->high ? box.upper[end->axis] : box.lower[end->axis])))
    return {ball_at(box.center(), std::clamp(0.45 * across, frame.pin, std::max(frame.pin, largest_pin * frame.size)))};
  if (end) return {plate_on(frame, part, box, *end)};
  if (const auto axis = slice_of(frame, box)) return {ring_around(frame, part, box, *axis)};
  return pins_in(frame, part);
}

}  // namespace

std::vector<Support> supports_of(const Body& body) {
  std::vector<Support> supports;
  if (body.description.handles.empty()) return supports;
  Frame frame = frame_of(body);
  for (std::size_t h = 0; h < body.description.handles.size(); ++h) {
    if (body.def.handles[h].attach) continue;  // what carries it is seen already
    const Handle& handle = body.description.handles[h];
    const auto add = [&](TriMesh&& one) {
      one.points = one.points * frame.turn.transpose();
      supports.push_back({h, std::move(one)});
    };
    const std::vector<HeldPart> parts = parts_of(body, handle, frame);
    const bool scattered = parts.size() > most_pins;
    for (const HeldPart& part : scattered ? std::vector<HeldPart>{handle.vertices} : parts) {
      const bool cloth = body.def.cloth.has_value();
      for (TriMesh& one : scattered ? pins_in(frame, part) : supports_in(frame, part, cloth)) add(std::move(one));
    }
  }
  return supports;
}

// Held vertices that are one point or lie in a line fit several rotations equally well. Their supports are then balls
// and rods, which look the same in all of these.
Eigen::Isometry3d motion_of_held(const Body& body, std::size_t handle, const Positions& now) {
  const std::vector<std::int32_t>& vertices = body.description.handles[handle].vertices;
  const Positions& rest = body.description.mesh.rest;
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  for (const std::int32_t v : vertices) {
    from += rest.row(v).transpose() / static_cast<double>(vertices.size());
    to += now.row(v).transpose() / static_cast<double>(vertices.size());
  }
  Mat3 moments = Mat3::Zero();
  for (const std::int32_t v : vertices)
    moments += (now.row(v).transpose() - to) * (rest.row(v).transpose() - from).transpose();
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = nearest_rotation(moments);
  motion.translation() = to - motion.linear() * from;
  return motion;
}

}  // namespace supple
