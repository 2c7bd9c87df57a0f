// Implements PLY of checked_surface.h, as text and binary: Turk, "The PLY polygon file format", 1998.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/error.h"
#include "geometry/files/text_rows.h"
#include "geometry/reader/checked_surface.h"

namespace supple {
namespace {

enum class Number { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
  std::string name;
  Number type = Number::float32;
  std::optional<Number> length;  // the type of a list's length; nothing: it is no list
};

struct Element {
  std::string name;
  long long count = 0;
  std::vector<Property> properties;
};

enum class Encoding { text, little_endian, big_endian };

struct Head {
  Encoding format = Encoding::text;
  std::vector<Element> elements;
  std::string text;     // the lines that PLY knows, as they are
  std::size_t end = 0;  // where the first element begins
  long long vertices = 0, faces = 0;
  int unknown = 0;  // the number of lines of the header that PLY does not know
};

std::size_t bytes_of(Number type) {
  constexpr std::array<std::size_t, 8> bytes = {1, 1, 2, 2, 4, 4, 4, 8};
  return bytes[std::size_t(type)];
}

bool is_whole(Number type) { return type < Number::float32; }

Number type_of(const TextRows& rows, const RowWord& word) {
  struct Named {
    std::string_view name;
    Number type;
  };
  constexpr std::array<Named, 16> types = {{{"char", Number::int8},
                                            {"uchar", Number::uint8},
                                            {"short", Number::int16},
                                            {"ushort", Number::uint16},
                                            {"int", Number::int32},
                                            {"uint", Number::uint32},
                                            {"float", Number::float32},
                                            {"double", Number::float64},
                                            {"int8", Number::int8},
                                            {"uint8", Number::uint8},
                                            {"int16", Number::int16},
                                            {"uint16", Number::uint16},
                                            {"int32", Number::int32},
                                            {"uint32", Number::uint32},
                                            {"float32", Number::float32},
                                            {"float64", Number::float64}}};
  const auto* const known =
      std::find_if(types.begin(), types.end(), [&](const Named& named) { return named.name == word.text; });
  if (known == types.end())
    rows.refuse(word,
                fmt::format("'{}' is no type of PLY (char, uchar, short, ushort, int, uint, float and double are)",
                            word.text.substr(0, 40)));
  return known->type;
}

bool is_index_list(const Element& element, const Property& property) {
  return element.name == "face" && property.length &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

int axis_of(const Element& element, const Property& property) {
  if (element.name != "vertex" || property.length || property.name.size() != 1) return -1;
  const int axis = property.name[0] - 'x';
  return axis >= 0 && axis < 3 ? axis : -1;
}

// Tells whether a coordinate is announced as a whole number, so that no origin with a fraction can be taken off it.
bool has_whole_coordinates(const Head& head) {
  bool any = false;
  for (const Element& element : head.elements)
    for (const Property& property : element.properties)
      any |= axis_of(element, property) >= 0 && is_whole(property.type);
  return any;
}

void take_head_row(const TextRows& rows, Head& head) {
  const std::vector<RowWord>& words = rows.words();
  const std::string_view key = words[0].text;
  const auto want = [&](std::size_t count) {
    if (words.size() < count)
      rows.refuse(words[0], fmt::format("{} words, where {} should stand", words.size(), count));
  };
  if (key == "format") {
    want(3);
    const std::string_view format = words[1].text;
    if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian")
      rows.refuse(words[1],
                  fmt::format("format '{}' is not known (ascii, binary_little_endian and binary_big_endian are)",
                              format.substr(0, 40)));
    head.format = format == "ascii"                  ? Encoding::text
                  : format == "binary_little_endian" ? Encoding::little_endian
                                                     : Encoding::big_endian;
  } else if (key == "element") {
    want(3);
    const long long count = rows.integer(words[2], "the number of an element");
    if (count < 0) rows.refuse(words[2], fmt::format("{} of '{}' announced", count, words[1].text));
    head.elements.push_back({std::string(words[1].text), count, {}});
  } else if (key == "property") {
    const bool is_list = words.size() > 1 && words[1].text == "list";
    want(is_list ? 5 : 3);
    if (head.elements.empty()) rows.refuse(words[0], "a property before the first element");
    Property property{std::string(words.back().text), type_of(rows, words[is_list ? 3 : 1]), {}};
    if (is_list) property.length = type_of(rows, words[2]);
    if (is_list && !is_whole(*property.length)) rows.refuse(words[2], "the length of a list must be a whole number");
    head.elements.back().properties.push_back(std::move(property));
  } else if (key != "comment" && key != "obj_info" && key != "ply") {
    ++head.unknown;  // some programs leave lines of their own
    return;
  }
  head.text.append(rows.raw()).append("\n");
}

void check_head(const TextRows& rows, Head& head) {
  for (const Element& element : head.elements) {
    if (element.properties.empty() && element.count > 0)
      rows.refuse(fmt::format("'{}' has no properties", element.name.substr(0, 40)));
    const auto same = [&](const Element& other) { return other.name == element.name; };
    if (std::count_if(head.elements.begin(), head.elements.end(), same) > 1)
      rows.refuse(fmt::format("'{}' is announced twice", element.name.substr(0, 40)));
    // Of several strips, assimp reads the last one alone.
    if (element.name == "tristrips" && element.count > 0)
      rows.refuse("its triangles stand in strips (tristrips), which are not read; faces are");
    if (element.name == "face") head.faces = element.count;
    if (element.name != "vertex") continue;
    head.vertices = element.count;
    for (int axis = 0; axis < 3; ++axis) {
      const auto& own = element.properties;
      if (std::count_if(own.begin(), own.end(), [&](const Property& p) { return axis_of(element, p) == axis; }) != 1)
        rows.refuse("a vertex must have one x, one y and one z");
    }
  }
}

// Reads and checks the header, after which `rows` goes on.
Head take_head(TextRows& rows) {
  Head head;
  while (rows.next()) {
    if (rows.words()[0].text == "end_header") {
      head.text += "end_header\n";
      head.end = rows.offset();
      check_head(rows, head);
      return head;
    }
    take_head_row(rows, head);
  }
  rows.refuse("has a header without an end (end_header)");
}

void add_remarks(const Head& head, long long small_faces, CheckedSurface& result) {
  if (head.unknown > 0)
    result.remarks.push_back(fmt::format("{} lines unknown to PLY in its header were left out", head.unknown));
  if (small_faces > 0)
    result.remarks.push_back(fmt::format("{} faces of fewer than three corners were left out", small_faces));
}

class PlyTextChecker {
 public:
  PlyTextChecker(std::string_view text, const std::string& name, const Vec3& origin)
      : rows_(text, name, {}), head_(take_head(rows_)), origin_(origin) {
    result_.origin = origin;
    result_.bytes = head_.text;
    result_.bytes.reserve(text.size());
  }

  CheckedSurface run() {
    for (const Element& element : head_.elements)
      for (long long row = 0; row < element.count; ++row) take_row(element, row);
    if (rows_.next()) {
      std::string announced;
      for (const Element& element : head_.elements)
        announced += fmt::format("{}{} of '{}'", announced.empty() ? "" : " and ", element.count, element.name);
      rows_.refuse(fmt::format("{} announced, but more lines follow", announced));
    }
    add_remarks(head_, small_, result_);
    return std::move(result_);
  }

  const Bounds& box() const { return box_; }

 private:
  void take_row(const Element& element, long long row) {
    if (!rows_.next())
      rows_.refuse(fmt::format("{} of '{}' announced, but the file ends after {}", element.count, element.name, row));
    const std::vector<RowWord>& words = rows_.words();
    std::size_t at = 0;
    const auto next = [&]() -> const RowWord& {
      if (at >= words.size())
        rows_.refuse(fmt::format("'{}' {} of {} ends after {} numbers, before its last", element.name, row + 1,
                                 element.count, words.size()));
      return words[at++];
    };
    Vec3 p = Vec3::Zero();
    for (const Property& property : element.properties) {
      const int axis = axis_of(element, property);
      if (property.length) {
        take_list(element, property, next);
      } else if (axis >= 0) {
        const RowWord& word = next();
        p[axis] = rows_.finite(word, "a coordinate");
        check_whole(word, property.type, p[axis]);
        result_.bytes +=
            origin_ == Vec3::Zero() ? plain_number(word.text, p[axis]) : fmt::format("{:.9g}", p[axis] - origin_[axis]);
        result_.bytes += ' ';
      } else {
        take_number(next(), property);
      }
    }
    if (at < words.size())
      rows_.refuse(words[at], fmt::format("'{}' {} of {} has {} numbers, of which {} are announced", element.name,
                                          row + 1, element.count, words.size(), at));
    if (element.name == "vertex") box_.include(p);
    result_.bytes.back() = '\n';
  }

  void take_number(const RowWord& word, const Property& property) {
    const double value = rows_.number(word, fmt::format("a number for '{}'", property.name));
    check_whole(word, property.type, value);
    const bool is_held = std::isfinite(value) && std::abs(value) <= 3.4e38;
    result_.bytes += is_held ? plain_number(word.text, value) : "0";
    result_.bytes += ' ';
  }

  void check_whole(const RowWord& word, Number type, double value) const {
    if (is_whole(type) && value != std::floor(value))
      rows_.refuse(word, fmt::format("{} stands where a whole number is announced", word.text.substr(0, 40)));
  }

  template <class Next>
  void take_list(const Element& element, const Property& property, const Next& next) {
    const RowWord& first = next();
    const long long length = rows_.integer(first, fmt::format("the length of '{}'", property.name));
    if (length < 0) rows_.refuse(first, fmt::format("the length of '{}' is {}", property.name, length));
    const bool are_indices = is_index_list(element, property);
    small_ += are_indices && length < 3 ? 1 : 0;
    result_.bytes.append(first.text).append(" ");
    for (long long k = 0; k < length; ++k) {
      const RowWord& word = next();
      if (!are_indices) {
        take_number(word, property);
        continue;
      }
      const long long v = rows_.integer(word, "a vertex of a face");
      if (v < 0 || v >= head_.vertices)
        rows_.refuse(word, fmt::format("a face names vertex {}, but there are {} (counted from 0)", v, head_.vertices));
      result_.bytes.append(word.text).append(" ");
    }
  }

  TextRows rows_;
  const Head head_;
  const Vec3 origin_;
  CheckedSurface result_;
  Bounds box_;
  long long small_ = 0;
};

class PlyBinaryChecker {
 public:
  PlyBinaryChecker(std::string bytes, const Head& head, std::string name)
      : bytes_(std::move(bytes)), head_(head), name_(std::move(name)), at_(head.end) {}

  CheckedSurface run() {
    for (const Element& element : head_.elements) {
      for (long long row = 0; row < element.count; ++row) take_row(element, row);
    }
    const std::size_t left = bytes_.size() - at_;
    if (bytes_.find_first_not_of(std::string_view("\0 \t\r\n", 5), at_) != std::string::npos)
      throw InputError(name_, fmt::format("{} bytes follow the last of what is announced", left));
    CheckedSurface result;
    result.origin = far_origin(box_);
    if (result.origin != Vec3::Zero()) move_to(result.origin);
    add_remarks(head_, small_, result);
    result.bytes = head_.text + bytes_.substr(head_.end);
    return result;
  }

 private:
  template <class T>
  T raw(std::size_t at) const {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), bytes_.data() + at, sizeof(T));
    if (head_.format == Encoding::big_endian) std::reverse(bytes.begin(), bytes.end());
    T value;
    std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }

  double value(std::size_t at, Number type) const {
    switch (type) {
      case Number::int8: return raw<std::int8_t>(at);
      case Number::uint8: return raw<std::uint8_t>(at);
      case Number::int16: return raw<std::int16_t>(at);
      case Number::uint16: return raw<std::uint16_t>(at);
      case Number::int32: return raw<std::int32_t>(at);
      case Number::uint32: return raw<std::uint32_t>(at);
      case Number::float32: return raw<float>(at);
      case Number::float64: return raw<double>(at);
    }
    return 0;
  }

  // Returns the place of the next `count` numbers of a type, and goes on after them.
  std::size_t pass(const Element& element, long long row, std::size_t count, Number type) {
    if ((bytes_.size() - at_) / bytes_of(type) < count)
      throw InputError(name_, fmt::format("{} of '{}' announced, but the file ends in number {}", element.count,
                                          element.name, row + 1));
    const std::size_t begin = at_;
    at_ += count * bytes_of(type);
    return begin;
  }

  void take_row(const Element& element, long long row) {
    Vec3 p = Vec3::Zero();
    for (const Property& property : element.properties) {
      if (!property.length) {
        const int axis = axis_of(element, property);
        const std::size_t at = pass(element, row, 1, property.type);
        if (axis < 0) continue;
        p[axis] = value(at, property.type);
        if (property.type == Number::float64) places_.push_back({at, axis});
        continue;
      }
      const double length = value(pass(element, row, 1, *property.length), *property.length);
      if (length < 0)
        throw InputError(
            name_, fmt::format("'{}' {}: the length of '{}' is {}", element.name, row + 1, property.name, length));
      const std::size_t begin = pass(element, row, std::size_t(length), property.type);
      if (!is_index_list(element, property)) continue;
      small_ += length < 3 ? 1 : 0;
      for (std::size_t k = 0; k < std::size_t(length); ++k) {
        const double v = value(begin + k * bytes_of(property.type), property.type);
        if (!(v >= 0 && v < double(head_.vertices) && v == std::floor(v)))
          throw InputError(name_, fmt::format("face {} names vertex {}, but there are {} (counted from 0)", row + 1, v,
                                              head_.vertices));
      }
    }
    if (element.name != "vertex") return;
    if (!p.allFinite()) throw InputError(name_, fmt::format("vertex {} is not finite", row + 1));
    if (p.cwiseAbs().maxCoeff() > 3.4e38) throw InputError(name_, fmt::format("vertex {} is beyond 3.4e38", row + 1));
    box_.include(p);
  }

  // Takes the origin off all positions where they are doubles. Otherwise sets it to zero: floats have lost their digits
  // before.
  void move_to(Vec3& origin) {
    if (std::ssize(places_) != 3 * head_.vertices) {
      origin = Vec3::Zero();
      return;
    }
    for (const auto& [at, axis] : places_) {
      const double moved = raw<double>(at) - origin[axis];
      std::array<char, sizeof moved> bytes;
      std::memcpy(bytes.data(), &moved, sizeof moved);
      if (head_.format == Encoding::big_endian) std::reverse(bytes.begin(), bytes.end());
      std::copy(bytes.begin(), bytes.end(), bytes_.begin() + std::ptrdiff_t(at));
    }
  }

  struct Place {
    std::size_t at;
    int axis;
  };

  std::string bytes_;
  const Head& head_;
  const std::string name_;
  std::size_t at_;
  std::vector<Place> places_;  // the places of coordinates that are doubles
  Bounds box_;
  long long small_ = 0;
};

}  // namespace

CheckedSurface checked_ply(std::string bytes, const std::string& name) {
  TextRows rows(bytes, name, {});
  const Head head = take_head(rows);
  if (head.vertices == 0 || head.faces == 0)
    rows.refuse(fmt::format("the file has {} of 'vertex' and {} of 'face'", head.vertices, head.faces));
  if (head.format != Encoding::text) return PlyBinaryChecker(std::move(bytes), head, name).run();
  PlyTextChecker checker(bytes, name, Vec3::Zero());
  CheckedSurface result = checker.run();
  const Vec3 origin = has_whole_coordinates(head) ? Vec3(Vec3::Zero()) : far_origin(checker.box());
  return origin == Vec3::Zero() ? result : PlyTextChecker(bytes, name, origin).run();
}

}  // namespace supple
