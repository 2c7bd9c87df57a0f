#include "render/legend.h"

#include <algorithm>
#include <cmath>

#include "render/text_bitmap.h"

namespace supple {
namespace {

constexpr double legend_opacity = 0.82;  // text stays legible on any background, and what lies behind can be guessed

// Holds the sizes of a legend's parts [pixels].
struct LegendLayout {
  int em, line, pad, bar_width, bar_height, labels, width, height;
  // Half a line lies between the title and the highest number, which stands beside the top of the bar.
  int bar_top() const { return pad + 2 * line; }
};

LegendLayout layout_of(const FieldLook& field, const Font& font, int picture_height) {
  LegendLayout layout{};
  layout.em = std::max(9, static_cast<int>(std::lround(picture_height / 36.0)));
  const TextBitmap title = draw_text(font, field.title, layout.em);
  layout.line = title.height;
  layout.pad = std::max(4, layout.em / 2);
  layout.bar_width = std::max(6, layout.em * 3 / 4);
  layout.bar_height = static_cast<int>(0.4 * picture_height);
  for (const auto& [place, value] : field.ticks)
    layout.labels = std::max(layout.labels, draw_text(font, value, layout.em).width);
  layout.width = 2 * layout.pad + std::max(title.width, layout.bar_width + layout.pad + layout.labels);
  layout.height = layout.bar_top() + layout.bar_height + layout.line / 2 + layout.pad;
  return layout;
}

}  // namespace

Sticker legend_of(const FieldLook& field, const Font& font, int width, int height) {
  if (field.title.empty() || font.empty()) return {};
  const LegendLayout layout = layout_of(field, font, std::min(height, width * 3 / 4));
  Sticker legend(layout.width, layout.height);
  legend.plate({0, 0, layout.width, layout.height}, 0.5 * layout.em, paper, legend_opacity);
  legend.text(font, field.title, layout.em, layout.pad, layout.pad, ink);
  const int top = layout.bar_top(), left = layout.pad;
  for (int row = 0; row < layout.bar_height; ++row) {
    const double place = 1 - (row + 0.5) / layout.bar_height;
    const auto color = static_cast<std::size_t>(place * static_cast<double>(field.colors.size()));
    legend.fill({left, top + row, layout.bar_width, 1}, field.colors[std::min(color, field.colors.size() - 1)]);
  }
  for (const auto& [place, value] : field.ticks) {
    const int row = top + static_cast<int>(std::lround((1 - place) * (layout.bar_height - 1)));
    const int mark = std::max(1, layout.em / 10);
    legend.fill({left + layout.bar_width, row - mark / 2, std::max(2, layout.pad / 2), mark}, ink);
    legend.text(font, value, layout.em, left + layout.bar_width + layout.pad, row - layout.line / 2, ink);
  }
  return legend;
}

int legend_margin(const Stage& stage) { return height_for_letters(stage.width, stage.height) / 36; }

int overlay_margin(const Stage& stage) { return std::max(4, height_for_letters(stage.width, stage.height) / 45); }

double legend_room(const Stage& stage) {
  constexpr double most = 0.3;
  const int width = stage.field ? legend_of(*stage.field, stage.font, stage.width, stage.height).width() : 0;
  return width > 0 ? std::min(most, double(width + legend_margin(stage)) / stage.width) : 0;
}

Vec3 ink_on(const Stage& stage) {
  return backdrop_of(stage).mean() < 0.4 ? Vec3(0.93, 0.93, 0.92) : Vec3(0.2, 0.2, 0.21);
}

Sticker headline_of(const Stage& stage, const std::string& text) {
  constexpr int smallest = 9;
  const int height = height_for_letters(stage.width, stage.height), room = stage.width - 2 * overlay_margin(stage);
  int em = std::max(smallest, static_cast<int>(std::lround(height / 32.0)));
  const auto wide = [&] {
    return draw_text(stage.font, stage.headline_template, em).width + 2 * Sticker::halo(em) > room;
  };
  while (em > smallest && wide()) --em;
  const int halo = Sticker::halo(em);
  const TextBitmap bitmap = draw_text(stage.font, text, em);
  Sticker line(bitmap.width + 2 * halo, bitmap.height + 2 * halo);
  line.text_with_halo(stage.font, text, em, halo, halo, ink_on(stage));
  return line;
}

}  // namespace supple
