#include "render/graphs.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "render/text_bitmap.h"

namespace supple {
namespace {

const Vec3 grid(0.72, 0.72, 0.71), line_color(0.70, 0.27, 0.07), dot_color(0.10, 0.33, 0.58);
constexpr double graph_opacity = 0.86;

// Holds the sizes of a graph's parts [pixels].
struct GraphLayout {
  int em, line, pad, labels, plot_width, plot_height, title;
  int left() const { return pad + labels + pad / 2; }
  int top() const { return pad + 2 * line; }  // the highest number stands beside the plot's top
  int width() const { return std::max(left() + plot_width, pad + title) + pad; }
  int height() const { return top() + plot_height + line / 2 + pad; }
};

GraphLayout layout_of(const GraphLook& graph, const Stage& stage) {
  GraphLayout layout{};
  const int height = height_for_letters(stage.width, stage.height);
  layout.em = std::max(9, static_cast<int>(std::lround(height / 40.0)));
  layout.pad = std::max(4, layout.em / 2);
  const TextBitmap title = draw_text(stage.font, graph.title, layout.em);
  layout.line = title.height;
  layout.title = title.width;
  for (const auto& [place, value] : graph.ticks)
    layout.labels = std::max(layout.labels, draw_text(stage.font, value, layout.em).width);
  layout.plot_width = static_cast<int>(std::min(0.28 * height, 0.22 * stage.width));
  layout.plot_height = static_cast<int>(0.11 * height);
  return layout;
}

PixelRect inside_of(const GraphLayout& layout) {
  return {layout.left(), layout.top(), layout.plot_width, layout.plot_height};
}

Sticker plate_of(const GraphLook& graph, const Stage& stage) {
  const GraphLayout layout = layout_of(graph, stage);
  const PixelRect inside = inside_of(layout);
  Sticker plate(layout.width(), layout.height());
  plate.plate({0, 0, layout.width(), layout.height()}, 0.5 * layout.em, paper, graph_opacity);
  plate.text(stage.font, graph.title, layout.em, layout.pad, layout.pad, ink);
  const int mark = std::max(1, layout.em / 12);
  // Where there is little room, only the first and the last value are told.
  const auto gaps = static_cast<int>(graph.ticks.size()) - 1;
  const bool all = gaps * layout.line <= inside.height;
  for (const auto& [place, value] : graph.ticks) {
    const int row = inside.y + static_cast<int>(std::lround((1 - place) * (inside.height - 1)));
    plate.fill({inside.x, row - mark / 2, inside.width, mark}, grid);
    if (!all && place > 0 && place < 1) continue;
    const TextBitmap label = draw_text(stage.font, value, layout.em);
    plate.text(stage.font, value, layout.em, layout.pad + layout.labels - label.width, row - layout.line / 2, ink);
  }
  return plate;
}

// Holds how much of each pixel of a plate a curve covers, from 0 to 1. Where parts of it meet, the larger share counts,
// so that joints are no darker than the rest.
class Coverage {
 public:
  Coverage(int width, int height) : width_(width), height_(height), share_(std::size_t(width) * height, 0.0f) {}

  // Covers what lies within a radius of the way between two places [pixels].
  void add(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius) {
    const Eigen::Vector2d way = to - from;
    const double length2 = std::max(way.squaredNorm(), 1e-12);
    const int left = at(std::min(from.x(), to.x()) - radius, width_),
              right = at(std::max(from.x(), to.x()) + radius, width_);
    const int top = at(std::min(from.y(), to.y()) - radius, height_);
    const int bottom = at(std::max(from.y(), to.y()) + radius, height_);
    for (int y = top; y <= bottom; ++y) {
      for (int x = left; x <= right; ++x) {
        const Eigen::Vector2d pixel(x + 0.5, y + 0.5);
        const double along = std::clamp((pixel - from).dot(way) / length2, 0.0, 1.0);
        const double share = std::clamp(radius - (pixel - from - along * way).norm() + 0.5, 0.0, 1.0);
        float& most = share_[std::size_t(y) * width_ + x];
        most = std::max(most, static_cast<float>(share));
      }
    }
  }

  void onto(Sticker& plate, const Vec3& color) const {
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) plate.fill({x, y, 1, 1}, color, share_[std::size_t(y) * width_ + x]);
    }
  }

 private:
  static int at(double place, int size) { return std::clamp(static_cast<int>(std::floor(place)), 0, size - 1); }

  int width_, height_;
  std::vector<float> share_;
};

// Returns the places of a curve's values in its plate; nothing where there is none.
std::vector<std::optional<Eigen::Vector2d>> places_of(const std::vector<double>& values, const PixelRect& inside,
                                                      int frames) {
  std::vector<std::optional<Eigen::Vector2d>> places;
  for (std::size_t f = 0; f < values.size(); ++f) {
    const double x = inside.x + (static_cast<double>(f) + 0.5) * inside.width / frames;
    const double y = inside.y + 0.5 + (1 - values[f]) * (inside.height - 1);
    places.push_back(std::isnan(values[f]) ? std::nullopt : std::optional(Eigen::Vector2d(x, y)));
  }
  return places;
}

void draw_curve(Sticker& plate, const PixelRect& inside, const GraphCurve& curve, int frames) {
  const double radius = std::max(0.7, inside.height / 64.0);
  Coverage line(plate.width(), plate.height()), dots = line;
  const auto places = places_of(curve.line, inside, frames);
  for (std::size_t f = 0; f < places.size(); ++f) {
    if (places[f]) line.add(*places[f], f > 0 && places[f - 1] ? *places[f - 1] : *places[f], radius);
  }
  if (!places.empty() && places.back()) line.add(*places.back(), *places.back(), 3 * radius);
  for (const auto& place : places_of(curve.dots, inside, frames)) {
    if (place) dots.add(*place, *place, 2.2 * radius);
  }
  line.onto(plate, line_color);
  dots.onto(plate, dot_color);
}

}  // namespace

std::vector<PixelRect> graph_sizes(const Stage& stage) {
  std::vector<PixelRect> sizes;
  if (stage.font.empty()) return sizes;
  for (const GraphLook& graph : stage.graphs) {
    const GraphLayout layout = layout_of(graph, stage);
    sizes.push_back({0, 0, layout.width(), layout.height()});
  }
  return sizes;
}

Graphs::Graphs(const Stage& stage, std::vector<PixelRect> places) : graphs_(stage.graphs), places_(std::move(places)) {
  for (std::size_t i = 0; i < places_.size(); ++i) {
    plates_.push_back(plate_of(graphs_[i], stage));
    inside_.push_back(inside_of(layout_of(graphs_[i], stage)));
  }
}

void Graphs::draw(Image& image, const std::vector<GraphCurve>& curves) const {
  for (std::size_t i = 0; i < std::min(places_.size(), curves.size()); ++i) {
    Sticker plate = plates_[i];
    draw_curve(plate, inside_[i], curves[i], graphs_[i].frames);
    plate.onto(image, places_[i].x, places_[i].y);
  }
}

}  // namespace supple
