#include "scene/reading/body_pieces.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/files/surface_file.h"
#include "scene/reading/known_surfaces.h"

namespace supple {
namespace {

constexpr double touching_gap = 0.005;  // parts with a smaller gap touch; over the diagonal of the whole
constexpr double crumb = 0.005;         // smaller pieces are left out; over the volume of all pieces

std::vector<std::string> text_of_pieces(const SurfacePieces& found, std::size_t kept, Pieces rule) {
  const std::size_t count = found.pieces.size();
  if (count == 1) return {};
  const double all = std::accumulate(found.volumes.begin(), found.volumes.end(), 0.0);
  const double left = std::accumulate(found.volumes.begin() + std::ptrdiff_t(kept), found.volumes.end(), 0.0);
  std::string text = fmt::format("the surface has {} pieces", count);
  if (kept > 1)
    text += fmt::format(", {} of which become bodies of their own", kept == count ? "all" : fmt::format("{}", kept));
  if (kept == 1) text += ", of which the largest is the body";
  if (kept < count) text += fmt::format("; the rest, {:.2g} % of the volume, is left out", 100 * left / all);
  if (kept > 1)
    text += rule == Pieces::join ? " (pieces = \"largest\" takes one)" : " (pieces = \"join\" unites those that touch)";
  return {text};
}

bool any_handle_selects(const BodyDef& body, Selection::Kind kind) {
  return std::ranges::any_of(body.handles, [&](const HandleDef& handle) { return handle.select.kind == kind; });
}

bool asks_for_names(const BodyDef& body) { return any_handle_selects(body, Selection::Kind::group); }

bool asks_for_places(const BodyDef& body) { return any_handle_selects(body, Selection::Kind::mask); }

}  // namespace

BodySurface read_body_surface(const BodyDef& body) {
  BodySurface result;
  ColoredSurface file = read_colored_surface(body.surface);
  file.mesh = set_up(std::move(file.mesh), body.surface_options);
  SolidSurface solid = solid_surface(file.mesh, body.surface_options, body.surface.string(), &result.notes);
  result.notes.insert(result.notes.end(), file.remarks.begin(), file.remarks.end());
  result.found = file.found;
  result.names = file.parts.names;
  result.box = bounds_of(solid.boundary.points);
  const Joining joining = body.pieces == Pieces::bodies ? Joining::cavities : Joining::near;
  SurfacePieces found = pieces_of(std::move(solid), joining, touching_gap * result.box.diagonal());
  const double least = crumb * std::accumulate(found.volumes.begin(), found.volumes.end(), 0.0);
  std::size_t kept = 1;
  while (body.pieces != Pieces::largest && kept < found.pieces.size() && found.volumes[kept] >= least) ++kept;
  if (kept > 100) {
    throw InputError(
        body.surface.string(),
        fmt::format("has {} pieces, and at most 100 can be bodies: pieces = \"largest\" takes one of them{}", kept,
                    body.pieces == Pieces::bodies ? ", pieces = \"join\" unites those that touch" : ""));
  }
  result.touching = found.touching;
  for (const std::string& line : text_of_pieces(found, kept, body.pieces)) result.notes.push_back(line);
  found.pieces.resize(kept);
  found.volumes.resize(kept);
  Eigen::Index points = 0;
  for (const SolidSurface& piece : found.pieces) points += piece.boundary.points.rows();
  result.whole.resize(points, 3);
  Eigen::Index row = 0;
  for (const SolidSurface& piece : found.pieces) {
    result.sources.push_back(source_of(body.surface, piece));
    result.colors.push_back(colors_on(piece.skin(), file));
    result.parts.push_back(asks_for_names(body) ? parts_on(piece.skin(), file) : nullptr);
    result.places.push_back(asks_for_places(body) ? places_on(piece.skin(), file) : nullptr);
    result.whole.middleRows(row, piece.boundary.points.rows()) = piece.boundary.points;
    row += piece.boundary.points.rows();
  }
  result.pieces = std::move(found.pieces);
  result.volumes = std::move(found.volumes);
  return result;
}

std::vector<BodyDef> bodies_of(const ConfigTable& table, BodyDef body) {
  if (body.surface.empty()) return {std::move(body)};
  auto& known = known_surfaces(table.config())->of_bodies;
  const std::string name =
      fmt::format("{}{} {}{}{}", body.surface.string(), body.surface_options.text(), name_of(body.pieces),
                  asks_for_names(body) ? " with names" : "", asks_for_places(body) ? " with places" : "");
  try {
    std::shared_ptr<const BodySurface>& read = known[name];
    if (!read) read = std::make_shared<BodySurface>(read_body_surface(body));
    body.read_surface = read;
  } catch (const InputError& error) {
    for (const Problem& problem : error.problems()) table.config().complain(problem);
    return {std::move(body)};
  }
  const BodySurface& read = *body.read_surface;
  if (read.pieces.size() == 1) return {std::move(body)};
  constexpr int fewest = 100;  // vertices of a piece
  const double all = std::accumulate(read.volumes.begin(), read.volumes.end(), 0.0);
  std::vector<BodyDef> bodies;
  for (std::size_t p = 0; p < read.pieces.size(); ++p) {
    BodyDef piece = body;
    piece.piece = p;
    piece.name = fmt::format("{}_{}", body.name, p + 1);
    piece.label = body.label == body.name ? piece.name : body.label;
    piece.vertices = std::max(std::min(fewest, body.vertices), int(std::lround(body.vertices * read.volumes[p] / all)));
    bodies.push_back(std::move(piece));
  }
  return bodies;
}

}  // namespace supple
