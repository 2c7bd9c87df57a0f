// Writes a sheet of two textured halves as an OBJ file, and makes bodies of it, for tests of what a surface's file
// says.
#pragma once

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "base/error.h"
#include "output/files/png_file.h"
#include "scene/building/assemble.h"
#include "scene/building/drawn_body.h"
#include "scene/reading/scene_reader.h"
#include "support/bodies.h"
#include "support/colored_files.h"
#include "support/text_file.h"

namespace supple::test {

inline constexpr int cells = 8;  // of the sheet, along each side

// Says how a sheet of 1 m by 1 m is written. Its two halves meet at x = 0.5.
struct SheetFile {
  double gap = 0;                                                               // between the halves [m]
  std::array<double, 2> left = {0, 0.25}, right = {1, -0.25};                   // u = first + second x, on each half
  std::string left_name = "g left", right_name = "o right side\nusemtl print";  // lines before their faces
  bool places = true, right_places = true;
};

// Returns an OBJ file of a sheet in the plane z = 0, whose v is y / 4.
inline std::string sheet_text(const SheetFile& sheet) {
  std::string text = "mtllib sheet.mtl\n", faces[2];
  int vertices = 0;
  for (int half = 0; half < 2; ++half) {
    const auto& [first, slope] = half == 0 ? sheet.left : sheet.right;
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i <= cells / 2; ++i) {
        const double x = 0.5 * half + double(i) / cells, y = double(j) / cells;
        text += fmt::format("v {} {} 0\nvt {} {}\n", x + half * sheet.gap, y, first + slope * x, y / 4);
      }
    }
    const bool placed = sheet.places && (half == 0 || sheet.right_places);
    const auto corner = [&](int i, int j) {
      const int number = vertices + j * (cells / 2 + 1) + i + 1;
      return placed ? fmt::format(" {0}/{0}", number) : fmt::format(" {}", number);
    };
    for (int j = 0; j < cells; ++j) {
      for (int i = 0; i < cells / 2; ++i) {
        faces[half] += "f" + corner(i, j) + corner(i + 1, j) + corner(i + 1, j + 1) + "\n";
        faces[half] += "f" + corner(i, j) + corner(i + 1, j + 1) + corner(i, j + 1) + "\n";
      }
    }
    vertices += (cells + 1) * (cells / 2 + 1);
  }
  return text + sheet.left_name + "\nusemtl print\n" + faces[0] + sheet.right_name + "\n" + faces[1];
}

// Writes the sheet and its texture, and scenes with a cloth of it, into a folder.
class SheetFromFile : public ::testing::Test {
 protected:
  SheetFromFile() {
    write_text(folder_.path / "sheet.mtl", "newmtl print\nKd 1 1 1\nmap_Kd print.png\n");
    write_png(folder_.path / "print.png", 32, 32, squares_picture(32, 4));
    write({});
  }
  void write(const SheetFile& sheet) const { write_text(folder_.path / "sheet.obj", sheet_text(sheet)); }

  SceneDef scene_with(const std::string& cloth, const std::string& keys = "") const {
    write_text(folder_.path / "s.toml", fmt::format("[[body]]\nname = \"sheet\"\nmaterial = \"cotton\"\n"
                                                    "cloth = {{ {} }}\n{}",
                                                    cloth, keys));
    return load_scene(folder_.path / "s.toml", assets, {});
  }
  Body body_of(const std::string& cloth, const std::string& keys = "") const {
    return assemble(scene_with(cloth, keys)).front();
  }
  DrawnBody drawn_of(const std::string& cloth, const std::string& keys = "") const {
    return drawn_bodies({body_of(cloth, keys)}).front();
  }
  std::string refusal_of(const std::string& cloth, const std::string& keys = "") const {
    try {
      body_of(cloth, keys);
      return "nothing";
    } catch (const InputError& error) {
      EXPECT_GT(error.problems().front().place.line, 0);
      return error.problems().front().message;
    }
  }
  std::vector<Vec3> held(const std::string& select, const std::string& cloth = "surface = \"sheet.obj\"") const {
    const Body body = body_of(cloth, "[[body.handles]]\nname = \"pins\"\nselect = { " + select + " }\n");
    std::vector<Vec3> places;
    for (const std::int32_t v : body.description.handles.front().vertices)
      places.push_back(body.unplaced.row(v).transpose());
    return places;
  }
  std::string refusal_to_hold(const std::string& select) const {
    return refusal_of("surface = \"sheet.obj\"", "[[body.handles]]\nname = \"pins\"\nselect = { " + select + " }\n");
  }
  TemporaryFolder folder_;
};

inline bool has(const std::vector<std::string>& notes, const std::string& part) {
  return std::ranges::any_of(notes, [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

inline void expect_part(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "found: " << text;
}

}  // namespace supple::test
