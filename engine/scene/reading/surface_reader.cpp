// Reads how a surface from a file is taken.
#include "scene/reading/table_readers.h"

namespace supple {

SurfaceOptions read_surface_options(const ConfigTable& table) {
  SurfaceOptions options;
  options.close =
      table.word<Closing>({"close", "",
                           "what makes a solid of a surface that is not closed: auto: caps where holes are all that is "
                           "wrong, else winding; "
                           "caps in its holes; winding: where its triangles wind around; never: it is refused"},
                          options.close);
  options.thickness =
      table
          .number_if_given(
              {"thicken", "m", "thickness that parts of a surface with a rim get; without it they are closed"},
              Range::above(0, 1e6))
          .value_or(0);
  options.up = table.word<UpAxis>(
      {"up", "", "the axis of the surface's file that points up; with a minus, its opposite does"}, options.up);
  options.unit = table.word<LengthUnit>({"units", "", "of the surface's file"}, options.unit);
  for (const char* key : {"close", "thicken", "up", "units"}) {
    const bool of_cloth = std::string_view(key) == "up" || std::string_view(key) == "units";
    if (table.has(key) && !table.has("surface") && !(of_cloth && table.has("cloth")))
      table.complain(key, fmt::format("{}: of a 'surface'; there is none here", key));
  }
  return options;
}

}  // namespace supple
