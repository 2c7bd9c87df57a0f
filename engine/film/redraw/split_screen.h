// Puts the pictures of several drawings side by side, with words below each: a film that compares runs. Not here: how
// each run is drawn (redraw.h).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/names.h"
#include "output/run/profile.h"
#include "render/draw_list.h"

namespace supple {

enum class Layout { row, column, grid };
template <>
struct Names<Layout> {
  static constexpr std::array table = {Name{Layout::row, "row"}, Name{Layout::column, "column"},
                                       Name{Layout::grid, "grid"}};
};

// Returns how many columns so many panels have.
int columns_of(Layout layout, int panels);

// Describes one run of a split screen.
struct Panel {
  std::filesystem::path frames;  // the folder of its pictures, which all have one size
  std::string name;              // in the first line below it
  std::vector<FrameRow> rows;    // of the run's profile; empty where it has none
};

// Describes a split screen. Panels have no legend of their own, because it would cover much of a narrow one: all have
// the same colours, and the legend stands at the right of them all.
struct SplitScreen {
  std::vector<Panel> panels;
  int columns = 1;
  Font font;                        // empty: no words
  std::optional<FieldLook> legend;  // of the field that all panels show
};

// Returns the second line below a panel for a frame of its run: the time of its steps, its iterations, and the last
// errors measured up to that frame (of equation 12 and of motion), or else their estimates after a "~". Times and
// iterations are sums over all bodies, errors the largest of any body. Empty without rows.
std::string figures_of(const std::vector<FrameRow>& rows, int frame);

// Composes picture number `picture` of all panels, which show this frame of the runs. Width and height are even. Throws
// InputError when a picture cannot be read or has another size than the first.
Image split_picture(const SplitScreen& screen, int picture, int frame);

}  // namespace supple
