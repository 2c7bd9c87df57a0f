#include "geometry/solids/solid_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <thread>

#include "base/error.h"
#include "geometry/solids/surface_closing.h"
#include "geometry/solids/winding_solid.h"

namespace supple {
namespace {

using Notes = std::vector<std::string>;

// Tries closed_surface's rules. Returns nothing, and why, where they refuse the surface.
std::optional<TriMesh> if_closed(const Numbered& surface, const std::string& name, Notes& notes, std::string& reason) {
  Notes own;
  try {
    TriMesh closed_one = closed(surface, name, &own);
    notes.insert(notes.end(), own.begin(), own.end());
    return closed_one;
  } catch (const InputError& error) {
    reason = error.problems().front().message;
    return std::nullopt;
  }
}

// Closes holes with caps. Returns nothing, and why, where caps do not make a closed surface.
std::optional<TriMesh> if_capped(const Numbered& surface, const std::string& name, Notes& notes, std::string& reason) {
  const Capped capped = with_caps(surface);
  reason = capped.refusal;
  if (!reason.empty()) return std::nullopt;
  auto result = if_closed(capped.surface, name, notes, reason);
  if (result)
    notes.push_back(fmt::format("{} hole{} closed with caps, the widest of {:.3g} at {}", capped.caps,
                                capped.caps == 1 ? " was" : "s were", capped.widest, place_text(capped.at)));
  return result;
}

// Tells whether caps are worth while although the surface counts as closed: with many open edges, the sign of each
// distance costs a sum over them all.
bool has_many_open_edges(const Numbered& surface) {
  constexpr Eigen::Index many = 32;
  Eigen::Index open = 0;
  for (const auto& sides : neighbours_of(surface).of)
    for (const Neighbour& side : sides) open += side.triangle < 0 ? 1 : 0;
  return open > many;
}

SolidSurface by_winding(const Numbered& surface, const std::string& reason, const std::string& name, Notes& notes) {
  Threads threads(int(std::max(1u, std::thread::hardware_concurrency())));
  WindingSolid found = winding_solid(surface, name, threads);
  const std::string why = reason.empty() ? "" : reason + "; ";
  notes.push_back(
      fmt::format("{}the solid is where its triangles wind around (close = \"winding\"), with details above "
                  "{:.2g}",
                  why, found.cell));
  if (found.turned > 0) notes.push_back(fmt::format("{} triangles were turned to face outward", found.turned));
  if (found.hidden > 0.005)
    notes.push_back(fmt::format("{:.0f} % of the triangles' area lies inside, and is not drawn", 100 * found.hidden));
  if (found.patched > 0.001)
    notes.push_back(
        fmt::format("{:.2g} % of the solid's surface was added where there are holes", 100 * found.patched));
  if (found.loose > 0.005) {
    notes.push_back(
        fmt::format("{:.2g} % of the triangles' area are sheets that enclose nothing: they are drawn, but "
                    "are no part of the solid (thicken = 0.01 makes them one)",
                    100 * found.loose));
  }
  return {std::move(found.boundary), std::move(found.drawn)};
}

SolidSurface thick(const Numbered& surface, double thickness, Notes& notes) {
  Thickened made = thickened(surface, thickness);
  if (made.sheets > 0) {
    notes.push_back(
        fmt::format("{} sheet{} {:.3g} thick", made.sheets, made.sheets == 1 ? " was made" : "s were made", thickness));
  }
  return {std::move(made.boundary), {}};
}

double metres(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::metre: return 1;
    case LengthUnit::centimetre: return 0.01;
    case LengthUnit::millimetre: return 0.001;
    case LengthUnit::kilometre: return 1000;
    case LengthUnit::inch: return 0.0254;
    case LengthUnit::foot: return 0.3048;
  }
  return 1;
}

}  // namespace

std::string SurfaceOptions::text() const {
  std::string text;
  if (close != Closing::automatic) text += fmt::format(" close {}", name_of(close));
  if (thickness > 0) text += fmt::format(" thick {:a}", thickness);
  if (up != UpAxis::y) text += fmt::format(" up {}", name_of(up));
  if (unit != LengthUnit::metre) text += fmt::format(" unit {}", name_of(unit));
  if (size > 0) text += fmt::format(" size {:a}", size);
  if (center) text += " centered";
  return text;
}

namespace {

void turn_and_scale(Positions& points, const SurfaceOptions& options) {
  // A turn by right angles exchanges coordinates, and needs no arithmetic.
  const auto exchange = [&points](int a, int b, int turned_over) {
    points.col(a).swap(points.col(b));
    points.col(turned_over) *= -1;
  };
  switch (options.up) {
    case UpAxis::y: break;
    case UpAxis::z: exchange(1, 2, 2); break;
    case UpAxis::x: exchange(0, 1, 0); break;
    case UpAxis::minus_z: exchange(1, 2, 1); break;
    case UpAxis::minus_x: exchange(0, 1, 1); break;
    case UpAxis::minus_y: points.rightCols(2) *= -1; break;
  }
  if (options.unit != LengthUnit::metre) points *= metres(options.unit);
}

// Returns how the options move and scale triangles by the box around them. turned: the triangles after
// turn_and_scale().
SetUp placed_by_box(const TriMesh& turned, const SurfaceOptions& options) {
  SetUp result{options};
  if (options.size == 0 && !options.center) return result;
  Bounds box;
  for (const std::int32_t v : turned.triangles.reshaped())
    if (v >= 0 && v < turned.points.rows() && turned.points.row(v).allFinite())
      box.include(turned.points.row(v).transpose());
  if (box.empty()) return result;  // whoever uses the triangles refuses them
  if (options.center) result.shift = Eigen::RowVector3d(box.center().x(), box.lower.y(), box.center().z());
  const double longest = box.extent().maxCoeff();
  if (options.size > 0 && longest > 0) result.factor = options.size / longest;
  return result;
}

void shift_and_scale(Positions& points, const SetUp& by) {
  if (by.options.center) points.rowwise() -= by.shift;
  if (by.factor != 1) points *= by.factor;
}

}  // namespace

Positions SetUp::placed(Positions points) const {
  turn_and_scale(points, options);
  shift_and_scale(points, *this);
  return points;
}

SetUp set_up_of(const TriMesh& raw, const SurfaceOptions& options) {
  TriMesh turned = raw;
  turn_and_scale(turned.points, options);
  return placed_by_box(turned, options);
}

TriMesh set_up(TriMesh raw, const SurfaceOptions& options) {
  turn_and_scale(raw.points, options);
  shift_and_scale(raw.points, placed_by_box(raw, options));
  return raw;
}

SolidSurface solid_surface(const TriMesh& triangles, const SurfaceOptions& options, const std::string& name,
                           std::vector<std::string>* notes) {
  Notes unwanted;
  if (notes == nullptr) notes = &unwanted;
  const Numbered surface = cleaned(triangles, name, notes);
  if (options.close == Closing::winding && options.thickness == 0) return by_winding(surface, "", name, *notes);
  std::string reason;
  Notes said;
  if (auto as_it_is = if_closed(surface, name, said, reason)) {
    std::string why;
    if (options.close != Closing::never && has_many_open_edges(surface))
      if (auto capped = if_capped(surface, name, *notes, why)) return {std::move(*capped), {}};
    notes->insert(notes->end(), said.begin(), said.end());
    return {std::move(*as_it_is), {}};
  }
  if (options.thickness > 0) return thick(surface, options.thickness, *notes);
  if (options.close == Closing::never)
    throw InputError(name, reason + "; close = \"auto\" closes it, and thicken = 0.01 makes a solid of its sheets");
  std::string why;
  if (auto capped = if_capped(surface, name, *notes, why)) return {std::move(*capped), {}};
  if (options.close == Closing::caps)
    throw InputError(name, fmt::format("caps do not close it: {}; close = \"winding\" does", why));
  return by_winding(surface, reason, name, *notes);
}

}  // namespace supple
