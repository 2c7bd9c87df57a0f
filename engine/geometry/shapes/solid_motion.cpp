#include "geometry/shapes/solid_motion.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/error.h"
#include "geometry/files/surface_file.h"
#include "geometry/solids/triangle_solid.h"

namespace supple {
namespace {

// Finds points near a place, in cells as wide as the longest distance that is asked for.
class NearPoints {
 public:
  NearPoints(const Positions& points, const std::vector<char>& counts, double cell) : points_(points), cell_(cell) {
    for (Eigen::Index v = 0; v < points.rows(); ++v)
      if (counts.empty() || counts[std::size_t(v)])
        cells_[key(cell_of(points.row(v).transpose()))].push_back(std::int32_t(v));
  }

  // Returns the nearest point within a cell's width, of equally near ones the first; -1: there is none.
  std::int32_t nearest(const Vec3& p) const {
    const Cell middle = cell_of(p);
    std::int32_t best = -1;
    double least = cell_ * cell_;
    for (int i = 0; i < 27; ++i) {
      const auto found = cells_.find(key(middle + Cell(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
      if (found == cells_.end()) continue;
      for (const std::int32_t v : found->second) {
        const double squared = (points_.row(v).transpose() - p).squaredNorm();
        if (squared > least || (squared == least && best >= 0 && v > best)) continue;
        least = squared;
        best = v;
      }
    }
    return best;
  }

 private:
  using Cell = Eigen::Matrix<std::int64_t, 3, 1>;
  Cell cell_of(const Vec3& p) const { return (p / cell_).array().floor().cast<std::int64_t>(); }
  static std::uint64_t key(const Cell& cell) {
    return std::uint64_t(cell.x()) * 0x9e3779b97f4a7c15u ^ std::uint64_t(cell.y()) * 0xc2b2ae3d27d4eb4fu ^
           std::uint64_t(cell.z()) * 0x165667b19e3779f9u;
  }

  const Positions& points_;
  double cell_;
  std::unordered_map<std::uint64_t, std::vector<std::int32_t>> cells_;
};

// Returns, for each vertex, the vertices with which it shares an edge.
std::vector<std::vector<std::int32_t>> beside_each(const TriMesh& mesh) {
  std::vector<std::vector<std::int32_t>> next(std::size_t(mesh.points.rows()));
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k)
      for (const int j : {1, 2}) next[std::size_t(mesh.triangles(t, k))].push_back(mesh.triangles(t, (k + j) % 3));
  for (auto& list : next) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return next;
}

void check_motion(const VertexMotion& motion, const std::filesystem::path& file, Eigen::Index vertices,
                  const std::string& name) {
  const Eigen::Index moved = motion.frames.front().rows();
  if (moved != vertices)
    throw InputError(name,
                     fmt::format("moves {} vertices, and the surface '{}' has {}", moved, file.string(), vertices));
}

}  // namespace

SolidMotion::SolidMotion(const ClosedSurface& surface, const std::filesystem::path& file, const SurfaceOptions& options,
                         const VertexMotion& motion, const std::string& name)
    : rest_(surface.solid) {
  if (file.extension() != ".obj")
    throw InputError(name, fmt::format("the surface '{}' is no .obj file: only those keep the order of their vertices",
                                       file.string()));
  const Positions vertices = read_obj_vertices(file);
  check_motion(motion, file, vertices.rows(), name);
  if (surface.drawn)
    throw InputError(name, fmt::format("the solid of '{}' is where its triangles wind around, which cannot follow "
                                       "vertices: close = \"caps\", or 'thicken' for its sheets, makes one that can",
                                       file.string()));
  const TriMesh raw = read_colored_surface(file).mesh;
  const SetUp set_up = set_up_of(raw, options);
  for (const Positions& frame : motion.frames) {
    frames_.push_back(set_up.placed(frame));
    const Bounds box = bounds_of(frames_.back());
    if (!(box.diagonal() > 0) || !(box.diagonal() < 1e9))
      throw InputError(name, fmt::format("frame {} has no extent, or is wider than 1e9 m", frames_.size() - 1));
  }
  // Files are read in single precision, and may be moved and scaled after that.
  const Positions placed = set_up.placed(vertices);
  const double scale = bounds_of(placed).diagonal() / std::max(1e-300, bounds_of(vertices).diagonal());
  const double close = 1e-6 * scale * vertices.cwiseAbs().maxCoeff();
  bind(placed, {set_up.placed(raw.points), raw.triangles}, close, options.thickness, name);
}

// Finds what each vertex of the solid follows. vertices: those of the file. read: its triangles as they were read, with
// one vertex or several for each of the file's. close: the distance within which two places are one [m].
void SolidMotion::bind(const Positions& vertices, const TriMesh& read, double close, double thickness,
                       const std::string& name) {
  const NearPoints all(vertices, {}, close);
  triangles_ = read.triangles;
  std::vector<char> used(std::size_t(vertices.rows()), 0);
  for (std::int32_t& v : triangles_.reshaped()) {
    v = all.nearest(read.points.row(v).transpose());
    if (v < 0) throw InputError(name, "the vertices of its surface's file are not those that were read from it");
    used[std::size_t(v)] = 1;
  }
  const TriMesh& solid = rest_->surface();
  const NearPoints on_surface(vertices, used, close);
  same_.resize(std::size_t(solid.points.rows()));
  for (Eigen::Index v = 0; v < solid.points.rows(); ++v)
    same_[std::size_t(v)] = on_surface.nearest(solid.points.row(v).transpose());
  if (std::ranges::find(same_, -1) == same_.end()) return;
  const auto around = beside_each(solid), in_file = beside_each({vertices, triangles_});
  const Positions normals = normals_of(vertices);
  const NearPoints wide(vertices, used, std::max(close, thickness));
  for (std::size_t v = 0; v < same_.size(); ++v) {
    if (same_[v] >= 0) continue;
    CapMiddle middle{Eigen::Index(v), {}};
    for (const std::int32_t other : around[v]) middle.rim.push_back(same_[std::size_t(other)]);
    if (std::ranges::find(middle.rim, -1) == middle.rim.end()) {
      middles_.push_back(std::move(middle));
      continue;
    }
    const Vec3 place = solid.points.row(Eigen::Index(v)).transpose();
    Beside beside{Eigen::Index(v), wide.nearest(place), -1, Vec3::Zero()};
    if (beside.near < 0 || in_file[std::size_t(beside.near)].empty())
      throw InputError(name, "a vertex of the surface's solid lies beside none of its file's: it cannot follow them");
    beside.next = in_file[std::size_t(beside.near)].front();
    beside.offset = axes_at(vertices, normals, beside).transpose() * (place - vertices.row(beside.near).transpose());
    beside_.push_back(beside);
  }
}

// Returns, for each vertex, twice the sum of the area vectors of its triangles.
Positions SolidMotion::normals_of(const Positions& file) const {
  Positions normals = Positions::Zero(file.rows(), 3);
  for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
    const auto corner = [&](int k) { return Vec3(file.row(triangles_(t, k)).transpose()); };
    const Vec3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (int k = 0; k < 3; ++k) normals.row(triangles_(t, k)) += normal.transpose();
  }
  return normals;
}

Mat3 SolidMotion::axes_at(const Positions& file, const Positions& normals, const Beside& beside) const {
  const Vec3 normal = normals.row(beside.near).transpose().stableNormalized();
  const Vec3 side = (file.row(beside.next) - file.row(beside.near)).transpose();
  const Vec3 along = (side - side.dot(normal) * normal).stableNormalized();
  Mat3 axes;
  axes << normal, along, normal.cross(along);
  return axes;
}

Positions SolidMotion::points_at(double frame) const {
  const double last = double(frames_.size() - 1), at = std::clamp(frame, 0.0, last), first = std::floor(at);
  const double share = at - first;
  const Positions& from = frames_[std::size_t(first)];
  const Positions file = share > 0 ? Positions((1 - share) * from + share * frames_[std::size_t(first) + 1]) : from;
  Positions points(Eigen::Index(same_.size()), 3);
  for (std::size_t v = 0; v < same_.size(); ++v)
    if (same_[v] >= 0) points.row(Eigen::Index(v)) = file.row(same_[v]);
  for (const CapMiddle& middle : middles_) {
    Vec3 sum = Vec3::Zero();
    for (const std::int32_t v : middle.rim) sum += file.row(v).transpose();
    points.row(middle.vertex) = sum.transpose() / double(middle.rim.size());
  }
  if (beside_.empty()) return points;
  const Positions normals = normals_of(file);
  for (const Beside& beside : beside_)
    points.row(beside.vertex) = file.row(beside.near) + (axes_at(file, normals, beside) * beside.offset).transpose();
  return points;
}

std::shared_ptr<const TriangleSolid> SolidMotion::solid_at(double frame) const {
  return rest_->moved(points_at(frame));
}

double SolidMotion::longest_way() const {
  double most = 0;
  for (std::size_t f = 1; f < frames_.size(); ++f)
    most = std::max(most, (frames_[f] - frames_[f - 1]).rowwise().squaredNorm().maxCoeff());
  return std::sqrt(most);
}

}  // namespace supple
