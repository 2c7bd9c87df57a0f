// Implements OBJ of checked_surface.h: Wavefront, "Object files (.obj)", appendix B1 of the Advanced Visualizer manual.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>

#include "geometry/files/number_words.h"
#include "geometry/files/text_rows.h"
#include "geometry/reader/checked_surface.h"

namespace supple {
namespace {

// One of the three lists that corners of faces name: positions, texture coordinates and normals.
struct Listed {
  const char* what;
  long long count = 0;
  long long largest = 0;  // the largest number that a face names, and where
  int line = 0, column = 0;
};

class ObjChecker {
 public:
  ObjChecker(std::string_view text, const std::string& name, const Vec3& origin)
      : rows_(text, name, {.comments = true, .continued = true}), origin_(origin) {
    result_.origin = origin;
    result_.bytes.reserve(text.size());
  }

  CheckedSurface run() {
    while (rows_.next()) take_row();
    for (const Listed& list : lists_) {
      // Faces may name normals and texture coordinates in a file that has none of them.
      if (list.largest > list.count && (list.count > 0 || &list == lists_.data()))
        rows_.refuse(list.line, list.column,
                     fmt::format("a face names {} {}, but the file has {}", list.what, list.largest, list.count));
    }
    if (faces_ == 0) rows_.refuse(fmt::format("the file has {} vertices, and no faces", lists_[0].count));
    if (small_ > 0)
      result_.remarks.push_back(fmt::format("{} faces of fewer than three corners were left out", small_));
    if (unknown_ > 0) {
      result_.remarks.push_back(fmt::format("{} line{} unknown to OBJ {} left out, the first is line {}", unknown_,
                                            unknown_ == 1 ? "" : "s", unknown_ == 1 ? "was" : "were", unknown_line_));
    }
    if (lines_ > 0) {
      result_.remarks.push_back(fmt::format("{} of its lines and points (l, p) {} left out: only faces have a surface",
                                            lines_, lines_ == 1 ? "was" : "were"));
    }
    if (free_form_) result_.remarks.emplace_back("its free-form curves and surfaces are not read");
    return std::move(result_);
  }

  const Bounds& box() const { return box_; }

 private:
  void take_row() {
    const std::string_view key = rows_.words()[0].text;
    if (key == "v") {
      take_vertex();
    } else if (key == "vt" || key == "vn") {
      take_further(key == "vt" ? 1 : 2);
    } else if (key == "f" || key == "fo") {
      take_face();
    } else if ((key == "o" || key == "g") && rows_.words().size() > 1) {
      take_name(key == "o");
    } else if (key == "mtllib" || key == "usemtl" || key == "g" || key == "o" || key == "s") {
      result_.bytes.append(rows_.raw()).append("\n");  // names may have any characters
    } else if (key == "V" || key == "F" || number_of<double>(key) || key.find(',') != std::string_view::npos) {
      rows_.refuse(rows_.words()[0], fmt::format("'{}' begins no line of OBJ (v, vt, vn and f do)", key.substr(0, 40)));
    } else {
      pass_over(key);
    }
  }

  // Writes the name of an object or a group. Of an object's name assimp reads only the first word, so its spaces are
  // replaced; and assimp forgets the object where a group follows, so the line of the group has both names. Where an
  // object's name comes again, assimp would give the faces after it to the object before that line, so the name gets
  // characters that tell it from the earlier ones.
  void take_name(bool is_object) {
    std::string name;
    for (std::size_t k = 1; k < rows_.words().size(); ++k) {
      if (k > 1) name += is_object ? space_in_name : ' ';
      name += rows_.words()[k].text;
    }
    if (is_object) {
      name.append(std::size_t(objects_[name]++), end_of_name);
      object_ = name;
    }
    const bool has_both = !is_object && !object_.empty();
    result_.bytes += is_object ? "o " : "g ";
    if (has_both) result_.bytes.append(object_).push_back(end_of_name);
    result_.bytes += name + '\n';
  }

  // Leaves out a line that decides neither shape nor colour, and notes what remarks should say of it.
  void pass_over(std::string_view key) {
    constexpr std::array surfaces = {"curv", "curv2", "surf", "bzp", "bsp", "cdc", "cdp", "res"};
    if (key == "l" || key == "p") ++lines_;
    constexpr std::array known = {"vp",    "p",     "l",      "cstype", "deg",      "bmat",      "step",
                                  "parm",  "trim",  "hole",   "scrv",   "sp",       "end",       "con",
                                  "mg",    "bevel", "usemap", "lod",    "c_interp", "d_interp",  "ctech",
                                  "stech", "call",  "csh",    "maplib", "merge",    "trace_obj", "shadow_obj"};
    free_form_ |= std::find(surfaces.begin(), surfaces.end(), key) != surfaces.end();
    if (free_form_ || std::find(known.begin(), known.end(), key) != known.end()) return;
    if (unknown_++ == 0) unknown_line_ = rows_.line();
  }

  void take_vertex() {
    const std::vector<RowWord>& words = rows_.words();
    const std::size_t count = words.size() - 1;
    if (count != 3 && count != 4 && count != 6 && count != 7) {
      rows_.refuse(words[0], fmt::format("a vertex of {} numbers: 3 are allowed, 4 with a weight, and 6 or 7 with a "
                                         "colour",
                                         count));
    }
    std::array<double, 7> values{};
    for (std::size_t k = 0; k < count; ++k) values[k] = rows_.finite(words[k + 1], "a coordinate");
    Vec3 p(values[0], values[1], values[2]);
    if (count == 4 && values[3] == 0) rows_.refuse(words[4], "a vertex of weight 0 is nowhere");
    if (count == 4) p /= values[3];
    box_.include(p);
    ++lists_[0].count;
    std::string& text = result_.bytes;
    text += 'v';
    const bool is_moved = origin_ != Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      text += ' ';
      text += is_moved ? fmt::format("{:.9g}", p[Eigen::Index(k)] - origin_[Eigen::Index(k)])
                       : plain_number(words[k + 1].text, values[k]);
    }
    if (count == 4 && !is_moved) text += ' ' + plain_number(words[4].text, values[3]);
    for (std::size_t k = 3; k < 6 && count >= 6; ++k) text += ' ' + plain_number(words[k + 1].text, values[k]);
    text += '\n';
  }

  // Takes a place in a texture (list: 1) or a normal (2).
  void take_further(std::size_t list) {
    const std::vector<RowWord>& words = rows_.words();
    const std::size_t count = words.size() - 1;
    if (count > 3 || count < (list == 1 ? 1 : 3))
      rows_.refuse(words[0],
                   fmt::format("{} of {} numbers: {} allowed", list == 1 ? "a place in a texture" : "a normal", count,
                               list == 1 ? "1 to 3 are" : "3 are"));
    ++lists_[list].count;
    std::string& text = result_.bytes;
    text += words[0].text;
    for (std::size_t k = 1; k <= count; ++k) {
      double value = rows_.number(words[k], list == 1 ? "a coordinate of a texture" : "a coordinate of a normal");
      const bool is_odd = !std::isfinite(value) || std::abs(value) > 3.4e38;  // not refused: it decides no shape
      text += ' ' + (is_odd ? std::string("0") : plain_number(words[k].text, value));
    }
    text += count == 1 ? " 0\n" : "\n";
  }

  void take_face() {
    const std::vector<RowWord>& words = rows_.words();
    for (std::size_t k = 1; k < words.size(); ++k) check_corner(words[k]);
    if (words.size() < 4) {
      ++small_;
      return;
    }
    ++faces_;
    result_.bytes += 'f';
    for (std::size_t k = 1; k < words.size(); ++k) result_.bytes.append(" ").append(words[k].text);
    result_.bytes += '\n';
  }

  // Checks a corner: v, v/vt, v//vn or v/vt/vn.
  void check_corner(const RowWord& word) {
    std::size_t begin = 0;
    for (std::size_t list = 0; list < 3; ++list) {
      const std::size_t end = std::min(word.text.find('/', begin), word.text.size());
      const RowWord part{word.text.substr(begin, end - begin), word.column + int(begin)};
      if (!part.text.empty() || list != 1 || end == word.text.size()) check_index(part, word, lists_[list]);
      if (end == word.text.size()) return;
      begin = end + 1;
    }
    rows_.refuse(word,
                 fmt::format("'{}' is not a corner of a face (as 1, 1/1, 1//1 or 1/1/1)", word.text.substr(0, 40)));
  }

  void check_index(const RowWord& part, const RowWord& word, Listed& list) {
    const auto index = number_of<long long>(part.text);
    if (!index || part.text[0] == '+')
      rows_.refuse(word,
                   fmt::format("'{}' is not a corner of a face (as 1, 1/1, 1//1 or 1/1/1)", word.text.substr(0, 40)));
    if (*index == 0) rows_.refuse(part, fmt::format("a face names {} 0: they count from 1", list.what));
    if (*index < 0 && -*index > list.count)
      rows_.refuse(part, fmt::format("a face names {} {}, but {} stand before it", list.what, *index, list.count));
    if (*index <= list.largest) return;
    list.largest = *index;
    list.line = rows_.line();
    list.column = part.column;
  }

  TextRows rows_;
  const Vec3 origin_;
  CheckedSurface result_;
  Bounds box_;
  std::string object_;                  // the object's name as assimp reads it; empty: no line has named one
  std::map<std::string, int> objects_;  // how often each has been named
  std::array<Listed, 3> lists_ = {Listed{"vertex"}, Listed{"texture coordinate"}, Listed{"normal"}};
  long long faces_ = 0, small_ = 0, unknown_ = 0, lines_ = 0;
  int unknown_line_ = 0;
  bool free_form_ = false;
};

}  // namespace

CheckedSurface checked_obj(std::string bytes, const std::string& name) {
  ObjChecker checker(bytes, name, Vec3::Zero());
  CheckedSurface result = checker.run();
  const Vec3 origin = far_origin(checker.box());
  return origin == Vec3::Zero() ? result : ObjChecker(bytes, name, origin).run();
}

}  // namespace supple
