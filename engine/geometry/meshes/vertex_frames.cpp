#include "geometry/meshes/vertex_frames.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

#include "base/stretches.h"

namespace supple {
namespace {

constexpr double least_stretch = 2.0 / 3, largest_stretch = 1.5;

// Returns the gradients of an element's four linear shape functions times its rest volume: for each corner a third of
// the area vector of the opposite face, which points inwards. They are finite in slivers too.
Eigen::Matrix<double, 4, 3> volume_gradients(const TetMesh& mesh, Eigen::Index element) {
  const auto edge = [&](int k) -> Vec3 {
    return mesh.rest.row(mesh.tets(element, k)) - mesh.rest.row(mesh.tets(element, 0));
  };
  const Vec3 a = edge(1), b = edge(2), c = edge(3);
  Eigen::Matrix<double, 4, 3> result;
  result.row(1) = b.cross(c).transpose() / 6;
  result.row(2) = c.cross(a).transpose() / 6;
  result.row(3) = a.cross(b).transpose() / 6;
  result.row(0) = -(result.row(1) + result.row(2) + result.row(3));
  return result;
}

// Tells whether a symmetric matrix is positive definite, by its leading minors (Sylvester's criterion).
bool is_positive(const Mat3& m) {
  return m(0, 0) > 0 && m(0, 0) * m(1, 1) - m(0, 1) * m(0, 1) > 0 && m.determinant() > 0;
}

}  // namespace

VertexFrames vertex_frames(const TetMesh& mesh, const std::vector<std::int32_t>& vertices) {
  std::vector<std::int32_t> frame_of(std::size_t(mesh.rest.rows()), -1);
  for (std::size_t f = 0; f < vertices.size(); ++f) frame_of[std::size_t(vertices[f])] = static_cast<std::int32_t>(f);
  struct Term {
    std::int32_t corner;
    Vec3 gradient;
  };
  std::vector<std::vector<Term>> terms(vertices.size());
  std::vector<double> volume(vertices.size(), 0);
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    const Eigen::Matrix<double, 4, 3> gradients = volume_gradients(mesh, e);
    for (int k = 0; k < 4; ++k) {
      const std::int32_t frame = frame_of[std::size_t(mesh.tets(e, k))];
      if (frame < 0) continue;
      volume[std::size_t(frame)] += tet_volume(mesh, e);
      for (int j = 0; j < 4; ++j) terms[std::size_t(frame)].push_back({mesh.tets(e, j), gradients.row(j).transpose()});
    }
  }
  VertexFrames frames;
  frames.vertex = vertices;
  frames.begin = {0};
  std::vector<Vec3> gradients;
  for (std::size_t f = 0; f < vertices.size(); ++f) {
    std::ranges::stable_sort(terms[f], {}, &Term::corner);
    for (std::size_t i = 0; i < terms[f].size(); ++i) {
      const bool first = i == 0 || terms[f][i].corner != terms[f][i - 1].corner;
      if (first) frames.corner.push_back(terms[f][i].corner);
      if (first) gradients.emplace_back(Vec3::Zero());
      gradients.back() += terms[f][i].gradient / volume[f];
    }
    frames.begin.push_back(static_cast<std::int32_t>(frames.corner.size()));
  }
  frames.gradient.resize(static_cast<Eigen::Index>(gradients.size()), 3);
  for (std::size_t i = 0; i < gradients.size(); ++i) frames.gradient.row(Eigen::Index(i)) = gradients[i].transpose();
  return frames;
}

Mat3 held_within_limits(const Mat3& gradient) {
  // Most frames pass this test and need no decomposition.
  const double det = gradient.determinant();
  const Mat3 squares = gradient.transpose() * gradient;
  if (det > 0 && is_positive(squares - least_stretch * least_stretch * Mat3::Identity()) &&
      is_positive(largest_stretch * largest_stretch * Mat3::Identity() - squares))
    return gradient;
  const SignedSvd svd(gradient);
  const Vec3 stretch = svd.stretch.cwiseMax(least_stretch).cwiseMin(largest_stretch);
  return svd.u * stretch.asDiagonal() * svd.v.transpose();
}

std::vector<Mat3> frames_at(const VertexFrames& frames, const Positions& positions, Threads* threads) {
  std::vector<Mat3> result(frames.vertex.size());
  constexpr Eigen::Index chunk = 256;
  const Eigen::Index count = frames.count();
  run_chunks(threads, static_cast<int>((count + chunk - 1) / chunk), 300 * count, [&](int number) {
    const Eigen::Index end = std::min(count, (number + 1) * chunk);
    for (Eigen::Index f = number * chunk; f < end; ++f) {
      Mat3 gradient = Mat3::Zero();
      for (std::int32_t i = frames.begin[std::size_t(f)]; i < frames.begin[std::size_t(f) + 1]; ++i)
        gradient += positions.row(frames.corner[std::size_t(i)]).transpose() * frames.gradient.row(i);
      result[std::size_t(f)] = held_within_limits(gradient);
    }
  });
  return result;
}

}  // namespace supple
