#include "scene/reading/seam_reader.h"

#include <fmt/core.h>

namespace supple {
namespace {

SeamDef read_seam(const ConfigTable& row) {
  constexpr Key side{"side", "",
                     "points, relative to the rest bounding box (0 to 1): the seam goes along the border from the "
                     "vertex nearest to the first, past the others, to that nearest to the last, each time the shorter "
                     "way"};
  constexpr Key onto{"onto", "", "the same of what it is sewn onto, first to first and last to last"};
  SeamDef seam;
  for (std::size_t s = 0; s < 2; ++s) {
    const Key& key = s == 0 ? side : onto;
    seam.sides[s] = row.vectors(key, 0);
    seam.places[s] = row.place(key.name);
    if (seam.sides[s].size() == 1)
      row.complain(key.name, fmt::format("{}: two points at least, where it begins and where it ends", key.name));
  }
  return seam;
}

}  // namespace

void read_seams(const ConfigTable& cloth_table, ClothDef& cloth) {
  for (const ConfigTable& row :
       cloth_table.tables({"seams", "", "stretches of the border that lie apart and are drawn together"}))
    cloth.seams.push_back(read_seam(row));
  cloth.seam_time = cloth_table.number({"seam_time", "s", "how long seams take to close, from the start of the film"},
                                       1.0, Range::above(0, 1e6));
  if (cloth_table.has("seam_time") && cloth.seams.empty())
    cloth_table.complain("seam_time", "seam_time: of seams; there are none here");
}

}  // namespace supple
