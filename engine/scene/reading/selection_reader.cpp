#include "scene/reading/selection_reader.h"

#include <fmt/core.h>

#include "base/text.h"
#include "geometry/files/surface_file.h"

namespace supple {
namespace {

using Kind = Selection::Kind;

Key key_of(Kind kind, const char* meaning) { return Key{name_of(kind).data(), "", meaning}; }

bool gives(const ConfigTable& table, Kind kind) { return table.has(name_of(kind).data()); }

void read_box_of(const ConfigTable& table, Selection& s) {
  const std::vector<Vec3> corners =
      table.vectors(key_of(Kind::box, "lower and upper corner, relative to the rest bounding box (0 to 1)"), 2);
  if (corners.size() != 2) return;
  s.lower = corners[0];
  s.upper = corners[1];
  if ((s.lower.array() > s.upper.array()).any()) table.complain("box", "box: the first corner must be the lower one");
}

// Reads what is selected by places of the rest box, and returns how many kinds of selection the table gives.
int read_placed(const ConfigTable& table, Selection& s) {
  int given = 0;
  const auto pick = [&](Kind kind) {
    ++given;
    s.kind = kind;
  };
  if (gives(table, Kind::box)) {
    pick(Kind::box);
    read_box_of(table, s);
  }
  if (const auto sphere = table.table(key_of(Kind::sphere, "vertices in a ball"))) {
    pick(Kind::sphere);
    s.center = sphere->vector({"center", "", "relative to the rest bounding box (0 to 1)"}, std::nullopt);
    s.radius = sphere->number({"radius", "", "relative to the longest side"}, std::nullopt, Range::positive());
  }
  if (const auto plane = table.table(key_of(Kind::plane, "vertices on one side of a plane"))) {
    pick(Kind::plane);
    s.center = plane->vector({"point", "", "relative to the rest bounding box (0 to 1)"}, std::nullopt);
    s.normal = plane->vector({"normal", "", "points to the side that is picked"}, std::nullopt);
    if (s.normal.norm() < 1e-9) plane->complain("normal", "normal: must not be zero");
  }
  s.vertices =
      table.integers(key_of(Kind::vertices, "numbers of vertices, counted from 1 in the order of the mesh"), 1);
  if (gives(table, Kind::vertices)) pick(Kind::vertices);
  if (gives(table, Kind::nearest)) {
    pick(Kind::nearest);
    s.points = table.vectors(
        key_of(Kind::nearest, "points, relative to the rest bounding box (0 to 1): the vertex nearest to each"), 0);
  }
  return given;
}

// Does the same for what a file or a shape says of its parts.
int read_named(const ConfigTable& table, Selection& s) {
  int given = 0;
  const auto pick = [&](Kind kind) {
    ++given;
    s.kind = kind;
  };
  if (gives(table, Kind::region)) {
    pick(Kind::region);
    s.region = table.text(key_of(Kind::region, "all vertices of elements with this tag"), std::nullopt);
  }
  s.group =
      table.text(key_of(Kind::group,
                        "all vertices of triangles to which the file gives this name: of a group, object, mesh, node "
                        "or material"),
                 "");
  if (gives(table, Kind::group)) pick(Kind::group);
  const auto color = table.color_if_given(
      key_of(Kind::color, "vertices that have this colour in the file, by its vertices, materials or textures"));
  if (color) s.color = *color;
  if (gives(table, Kind::color)) pick(Kind::color);
  s.tolerance = table.number({"tolerance", "", "by how much each channel of the colour may differ, in sRGB"},
                             s.tolerance, Range::between(0, 1));
  if (table.has("tolerance") && !gives(table, Kind::color))
    table.complain("tolerance", "tolerance: of a color; there is none here");
  return given;
}

// Does the same for a picture over the texture coordinates.
int read_mask(const ConfigTable& table, Selection& s) {
  s.mask = table.file(key_of(Kind::mask,
                             "a picture (PNG, JPEG, TGA, BMP): vertices whose texture coordinates in the surface's "
                             "file fall on a pixel of it that is brighter than above"));
  s.above = table.number({"above", "", "of a mask: how bright a pixel must be, from 0, black, to 1, white"}, s.above,
                         Range::between(0, 1));
  if (table.has("above") && !gives(table, Kind::mask)) table.complain("above", "above: of a mask; there is none here");
  if (!gives(table, Kind::mask)) return 0;
  s.kind = Kind::mask;
  if (s.mask.empty()) return 1;
  try {
    s.picture = std::make_shared<const Texture>(read_picture(s.mask));
  } catch (const InputError& error) {
    table.complain("mask",
                   fmt::format("mask = '{}': {}", s.mask.filename().string(), error.problems().front().message));
  }
  return 1;
}

}  // namespace

Selection read_selection(const ConfigTable& handle) {
  Selection s;
  s.place = handle.place("select");
  const auto table = handle.table({"select", "",
                                   "which vertices, by exactly one of region, box, sphere, plane, vertices, nearest, "
                                   "group, color, mask, or by border"},
                                  "required");
  if (!table) {
    if (!handle.has("select"))
      handle.complain("'select' is missing: such as select = { box = [[0, 0, 0], [1, 0.1, 1]] }");
    return s;
  }
  const int given = read_named(*table, s) + read_mask(*table, s) + read_placed(*table, s);
  s.border =
      table->boolean({"border", "", "true: only vertices on the open border of a cloth; alone: all of them"}, false);
  if (given == 0) s.kind = Kind::box;  // the whole box
  if (given + (s.border && given == 0 ? 1 : 0) != 1)
    table->complain(fmt::format("a selection is one of {}, or border", word_list(all_names<Kind>())));
  return s;
}

}  // namespace supple
