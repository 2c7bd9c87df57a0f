#include "geometry/tetrahedra/element_paths.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <span>
#include <utility>

namespace supple {
namespace {

// Groups numbers by keys from 0 on: those of key k are list[begin[k] .. begin[k + 1]), in the order in which they came.
struct ByKey {
  std::vector<std::int32_t> begin, list;

  // key_of: returns the key of a number from 0 to count - 1.
  template <class KeyOf>
  ByKey(std::size_t keys, std::int32_t count, const KeyOf& key_of) : begin(keys + 1, 0), list(std::size_t(count)) {
    for (std::int32_t i = 0; i < count; ++i) ++begin[std::size_t(key_of(i)) + 1];
    for (std::size_t k = 0; k < keys; ++k) begin[k + 1] += begin[k];
    std::vector<std::int32_t> next(begin.begin(), begin.end() - 1);
    for (std::int32_t i = 0; i < count; ++i) list[std::size_t(next[std::size_t(key_of(i))]++)] = i;
  }
};

using Face = std::array<std::int32_t, 3>;

Face sorted(std::int32_t a, std::int32_t b, std::int32_t c) {
  Face face = {a, b, c};
  std::sort(face.begin(), face.end());
  return face;
}

// Returns the corners of a face, sorted. face: four times the element, plus the corner opposite.
Face face_of(const Tetrahedra& tets, std::int32_t face) {
  const Eigen::Index e = face / 4;
  const int k = face % 4;
  return sorted(tets(e, (k + 1) % 4), tets(e, (k + 2) % 4), tets(e, (k + 3) % 4));
}

// Returns six times the volume of a tetrahedron, positive where det[b - a, c - a, d - a] is.
double volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return (b - a).cross(c - a).dot(d - a); }

// Returns the barycentric coordinates of a point; nothing where the element is inverted or has no volume.
std::optional<Eigen::Vector4d> coordinates(const std::array<Vec3, 4>& corners, const Vec3& p) {
  const double whole = volume(corners[0], corners[1], corners[2], corners[3]);
  if (!(whole > 0)) return std::nullopt;
  Eigen::Vector4d shares;
  for (int k = 0; k < 4; ++k) {
    std::array<Vec3, 4> moved = corners;
    moved[std::size_t(k)] = p;
    shares[k] = volume(moved[0], moved[1], moved[2], moved[3]) / whole;
  }
  return shares;
}

}  // namespace

ElementPaths::ElementPaths(Tetrahedra tets, Triangles triangles, const Positions& rest)
    : tets_(std::move(tets)), triangles_(std::move(triangles)) {
  for (std::int32_t e = 0; e < tets_.rows(); ++e) rest_volume_.push_back(volume_of(rest, e));
  list_around(rest.rows());
}

void ElementPaths::join_elements() const {
  beyond_.assign(std::size_t(tets_.rows()), {-1, -1, -1, -1});
  std::vector<Face> faces;
  for (std::int32_t face = 0; face < 4 * tets_.rows(); ++face) faces.push_back(face_of(tets_, face));
  const ByKey by_lowest(begin_.size() - 1, std::int32_t(faces.size()),
                        [&](std::int32_t face) { return faces[std::size_t(face)][0]; });
  const auto faces_at = [&](std::int32_t lowest) {
    const auto first = std::size_t(by_lowest.begin[std::size_t(lowest)]);
    return std::span(by_lowest.list).subspan(first, std::size_t(by_lowest.begin[std::size_t(lowest) + 1]) - first);
  };
  for (std::int32_t v = 0; v + 1 < std::ssize(begin_); ++v) {
    const auto own = faces_at(v);
    for (std::size_t i = 0; i < own.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const std::int32_t one = own[i], other = own[j];
        if (faces[std::size_t(one)] != faces[std::size_t(other)]) continue;
        beyond_[std::size_t(one / 4)][std::size_t(one % 4)] = other / 4;
        beyond_[std::size_t(other / 4)][std::size_t(other % 4)] = one / 4;
      }
    }
  }
  for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
    const Face face = sorted(triangles_(t, 0), triangles_(t, 1), triangles_(t, 2));
    const auto own = faces_at(face[0]);
    const auto at = std::ranges::find_if(own, [&](std::int32_t one) { return faces[std::size_t(one)] == face; });
    face_.push_back(at == own.end() ? std::array<std::int32_t, 2>{-1, -1}
                                    : std::array<std::int32_t, 2>{*at / 4, *at % 4});
  }
}

void ElementPaths::list_around(Eigen::Index vertices) {
  ByKey corners(std::size_t(vertices), std::int32_t(tets_.size()), [&](std::int32_t i) { return tets_(i / 4, i % 4); });
  elements_begin_ = std::move(corners.begin);
  elements_ = std::move(corners.list);
  for (std::int32_t& element : elements_) element /= 4;
  begin_.push_back(0);
  std::vector<std::int32_t> around;
  for (std::size_t v = 0; v < std::size_t(vertices); ++v) {
    around.clear();
    for (auto i = elements_begin_[v]; i < elements_begin_[v + 1]; ++i)
      for (int k = 0; k < 4; ++k) around.push_back(tets_(elements_[std::size_t(i)], k));
    std::sort(around.begin(), around.end());
    neighbours_.insert(neighbours_.end(), around.begin(), std::unique(around.begin(), around.end()));
    begin_.push_back(static_cast<std::int32_t>(neighbours_.size()));
  }
}

// Follows the line from element to element. In an element, the barycentric shares of the line's end are below zero for
// the corners opposite to the faces through which the line may leave; it leaves through that face whose share is zero
// first on the way.
std::optional<std::int32_t> ElementPaths::element_at_end(const Positions& x, std::int32_t triangle, const Vec3& from,
                                                         const Vec3& to) const {
  constexpr int most_elements = 1000;    // of a line; round-off could make it run in circles
  constexpr double on_the_face = 1e-10;  // of a share: counts as inside
  if (beyond_.empty()) join_elements();
  auto [element, entered] = face_[std::size_t(triangle)];
  for (int i = 0; element >= 0 && i < most_elements; ++i) {
    std::array<Vec3, 4> corners;
    for (int k = 0; k < 4; ++k) corners[std::size_t(k)] = x.row(tets_(element, k));
    const auto end = coordinates(corners, to), start = coordinates(corners, from);
    if (!end) return std::nullopt;
    if (end->minCoeff() >= -on_the_face) return element;
    int left = -1;
    double first = infinity;
    for (int k = 0; k < 4; ++k) {
      if (k == entered || !((*end)[k] < -on_the_face)) continue;
      const double share = (*start)[k] / ((*start)[k] - (*end)[k]);
      if (share >= first) continue;
      first = share;
      left = k;
    }
    if (left < 0) return std::nullopt;
    const std::int32_t next = beyond_[std::size_t(element)][std::size_t(left)];
    if (next < 0) return std::nullopt;
    const auto& back = beyond_[std::size_t(next)];
    entered = static_cast<std::int32_t>(std::find(back.begin(), back.end(), element) - back.begin());
    element = next;
  }
  return std::nullopt;
}

std::span<const std::int32_t> ElementPaths::neighbours(std::int32_t vertex) const {
  const std::int32_t first = begin_[std::size_t(vertex)], last = begin_[std::size_t(vertex) + 1];
  return {neighbours_.data() + first, std::size_t(last - first)};
}

bool ElementPaths::are_neighbours(std::int32_t a, std::int32_t b) const {
  return a == b || std::ranges::binary_search(neighbours(a), b);
}

// Returns six times the volume.
double ElementPaths::volume_of(const Positions& x, std::int32_t element) const {
  const auto tet = tets_.row(element);
  return volume(x.row(tet[0]), x.row(tet[1]), x.row(tet[2]), x.row(tet[3]));
}

bool ElementPaths::is_collapsed_at(const Positions& x, std::int32_t vertex) const {
  constexpr double least = 0.1;
  const auto first = elements_.begin() + elements_begin_[std::size_t(vertex)],
             last = elements_.begin() + elements_begin_[std::size_t(vertex) + 1];
  return std::any_of(first, last, [&](std::int32_t element) {
    return volume_of(x, element) < least * rest_volume_[std::size_t(element)];
  });
}

double ElementPaths::inverted_share(const Positions& x) const {
  Eigen::Index count = 0;
  for (std::int32_t e = 0; e < tets_.rows(); ++e) count += !(volume_of(x, e) > 0);
  return double(count) / double(tets_.rows());
}

bool ElementPaths::has_neighbour(std::int32_t element, std::int32_t vertex) const {
  for (int k = 0; k < 4; ++k)
    if (are_neighbours(vertex, tets_(element, k))) return true;
  return false;
}

}  // namespace supple
