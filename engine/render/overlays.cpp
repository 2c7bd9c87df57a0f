#include "render/overlays.h"

#include <algorithm>
#include <optional>

#include "render/captions.h"
#include "render/graphs.h"
#include "render/legend.h"
#include "render/projection.h"
#include "render/subtitles.h"

namespace supple {
namespace {

// Returns the outlines of the bodies' boxes in the first picture.
std::vector<Outline> bodies_of(const Stage& stage) {
  const Projection project(stage.first_camera, framed_at_start(stage), stage.width, stage.height);
  std::vector<Outline> bodies;
  for (const DrawMesh& mesh : stage.meshes) {
    if (mesh.kept_clear) bodies.push_back(project.outline(mesh.rest));
  }
  return bodies;
}

// Places rectangles side by side, the last one at the right, in a corner.
std::vector<PixelRect> in_corner(std::vector<PixelRect> sizes, const Stage& stage, bool right, int top_margin,
                                 bool top) {
  const int margin = overlay_margin(stage), gap = margin / 2;
  int width = -gap, height = 0;
  for (const PixelRect& size : sizes) {
    width += size.width + gap;
    height = std::max(height, size.height);
  }
  int x = right ? stage.width - margin - width : margin;
  for (PixelRect& size : sizes) {
    size.x = x;
    size.y = top ? top_margin : stage.height - margin - height;
    x += size.width + gap;
  }
  return sizes;
}

// Returns how much of a rectangle lies in the box of an outline [pixels^2].
double area_in_box(const PixelRect& rectangle, const Outline& outline) {
  Eigen::Array2d low(1e9, 1e9), high(-1e9, -1e9);
  for (const Eigen::Vector2d& corner : outline) {
    low = low.min(corner.array());
    high = high.max(corner.array());
  }
  const double width = std::min<double>(rectangle.right(), high.x()) - std::max<double>(rectangle.x, low.x());
  const double height = std::min<double>(rectangle.bottom(), high.y()) - std::max<double>(rectangle.y, low.y());
  return std::max(0.0, width) * std::max(0.0, height);
}

std::vector<PixelRect> graph_places(const Stage& stage, const OverlayPlaces& others) {
  const std::vector<PixelRect> sizes = graph_sizes(stage);
  if (sizes.empty()) return {};
  std::vector<PixelRect> taken = others.all();
  if (others.subtitles.width > 0) taken.push_back(others.subtitles);
  const std::vector<Outline> bodies = bodies_of(stage);
  Captions captions(stage, others.all(), others.subtitles);
  const std::vector<Captions::Placed> placed = captions.places(stage.first_camera);
  const int margin = overlay_margin(stage), below = std::max(margin, others.headline.bottom() + margin / 2);
  const std::vector<std::vector<PixelRect>> corners = {
      in_corner(sizes, stage, true, margin, true), in_corner(sizes, stage, true, below, true),
      in_corner(sizes, stage, false, below, true), in_corner(sizes, stage, true, 0, false),
      in_corner(sizes, stage, false, 0, false)};
  const double a_picture = static_cast<double>(stage.width) * stage.height;
  std::optional<double> least;
  std::vector<PixelRect> best;
  for (const std::vector<PixelRect>& corner : corners) {
    const bool free = std::ranges::all_of(corner, [&](const PixelRect& graph) {
      const auto text = [&graph](const PixelRect& other) { return graph.overlaps(other); };
      return graph.x >= 0 && graph.y >= 0 && graph.right() <= stage.width && graph.bottom() <= stage.height &&
             std::ranges::none_of(taken, text);
    });
    if (!free) continue;
    double covered = 0;
    for (const PixelRect& graph : corner) {
      // A caption may have no other place than the one below its body.
      for (const Captions::Placed& caption : placed) covered += graph.overlaps(caption.place) ? a_picture : 0;
      for (const Outline& body : bodies) covered += overlaps(graph, body) ? area_in_box(graph, body) : 0;
    }
    if (least && covered >= *least) continue;
    least = covered;
    best = corner;
  }
  return best;
}

}  // namespace

std::vector<PixelRect> OverlayPlaces::all() const {
  std::vector<PixelRect> places = graphs;
  for (const PixelRect& one : {headline, legend}) {
    if (one.width > 0) places.push_back(one);
  }
  return places;
}

OverlayPlaces overlay_places(const Stage& stage) {
  OverlayPlaces places;
  if (stage.font.empty()) return places;
  if (!stage.headline_template.empty()) {
    const Sticker line = headline_of(stage, stage.headline_template);
    places.headline = {overlay_margin(stage), overlay_margin(stage), line.width(), line.height()};
  }
  if (stage.field) {
    const Sticker legend = legend_of(*stage.field, stage.font, stage.width, stage.height);
    const int x = stage.width - legend_margin(stage) - legend.width(), y = (stage.height - legend.height()) / 2;
    if (legend.width() > 0) places.legend = {x, y, legend.width(), legend.height()};
  }
  places.subtitles = Subtitles(stage).room();
  places.graphs = graph_places(stage, places);
  return places;
}

}  // namespace supple
