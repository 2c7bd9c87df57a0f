// Implements OFF of checked_surface.h: Geomview's manual, "OFF files", as text.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/files/number_words.h"
#include "geometry/files/text_rows.h"
#include "geometry/reader/checked_surface.h"

namespace supple {
namespace {

class OffChecker {
 public:
  OffChecker(std::string_view text, const std::string& name, const Vec3& origin)
      : rows_(text, name, {.comments = true}), origin_(origin) {
    result_.origin = origin;
  }

  CheckedSurface run() {
    if (!next_row()) rows_.refuse("the file ends where OFF should stand");
    take_kind();
    std::array<long long, 2> counts{};
    for (std::size_t k = 0; k < 2; ++k)
      counts[k] = next_count(k == 0 ? "the number of vertices" : "the number of faces");
    // The number of edges may be missing, and is often wrong.
    if (!words_.empty()) {
      (void)rows_.integer(words_[0], "the number of edges");
      if (words_.size() > 1)
        rows_.refuse(words_[1], "a fourth number, where three are allowed: vertices, faces, edges");
    }
    words_.clear();
    std::string vertices, faces;
    for (long long v = 0; v < counts[0]; ++v) take_vertex(v, counts[0], vertices);
    long long kept = 0;
    for (long long f = 0; f < counts[1]; ++f) kept += take_face(f, counts, faces) ? 1 : 0;
    if (next_row())
      rows_.refuse(words_[0],
                   fmt::format("{} vertices and {} faces announced, but more follows them", counts[0], counts[1]));
    if (kept < counts[1])
      result_.remarks.push_back(fmt::format("{} faces of fewer than three corners were left out", counts[1] - kept));
    result_.bytes = fmt::format("{}\n{} {} 0\n", kind_, counts[0], kept) + vertices + faces;
    return std::move(result_);
  }

  const Bounds& box() const { return box_; }

 private:
  bool next_row() {
    words_.clear();
    if (!rows_.next()) return false;
    words_ = rows_.words();
    return true;
  }

  // Reads [ST][C][N][4][n]OFF, which may be missing.
  void take_kind() {
    std::string_view word = words_[0].text;
    const RowWord first = words_[0];
    if (number_of<double>(word)) return;
    const auto prefix = [&](std::string_view letters) {
      if (!word.starts_with(letters)) return false;
      word.remove_prefix(letters.size());
      return true;
    };
    has_places_ = prefix("ST");
    has_colors_ = prefix("C");
    has_normals_ = prefix("N");
    weighted_ = prefix("4");
    fewest_ += (has_places_ ? 2 : 0) + (has_colors_ ? 3 : 0) + (has_normals_ ? 3 : 0) + (weighted_ ? 1 : 0);
    const bool has_dimension = prefix("n");
    if (word != "OFF") rows_.refuse(first, fmt::format("'{}' stands where OFF should", first.text.substr(0, 40)));
    words_.erase(words_.begin());
    if (!words_.empty() && words_[0].text == "BINARY")
      rows_.refuse(words_[0], "binary OFF files are not read; those of text are");
    if (has_dimension && next_count("the dimension") != 3) rows_.refuse("the dimension must be 3");
    kind_ = fmt::format("{}{}{}OFF", has_places_ ? "ST" : "", has_colors_ ? "C" : "", has_normals_ ? "N" : "");
    is_plain_ = !has_places_ && !has_colors_ && !has_normals_ && !weighted_;
  }

  long long next_count(const char* what) {
    while (words_.empty())
      if (!next_row()) rows_.refuse(fmt::format("the file ends where {} should stand", what));
    const long long count = rows_.integer(words_[0], what);
    if (count < 0) rows_.refuse(words_[0], fmt::format("{} is negative: {}", what, count));
    words_.erase(words_.begin());
    return count;
  }

  // Reads a row, from several lines where one has fewer words than it should.
  void take_words(std::size_t fewest, const std::string& missing) {
    if (!next_row()) rows_.refuse(missing);
    add_words(fewest, missing);
  }
  void add_words(std::size_t fewest, const std::string& missing) {
    while (words_.size() < fewest) {
      const std::vector<RowWord> before = words_;
      if (!next_row()) rows_.refuse(missing);
      words_.insert(words_.begin(), before.begin(), before.end());
      if (words_.size() > fewest) rows_.refuse(words_[fewest], "more numbers than are missing on the line before");
    }
  }

  void take_vertex(long long v, long long count, std::string& text) {
    take_words(fewest_, fmt::format("{} vertices announced, but the file ends after {}", count, v));
    if (words_.size() > fewest_ + 4)
      rows_.refuse(words_[fewest_ + 4], fmt::format("a vertex of {} numbers", words_.size()));
    std::array<double, 4> values = {0, 0, 0, 1};
    for (std::size_t k = 0; k < words_.size(); ++k) {
      const double value =
          k < 3 ? rows_.finite(words_[k], "a coordinate") : rows_.number(words_[k], "a number of a vertex");
      if (k < 3 || (k == 3 && weighted_)) values[k] = value;
    }
    if (values[3] == 0 || !std::isfinite(values[3])) rows_.refuse(words_[3], "a vertex of weight 0 is nowhere");
    const Vec3 p = Vec3(values[0], values[1], values[2]) / values[3];
    box_.include(p);
    const bool is_new = weighted_ || origin_ != Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      text += is_new ? fmt::format("{:.9g} ", p[Eigen::Index(k)] - origin_[Eigen::Index(k)])
                     : plain_number(words_[k].text, values[k]) + ' ';
    }
    if (!is_plain_) add_rest(text);
    text.back() = '\n';
  }

  // Adds what follows a position: a normal, a colour and a place in a texture. Of a colour, assimp wants four numbers.
  void add_rest(std::string& text) const {
    const std::size_t begin = weighted_ ? 4 : 3, end = words_.size() - (has_places_ ? 2 : 0);
    const std::size_t color = begin + (has_normals_ ? 3 : 0), parts = end - color;
    if (parts != (has_colors_ ? 3 : 0) && parts != (has_colors_ ? 4 : 0))
      rows_.refuse(words_.back(), fmt::format("a vertex of {} numbers", words_.size()));
    for (std::size_t k = begin; k < words_.size(); ++k) {
      text.append(words_[k].text).append(" ");
      if (k + 1 == end && has_colors_ && parts == 3) text += "1 ";
    }
  }

  // Returns false for a face that is left out.
  bool take_face(long long f, const std::array<long long, 2>& counts, std::string& text) {
    const std::string missing = fmt::format("{} faces announced, but the file ends after {}", counts[1], f);
    take_words(1, missing);
    const long long corners = rows_.integer(words_[0], "the number of a face's corners");
    if (corners < 0 || corners > 1'000'000) rows_.refuse(words_[0], fmt::format("a face of {} corners", corners));
    const auto last = std::size_t(corners) + 1;
    add_words(last, missing);
    for (std::size_t k = 1; k < words_.size(); ++k) {
      if (k >= last) {
        (void)rows_.number(words_[k], "a number of a face's colour");
        continue;
      }
      const long long v = rows_.integer(words_[k], "a vertex of a face");
      if (v < 0 || v >= counts[0])
        rows_.refuse(words_[k], fmt::format("a face names vertex {}, but there are {} (counted from 0)", v, counts[0]));
    }
    if (words_.size() > last + 5)
      rows_.refuse(words_[last + 5],
                   fmt::format("{} numbers after a face of {} corners", words_.size() - last, corners));
    if (corners < 3) return false;
    for (std::size_t k = 0; k < last; ++k) text.append(words_[k].text).append(k + 1 < last ? " " : "\n");
    return true;
  }

  TextRows rows_;
  const Vec3 origin_;
  CheckedSurface result_;
  Bounds box_;
  std::vector<RowWord> words_;  // the words of the row that are not taken yet
  std::string kind_ = "OFF";
  std::size_t fewest_ = 3;  // numbers of a vertex
  bool has_places_ = false, has_colors_ = false, has_normals_ = false, weighted_ = false, is_plain_ = true;
};

}  // namespace

CheckedSurface checked_off(std::string bytes, const std::string& name) {
  OffChecker checker(bytes, name, Vec3::Zero());
  CheckedSurface result = checker.run();
  const Vec3 origin = far_origin(checker.box());
  return origin == Vec3::Zero() ? result : OffChecker(bytes, name, origin).run();
}

}  // namespace supple
