#include "sim/measures/pose_elements.h"

#include <Eigen/LU>

#include <cmath>
#include <limits>

#include "sim/elements/tetrahedron.h"
#include "sim/measures/fields.h"

namespace supple {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

// Returns the edges from the first corner as columns.
Mat3 edges_of(const Positions& x, const Tetrahedra& tets, Eigen::Index element) {
  Mat3 edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = (x.row(tets(element, k + 1)) - x.row(tets(element, 0))).transpose();
  return edges;
}

Matrix3<double> as_kernel_matrix(const Mat3& f) {
  Matrix3<double> at;
  for (int i = 0; i < 9; ++i) at.m[i] = f(i / 3, i % 3);
  return at;
}

}  // namespace

PoseElements::PoseElements(const BodyDescription& body) : body_(body) {
  const TetMesh& mesh = body.mesh;
  begin_.assign(static_cast<std::size_t>(mesh.rest.rows()) + 1, 0);
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    const Mat3 edges = edges_of(mesh.rest, mesh.tets, e);
    volume_.push_back(std::abs(edges.determinant()) / 6);
    inverse_.push_back(edges.inverse());
    for (int k = 0; k < 4; ++k) ++begin_[mesh.tets(e, k) + 1];
  }
  for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
  elements_.resize(4 * volume_.size());
  std::vector<std::int32_t> next(begin_.begin(), begin_.end() - 1);
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    for (int k = 0; k < 4; ++k) elements_[next[mesh.tets(e, k)]++] = static_cast<std::int32_t>(e);
  }
}

double PoseElements::of_element(ElementQuantity quantity, const Positions& x, Eigen::Index element) const {
  if (!(volume_[element] > 0)) return undefined;
  const Mat3 f = edges_of(x, body_.mesh.tets, element) * inverse_[element];
  if (!f.allFinite()) return undefined;
  if (quantity == ElementQuantity::volume_ratio) return f.determinant();
  const Matrix3<double> at = as_kernel_matrix(f);
  if (quantity == ElementQuantity::stretch) return svd(at).s[0];
  if (quantity == ElementQuantity::compression) return 1 - svd(at).s[2];
  const int region = body_.mesh.regions.empty() ? 0 : body_.mesh.regions[element];
  Matrix3<double> stress;
  double density =
      std::visit([&](const auto& material) { return density_of(material, at, stress); }, body_.materials[region]);
  if (!body_.fibres.empty() && body_.fibres[region].kappa > 0) density += add_fibre(body_.fibres[region], at, stress);
  if (quantity == ElementQuantity::energy) return density;
  Mat3 piola;
  for (int i = 0; i < 9; ++i) piola(i / 3, i % 3) = stress.m[i];
  return von_mises(f, piola);
}

void PoseElements::evaluate(ElementQuantity quantity, const Positions& x, Threads* threads,
                            std::vector<double>& values) const {
  const auto count = static_cast<Eigen::Index>(volume_.size());
  constexpr Eigen::Index chunk = 1024;
  values.resize(volume_.size());
  run_chunks(threads, static_cast<int>((count + chunk - 1) / chunk), 200 * count, [&](int number) {
    const Eigen::Index end = std::min(count, (number + 1) * chunk);
    for (Eigen::Index e = number * chunk; e < end; ++e) values[e] = of_element(quantity, x, e);
  });
}

void PoseElements::to_vertices(const std::vector<double>& values, Threads* threads,
                               std::vector<double>& by_vertex) const {
  const std::size_t count = begin_.size() - 1;
  constexpr std::size_t chunk = 4096;
  by_vertex.resize(count);
  run_chunks(threads, static_cast<int>((count + chunk - 1) / chunk), static_cast<long>(elements_.size()),
             [&](int number) {
               const std::size_t end = std::min(count, (std::size_t(number) + 1) * chunk);
               for (std::size_t v = std::size_t(number) * chunk; v < end; ++v) {
                 double sum = 0, weight = 0;
                 for (std::int32_t i = begin_[v]; i < begin_[v + 1]; ++i) {
                   const std::int32_t e = elements_[i];
                   if (std::isnan(values[e])) continue;
                   sum += volume_[e] * values[e];
                   weight += volume_[e];
                 }
                 by_vertex[v] = weight > 0 ? sum / weight : undefined;
               }
             });
}

}  // namespace supple
