#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/summary.h"
#include "base/text.h"
#include "geometry/files/source_file.h"
#include "geometry/files/surface_file.h"
#include "geometry/solids/surface_pieces.h"
#include "geometry/triangles/surface_thickness.h"
#include "scene/reading/body_pieces.h"

namespace supple {
namespace {

std::string vertices_text(double vertices) {
  return vertices > 500000 ? "more than 500000" : fmt::format("about {:.0f}", std::ceil(vertices / 100) * 100);
}

std::string piece_text(const SolidSurface& piece, double volume, std::size_t number) {
  const std::vector<ThicknessSample> samples = sampled_thickness(piece.boundary);
  const Vec3 extent = bounds_of(piece.boundary.points).extent();
  std::string text = fmt::format("piece {:<10}{:.4g} x {:.4g} x {:.4g}, volume {:.4g}, {} triangles\n", number,
                                 extent.x(), extent.y(), extent.z(), volume, piece.skin().triangles.rows());
  if (samples.empty()) return text;
  const Vec3& place = samples.front().place;
  return text + fmt::format(
                    "  thickness     {:.3g} in the middle, {:.3g} at the thinnest twentieth, least at ({:.3g}, {:.3g}, "
                    "{:.3g})\n  vertices      {} resolve all but the thinnest twentieth\n",
                    samples[samples.size() / 2].thickness, samples[samples.size() / 20].thickness, place.x(), place.y(),
                    place.z(), vertices_text(vertices_wanted(samples, volume, area_of(piece.boundary))));
}

// Lists the names by which handles can select.
std::string names_line(const std::vector<std::vector<std::string>>& of_parts) {
  std::vector<std::string> names;
  for (const std::vector<std::string>& one : of_parts) names.insert(names.end(), one.begin(), one.end());
  return names.empty() ? "" : fmt::format("groups          {}\n", name_list(names));
}

}  // namespace

std::string surface_summary(const std::filesystem::path& file) {
  BodyDef def;
  def.surface = file;
  const BodySurface read = read_body_surface(def);
  std::string text;
  for (const std::string& note : read.notes) text += fmt::format("note: {}\n", note);
  const Vec3 extent = read.box.extent();
  text += fmt::format("surface         {}\nextent          {:.4g} x {:.4g} x {:.4g} in the file's units\n",
                      file.string(), extent.x(), extent.y(), extent.z());
  text += fmt::format("colours         {}\n", read.found.empty() ? "none" : read.found);
  text += names_line(read.names);
  const auto is_open = [](const std::string& note) {
    return note.find("the surface is open") != note.npos || note.find("closed with caps") != note.npos;
  };
  if (std::ranges::any_of(read.notes, is_open))
    text += fmt::format("cloth           a body can have its triangles as they are: cloth = {{ surface = \"{}\" }}\n",
                        file.filename().string());
  constexpr std::size_t most = 12;
  for (std::size_t p = 0; p < std::min(most, read.pieces.size()); ++p)
    text += piece_text(read.pieces[p], read.volumes[p], p + 1);
  if (read.pieces.size() > most) text += fmt::format("and {} smaller pieces\n", read.pieces.size() - most);
  return text + "as supple render shows it, half a metre long:\n";
}

}  // namespace supple
