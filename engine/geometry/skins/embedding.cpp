#include "geometry/skins/embedding.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "geometry/skins/outlying_skin.h"

namespace supple {
namespace {

// A point counts as inside when its least barycentric weight is above this: on a face, rounding decides the sign.
constexpr double least_inside = -1e-9;

// Lists each element in every cell of a grid that its box touches.
class ElementGrid {
 public:
  explicit ElementGrid(const TetMesh& mesh) : mesh_(mesh), to_weights_(std::size_t(mesh.tets.rows())) {
    const Bounds box = bounds_of(mesh.rest);
    lower_ = box.lower;
    cell_ = std::max(1e-12, 1.5 * std::cbrt(box.extent().prod() / std::max<double>(1, double(mesh.tets.rows()))));
    cells_ = (box.extent() / cell_).array().floor().cast<int>() + 1;
    inside_.resize(std::size_t(cells_.x()) * std::size_t(cells_.y()) * std::size_t(cells_.z()));
    for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) add(e);
  }

  struct Found {
    std::int32_t element = -1;
    Eigen::RowVector4d weights;
    double least = -1e300;  // the smallest weight
  };

  // Searches rings of cells until one holds elements, and one ring more, because the nearest element may lie across a
  // cell's border. Returns the element from which the point is least far outside.
  Found find(const Vec3& point) const {
    const Eigen::Vector3i center = cell_of(point);
    Found best;
    int rings_left = -1;
    for (int ring = 0; rings_left != 0; ++ring) {
      search_ring(center, ring, point, best);
      if (best.least >= 0) break;
      if (rings_left < 0 && best.element >= 0) rings_left = 2;
      if (rings_left > 0) --rings_left;
      if (ring > cells_.maxCoeff()) break;
    }
    return best;
  }

 private:
  Eigen::Vector3i cell_of(const Vec3& p) const {
    const Vec3 grid = (p - lower_) / cell_;
    return grid.array().floor().max(0.0).min((cells_.cast<double>().array() - 1)).cast<int>();
  }
  std::size_t slot(int i, int j, int k) const { return (std::size_t(k) * cells_.y() + j) * cells_.x() + i; }

  void add(Eigen::Index e) {
    Bounds element;
    for (int k = 0; k < 4; ++k) element.include(mesh_.rest.row(mesh_.tets(e, k)).transpose());
    const Eigen::Vector3i low = cell_of(element.lower), high = cell_of(element.upper);
    for (int k = low.z(); k <= high.z(); ++k) {
      for (int j = low.y(); j <= high.y(); ++j) {
        for (int i = low.x(); i <= high.x(); ++i) inside_[slot(i, j, k)].push_back(static_cast<std::int32_t>(e));
      }
    }
    Mat3 edges;
    for (int k = 0; k < 3; ++k)
      edges.col(k) = (mesh_.rest.row(mesh_.tets(e, k + 1)) - mesh_.rest.row(mesh_.tets(e, 0))).transpose();
    to_weights_[std::size_t(e)] = edges.inverse();
  }

  void search_ring(const Eigen::Vector3i& center, int ring, const Vec3& point, Found& best) const {
    for (int k = std::max(0, center.z() - ring); k <= std::min(cells_.z() - 1, center.z() + ring); ++k) {
      for (int j = std::max(0, center.y() - ring); j <= std::min(cells_.y() - 1, center.y() + ring); ++j) {
        for (int i = std::max(0, center.x() - ring); i <= std::min(cells_.x() - 1, center.x() + ring); ++i) {
          const int away = std::max({std::abs(i - center.x()), std::abs(j - center.y()), std::abs(k - center.z())});
          if (away == ring) search_cell(inside_[slot(i, j, k)], point, best);
        }
      }
    }
  }

  void search_cell(const std::vector<std::int32_t>& elements, const Vec3& point, Found& best) const {
    for (const std::int32_t e : elements) {
      const Vec3 w = to_weights_[std::size_t(e)] * (point - mesh_.rest.row(mesh_.tets(e, 0)).transpose());
      const double least = std::min({1 - w.sum(), w.x(), w.y(), w.z()});
      if (least <= best.least) continue;
      best.least = least;
      best.element = e;
      best.weights << 1 - w.sum(), w.x(), w.y(), w.z();
    }
  }

  const TetMesh& mesh_;
  std::vector<Mat3> to_weights_;
  Vec3 lower_;
  double cell_;
  Eigen::Vector3i cells_;
  std::vector<std::vector<std::int32_t>> inside_;
};

Located located(const Positions& points, const TetMesh& mesh) {
  const ElementGrid grid(mesh);
  Located result;
  result.corners = Tetrahedra::Zero(points.rows(), 4);
  result.weights.setZero(points.rows(), 4);
  result.inside.assign(std::size_t(points.rows()), 0);
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    const ElementGrid::Found found = grid.find(points.row(v));
    if (found.element < 0) continue;
    result.corners.row(v) = mesh.tets.row(found.element);
    result.weights.row(v) = found.weights;
    result.inside[std::size_t(v)] = found.least >= least_inside;
  }
  return result;
}

// Returns the mesh vertices that carry something, in increasing order, and numbers their frames in this order.
std::vector<std::int32_t> carrying_vertices(const std::vector<std::vector<Carrier>>& carriers, Eigen::Index vertices,
                                            std::vector<std::int32_t>& frame_of) {
  frame_of.assign(std::size_t(vertices), -1);
  for (const std::vector<Carrier>& of_point : carriers) {
    for (const Carrier& carrier : of_point) frame_of[std::size_t(carrier.vertex)] = 0;
  }
  std::vector<std::int32_t> carrying;
  for (std::size_t v = 0; v < frame_of.size(); ++v) {
    if (frame_of[v] < 0) continue;
    frame_of[v] = static_cast<std::int32_t>(carrying.size());
    carrying.push_back(static_cast<std::int32_t>(v));
  }
  return carrying;
}

// Makes the embedding of points [m] from the elements in which they lie and, for those outside, from their carriers.
Embedding embedding_of(const Positions& points, const TetMesh& mesh, Located place,
                       const std::vector<std::vector<Carrier>>& carriers) {
  Embedding result;
  std::vector<std::int32_t> frame_of;
  result.frames = vertex_frames(mesh, carrying_vertices(carriers, mesh.rest.rows(), frame_of));
  result.corners = std::move(place.corners);
  result.weights = std::move(place.weights);
  result.offset = Positions::Zero(points.rows(), 3);
  result.begin = {0};
  for (std::size_t v = 0; v < carriers.size(); ++v) {
    Vec3 mean = Vec3::Zero();
    for (const Carrier& carrier : carriers[v]) {
      result.shares.push_back({frame_of[std::size_t(carrier.vertex)], carrier.share});
      mean += carrier.share * mesh.rest.row(carrier.vertex).transpose();
    }
    const auto row = static_cast<Eigen::Index>(v);
    if (!carriers[v].empty()) result.offset.row(row) = points.row(row) - mean.transpose();
    result.begin.push_back(static_cast<std::int32_t>(result.shares.size()));
  }
  return result;
}

// Returns what carries a point: the mesh vertices of its frames, or the corners of its element. Their shares sum to 1.
std::vector<Carrier> carriers_of(const Embedding& embedding, Eigen::Index point) {
  std::vector<Carrier> result;
  for (std::int32_t i = embedding.begin[std::size_t(point)]; i < embedding.begin[std::size_t(point) + 1]; ++i) {
    const FrameShare& part = embedding.shares[std::size_t(i)];
    result.push_back({embedding.frames.vertex[std::size_t(part.frame)], part.share});
  }
  if (!result.empty()) return result;
  const double sum = embedding.weights.row(point).cwiseMax(0).sum();  // rounding may have made one of them negative
  for (int k = 0; k < 4; ++k)
    result.push_back({embedding.corners(point, k), std::max(embedding.weights(point, k), 0.0) / sum});
  return result;
}

// Returns the mean of two lists of carriers.
std::vector<Carrier> mean_of(std::vector<Carrier> all, const std::vector<Carrier>& others) {
  all.insert(all.end(), others.begin(), others.end());
  std::ranges::stable_sort(all, {}, &Carrier::vertex);
  std::vector<Carrier> mean;
  for (const Carrier& one : all) {
    if (mean.empty() || mean.back().vertex != one.vertex) mean.push_back({one.vertex, 0});
    mean.back().share += 0.5 * one.share;
  }
  return mean;
}

}  // namespace

Embedding embed(const TriMesh& skin, const TetMesh& mesh) {
  Located place = located(skin.points, mesh);
  const std::vector<std::vector<Carrier>> carriers = outside_carriers(skin, mesh, place);
  return embedding_of(skin.points, mesh, std::move(place), carriers);
}

Embedding with_middles(const Embedding& embedding, const Positions& points,
                       const std::vector<std::array<std::int32_t, 2>>& ends, const TetMesh& mesh) {
  const Eigen::Index before = embedding.points();
  Located place = located(points, mesh);
  place.corners.topRows(before) = embedding.corners;
  place.weights.topRows(before) = embedding.weights;
  std::vector<std::vector<Carrier>> all;  // by point; those of points inside as well
  std::vector<char> outside;
  for (Eigen::Index v = 0; v < before; ++v) {
    all.push_back(carriers_of(embedding, v));
    outside.push_back(embedding.outside(v) ? 1 : 0);
  }
  for (const auto& [a, b] : ends) {
    all.push_back(mean_of(all[std::size_t(a)], all[std::size_t(b)]));
    const bool both = outside[std::size_t(a)] != 0 && outside[std::size_t(b)] != 0;
    outside.push_back(both || place.inside[outside.size()] == 0 ? 1 : 0);
  }
  for (std::size_t v = 0; v < all.size(); ++v)
    if (outside[v] == 0) all[v].clear();
  return embedding_of(points, mesh, std::move(place), all);
}

Vec3 embedded_point(const Embedding& embedding, Eigen::Index point, const Positions& mesh_positions,
                    const std::vector<Mat3>& frames) {
  Vec3 sum = Vec3::Zero();
  if (!embedding.outside(point)) {
    for (int k = 0; k < 4; ++k)
      sum += embedding.weights(point, k) * mesh_positions.row(embedding.corners(point, k)).transpose();
    return sum;
  }
  Mat3 frame = Mat3::Zero();
  for (std::int32_t i = embedding.begin[std::size_t(point)]; i < embedding.begin[std::size_t(point) + 1]; ++i) {
    const FrameShare& part = embedding.shares[std::size_t(i)];
    sum += part.share * mesh_positions.row(embedding.frames.vertex[std::size_t(part.frame)]).transpose();
    frame += part.share * frames[std::size_t(part.frame)];
  }
  return sum + frame * embedding.offset.row(point).transpose();
}

double embedded_value(const Embedding& embedding, Eigen::Index point, const std::vector<double>& by_vertex) {
  double sum = 0;
  if (!embedding.outside(point)) {
    for (int k = 0; k < 4; ++k)
      sum += embedding.weights(point, k) * by_vertex[std::size_t(embedding.corners(point, k))];
    return sum;
  }
  for (std::int32_t i = embedding.begin[std::size_t(point)]; i < embedding.begin[std::size_t(point) + 1]; ++i) {
    const FrameShare& part = embedding.shares[std::size_t(i)];
    sum += part.share * by_vertex[std::size_t(embedding.frames.vertex[std::size_t(part.frame)])];
  }
  return sum;
}

Positions embedded_points(const Embedding& embedding, const Positions& mesh_positions) {
  const std::vector<Mat3> frames = frames_at(embedding.frames, mesh_positions);
  Positions result(embedding.points(), 3);
  for (Eigen::Index v = 0; v < result.rows(); ++v)
    result.row(v) = embedded_point(embedding, v, mesh_positions, frames).transpose();
  return result;
}

void scale_lengths(Embedding& embedding, double scale) {
  embedding.offset *= scale;
  embedding.frames.gradient /= scale;
}

void keep_points(Embedding& embedding, const std::vector<std::int32_t>& kept) {
  const auto count = static_cast<Eigen::Index>(kept.size());
  std::vector<std::int32_t> begin = {0};
  std::vector<FrameShare> shares;
  for (Eigen::Index to = 0; to < count; ++to) {
    const std::int32_t from = kept[std::size_t(to)];
    embedding.corners.row(to) = embedding.corners.row(from).eval();
    embedding.weights.row(to) = embedding.weights.row(from).eval();
    embedding.offset.row(to) = embedding.offset.row(from).eval();
    const auto first = embedding.shares.begin();
    shares.insert(shares.end(), first + embedding.begin[std::size_t(from)],
                  first + embedding.begin[std::size_t(from) + 1]);
    begin.push_back(static_cast<std::int32_t>(shares.size()));
  }
  embedding.corners.conservativeResize(count, 4);
  embedding.weights.conservativeResize(count, 4);
  embedding.offset.conservativeResize(count, 3);
  embedding.begin = std::move(begin);
  embedding.shares = std::move(shares);
}

OutsideShare outside_share(const Embedding& embedding) {
  OutsideShare result;
  Eigen::Index outside = 0;
  for (Eigen::Index v = 0; v < embedding.points(); ++v) {
    if (!embedding.outside(v)) continue;
    ++outside;
    const double off = embedding.offset.row(v).norm();
    if (off < result.furthest) continue;
    result.furthest = off;
    result.furthest_point = v;
  }
  if (embedding.points() > 0) result.share = double(outside) / double(embedding.points());
  return result;
}

}  // namespace supple
