#include "film/redraw/split_screen.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "output/files/png_file.h"
#include "output/run/run_folder.h"
#include "render/legend.h"
#include "render/sticker.h"
#include "render/text_bitmap.h"

namespace supple {
namespace {

const Vec3 strip_ink(0.2, 0.2, 0.21), soft_ink(0.38, 0.38, 0.4), strip_paper(0.96, 0.95, 0.94);

int even(int number) { return number + number % 2; }

// Holds the sizes of a split screen's parts [pixels].
struct Grid {
  int panel_width, panel_height, gap, em, small_em, strip, columns, rows;
  int legend = 0;  // width of the column at the right
  int panels_width() const { return columns * panel_width + (columns - 1) * gap; }
  int width() const { return even(panels_width() + legend); }
  int height() const { return even(rows * (panel_height + strip)); }
};

Grid grid_of(const PngImage& first, int panels, int columns) {
  Grid grid{};
  grid.panel_width = first.width;
  grid.panel_height = first.height;
  grid.columns = columns;
  grid.rows = (panels + columns - 1) / columns;
  grid.gap = std::max(2, first.width / 160) & ~1;
  // Words fit the height of a panel; below a flat one they are larger, and below a narrow one smaller.
  const double em = std::min(std::max(first.height / 22.0, first.width / 55.0), first.width / 30.0);
  grid.em = std::max(10, static_cast<int>(std::lround(em)));
  grid.small_em = std::max(9, grid.em * 4 / 5);
  grid.strip = 3 * grid.em + grid.em / 2;
  return grid;
}

// Returns the size, `em` or less, at which a text is no wider than its panel [pixels].
int fitting_em(const Font& font, const std::string& text, int em, int width) {
  while (em > 7 && draw_text(font, text, em).width > width) --em;
  return em;
}

void write_line(Sticker& strip, const Font& font, const std::string& text, int em, int y, const Vec3& color) {
  if (text.empty() || font.empty()) return;
  const int fitting = fitting_em(font, text, em, strip.width() - em);
  strip.text(font, text, fitting, (strip.width() - draw_text(font, text, fitting).width) / 2, y, color);
}

void paste(const PngImage& panel, Image& image, int x, int y) {
  for (int row = 0; row < panel.height; ++row)
    std::copy_n(&panel.rgb[3 * std::size_t(row) * panel.width], 3 * std::size_t(panel.width),
                &image.rgb[3 * (std::size_t(y + row) * image.width + x)]);
}

Image blank(const Grid& grid) {
  Image image = {
      grid.width(), grid.height(), std::vector<std::uint8_t>(3 * std::size_t(grid.width()) * grid.height()), {}};
  Sticker background(image.width, image.height);
  background.fill({0, 0, image.width, image.height}, strip_paper);
  background.onto(image, 0, 0);
  return image;
}

}  // namespace

int columns_of(Layout layout, int panels) {
  if (layout == Layout::row) return panels;
  if (layout == Layout::column) return 1;
  return static_cast<int>(std::ceil(std::sqrt(static_cast<double>(panels))));
}

std::string figures_of(const std::vector<FrameRow>& rows, int frame) {
  if (frame < 0 || frame >= static_cast<int>(rows.size())) return "";
  const FrameRow& row = rows[frame];
  int iterations = 0;
  double estimate = 0, motion_estimate = 0, error = 0, motion_error = 0;
  for (const BodyRow& body : row.bodies) {
    iterations += body.iterations;
    estimate = std::max(estimate, body.error_estimate);
    motion_estimate = std::max(motion_estimate, body.motion_estimate);
  }
  bool measured = false;
  for (int at = frame; at >= 0 && !measured; --at) {
    for (const BodyRow& body : rows[at].bodies) {
      measured = measured || body.error_measured;
      error = std::max(error, body.error.value_or(0));
      motion_error = std::max(motion_error, body.motion_error.value_or(0));
    }
  }
  return fmt::format("{:.1f} ms, {} iteration{}, errors {}{:.0e}, {:.0e}", row.step_ms, iterations,
                     iterations == 1 ? "" : "s", measured ? "" : "~ ", measured ? error : estimate,
                     measured ? motion_error : motion_estimate);
}

Image split_picture(const SplitScreen& screen, int picture, int frame) {
  Image image;
  Grid grid{};
  Sticker legend;
  for (std::size_t p = 0; p < screen.panels.size(); ++p) {
    const PngImage panel = read_png(picture_file(screen.panels[p].frames, picture));
    if (p == 0) {
      grid = grid_of(panel, static_cast<int>(screen.panels.size()), screen.columns);
      if (screen.legend) legend = legend_of(*screen.legend, screen.font, panel.width, panel.height);
      if (legend.width() > 0) grid.legend = legend.width() + 2 * grid.em;
      image = blank(grid);
    }
    const int x = static_cast<int>(p) % grid.columns * (grid.panel_width + grid.gap);
    const int y = static_cast<int>(p) / grid.columns * (grid.panel_height + grid.strip);
    paste(panel, image, x, y);
    Sticker strip(grid.panel_width, grid.strip);
    write_line(strip, screen.font, screen.panels[p].name, grid.em, grid.em / 3, strip_ink);
    write_line(strip, screen.font, figures_of(screen.panels[p].rows, frame), grid.small_em,
               grid.em / 3 + 3 * grid.em / 2, soft_ink);
    strip.onto(image, x, y + grid.panel_height);
  }
  const int middle = (image.height - grid.strip - legend.height()) / 2;
  if (legend.width() > 0) legend.onto(image, grid.panels_width() + grid.em, middle);
  return image;
}

}  // namespace supple
