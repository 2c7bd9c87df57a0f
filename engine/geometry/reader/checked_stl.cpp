// Implements STL of checked_surface.h, as text and binary: 3D Systems, "StereoLithography interface specification".
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <map>

#include "base/error.h"
#include "geometry/files/text_rows.h"
#include "geometry/reader/checked_surface.h"

#include "base/text.h"

namespace supple {
namespace {

constexpr std::size_t head_bytes = 84, facet_bytes = 50;

class StlTextChecker {
 public:
  StlTextChecker(std::string_view text, const std::string& name, const Vec3& origin)
      : rows_(text, name, {}), origin_(origin) {
    result_.origin = origin;
    result_.bytes = "solid surface\n";
  }

  CheckedSurface run() {
    bool is_open = false;
    while (next_word()) {
      const std::string key = lowercase(word_.text);
      if (key == "solid" || key == "endsolid") {
        is_open = key == "solid";
        at_ = rows_.words().size();  // a name may be anything
      } else if (key == "facet") {
        take_facet();
      } else {
        refuse_word("facet, solid or endsolid");
      }
    }
    if (facets_ == 0) rows_.refuse("the file has no facets");
    if (is_open) result_.remarks.emplace_back("the file ends without endsolid: a part of it may be missing");
    result_.bytes += "endsolid surface\n";
    return std::move(result_);
  }

  const Bounds& box() const { return box_; }

 private:
  bool next_word() {
    if (at_ >= rows_.words().size()) {
      at_ = 0;
      if (!rows_.next()) return false;
    }
    word_ = rows_.words()[at_++];
    return true;
  }

  [[noreturn]] void refuse_word(std::string_view wanted) const {
    rows_.refuse(word_, fmt::format("'{}' stands where {} should", word_.text.substr(0, 40), wanted));
  }

  void advance(std::string_view wanted) {
    if (!next_word())
      rows_.refuse(fmt::format("the file ends within facet {}: {} should stand here", facets_ + 1, wanted));
  }
  void expect(std::string_view wanted) {
    advance(wanted);
    if (lowercase(word_.text) != wanted) refuse_word(wanted);
  }

  void take_facet() {
    expect("normal");
    for (int k = 0; k < 3; ++k) {
      advance("a coordinate of a normal");
      (void)rows_.number(word_, "a coordinate of a normal");
    }
    expect("outer");
    expect("loop");
    std::string& text = result_.bytes;
    text += "facet normal 0 0 0\nouter loop\n";  // normals follow from the corners
    for (int corner = 0; corner < 3; ++corner) {
      expect("vertex");
      text += "vertex";
      Vec3 p;
      for (Eigen::Index k = 0; k < 3; ++k) {
        advance("a coordinate");
        p[k] = rows_.finite(word_, "a coordinate");
        text += ' ';
        text += origin_ == Vec3::Zero() ? plain_number(word_.text, p[k]) : fmt::format("{:.9g}", p[k] - origin_[k]);
      }
      box_.include(p);
      text += '\n';
    }
    expect("endloop");
    expect("endfacet");
    text += "endloop\nendfacet\n";
    ++facets_;
  }

  TextRows rows_;
  const Vec3 origin_;
  CheckedSurface result_;
  Bounds box_;
  RowWord word_;
  std::size_t at_ = 0;  // of the next word in its row
  long long facets_ = 0;
};

// Tells whether facets are closed: each edge of one is an edge of another one the other way round. facets: their bytes.
bool is_closed(std::string_view facets) {
  using Place = std::array<float, 3>;
  std::map<std::pair<Place, Place>, int> sides;
  for (std::size_t at = 0; at + facet_bytes <= facets.size(); at += facet_bytes) {
    std::array<Place, 3> corners;
    std::memcpy(corners.data(), facets.data() + at + 12, sizeof corners);
    for (Place& corner : corners)
      for (float& x : corner) x += 0.0f;  // -0 is 0
    for (std::size_t k = 0; k < 3; ++k) {
      const Place &a = corners[k], &b = corners[(k + 1) % 3];
      if (a < b) ++sides[{a, b}];
      if (b < a) --sides[{b, a}];
    }
  }
  return !sides.empty() && std::all_of(sides.begin(), sides.end(), [](const auto& side) { return side.second == 0; });
}

CheckedSurface checked_binary(std::string bytes, const std::string& name) {
  if (bytes.size() < head_bytes)
    throw InputError(name, fmt::format("neither STL as text, which begins with solid, nor binary STL: of {} bytes, and "
                                       "the head alone takes {}",
                                       bytes.size(), head_bytes));
  std::uint32_t announced = 0;
  std::memcpy(&announced, bytes.data() + 80, sizeof announced);
  const std::size_t room = (bytes.size() - head_bytes) / facet_bytes;
  CheckedSurface result;
  if (announced == 0 && room == 0) throw InputError(name, "the file has no facets");
  if (announced > room || announced == 0) {
    const std::string wrong = fmt::format("{} facets announced, but the file has {}", announced, room);
    if (!is_closed(std::string_view(bytes).substr(head_bytes))) throw InputError(name, wrong);
    result.remarks.push_back(wrong + "; those are closed, and are read");
    announced = std::uint32_t(room);
    std::memcpy(bytes.data() + 80, &announced, sizeof announced);
  }
  const std::size_t end = head_bytes + announced * facet_bytes;
  if (bytes.size() > end) {
    const std::size_t further = bytes.size() - end;
    if (further >= facet_bytes && !is_closed(std::string_view(bytes).substr(head_bytes, end - head_bytes)))
      throw InputError(name, fmt::format("{} facets announced, but the file has {}", announced, room));
    result.remarks.push_back(fmt::format("{} bytes after the last of {} facets are not read", further, announced));
    bytes.resize(end);
  }
  result.bytes = std::move(bytes);
  return result;
}

bool is_text(std::string_view bytes) {
  const std::size_t begin = bytes.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos || lowercase(bytes.substr(begin, 5)) != "solid") return false;
  std::uint32_t facets = 0;
  if (bytes.size() >= head_bytes) std::memcpy(&facets, bytes.data() + 80, sizeof facets);
  if (bytes.size() >= head_bytes && bytes.size() == head_bytes + facets * facet_bytes) return false;
  return bytes.substr(0, 1024).find('\0') == std::string_view::npos;  // the head of binary files may say solid, too
}

}  // namespace

CheckedSurface checked_stl(std::string bytes, const std::string& name) {
  if (!is_text(bytes)) return checked_binary(std::move(bytes), name);
  StlTextChecker checker(bytes, name, Vec3::Zero());
  CheckedSurface result = checker.run();
  const Vec3 origin = far_origin(checker.box());
  return origin == Vec3::Zero() ? result : StlTextChecker(bytes, name, origin).run();
}

}  // namespace supple
