#include "sim/coarse/sheet_patches.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "sim/model/element_view.h"

namespace supple {
namespace {

// Returns the place of the first of a vertex's weights that no other one exceeds by more than round-off.
int strongest_weight(const std::array<double, Clusters::most_of_vertex>& weight) {
  int best = 0;
  for (int k = 1; k < Clusters::most_of_vertex; ++k) {
    if (weight[k] > weight[best] * (1 + 1e-9)) best = k;
  }
  return best;
}

}  // namespace

std::vector<SheetPatch> make_patches(const Model& model, const Clusters& clusters) {
  std::vector<SheetPatch> patches;
  std::vector<std::int32_t> of_cluster(clusters.count(), -1), of_vertex(model.vertices, -1);
  for (int v = 0; v < model.vertices; ++v) {
    const int best = strongest_weight(clusters.weight[v]);
    if (clusters.weight[v][best] <= 0 || model.part_of(v).solid) continue;
    const std::int32_t cluster = clusters.of[v][best];
    if (of_cluster[cluster] < 0) {
      of_cluster[cluster] = static_cast<std::int32_t>(patches.size());
      patches.emplace_back().cluster = cluster;
    }
    of_vertex[v] = of_cluster[cluster];
    patches[of_vertex[v]].vertex.push_back(v);
    patches[of_vertex[v]].mass.push_back(model.mass[v]);
  }
  for_each_element(model, [&](const ElementView& element) {
    const std::int32_t patch = of_vertex[element.corner[0]];
    if (element.kind != ElementKind::triangle || patch < 0) return;
    const MembraneStiffness& k = model.fabric_stiffness[element.region];
    patches[patch].stiffness += 0.5 * element.field[4] * (k.along[0] + k.along[1]);
  });
  return patches;
}

ClusterTurn turn_of(const SheetPatch& patch, const Positions& x, const Positions& motion) {
  ClusterTurn turn;
  turn.stiffness = patch.stiffness;
  // Sums are made about the first vertex, and moved to the centre of mass.
  const Vec3 origin = x.row(patch.vertex.front()).transpose();
  double mass = 0;
  Vec3 center = Vec3::Zero(), shift = Vec3::Zero();
  Mat3 products = Mat3::Zero(), with_motion = Mat3::Zero();
  for (std::size_t i = 0; i < patch.vertex.size(); ++i) {
    const std::int32_t v = patch.vertex[i];
    const Vec3 at = x.row(v).transpose() - origin, part = patch.mass[i] * at;
    mass += patch.mass[i];
    center += part;
    products.noalias() += part * at.transpose();
    if (v >= motion.rows()) continue;
    const Vec3 moved = motion.row(v).transpose();
    shift += patch.mass[i] * moved;
    with_motion.noalias() += moved * part.transpose();
  }
  if (!(mass > 0)) return turn;
  products -= center * center.transpose() / mass;
  with_motion -= shift * center.transpose() / mass;
  const double size = products.trace();  // [kg m^2]
  if (!(size > 0)) return turn;
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(products);
  turn.normal = axes.eigenvectors().col(0);
  const Vec3 momentum(with_motion(2, 1) - with_motion(1, 2), with_motion(0, 2) - with_motion(2, 0),
                      with_motion(1, 0) - with_motion(0, 1));
  // A patch in a line has no inertia about it.
  turn.angle = ((1 + 1e-9) * size * Mat3::Identity() - products).ldlt().solve(momentum);
  Mat3 inverse = Mat3::Zero();  // of the products, in the plane
  for (int k = 1; k < 3; ++k) {
    if (axes.eigenvalues()[k] > 1e-6 * size)
      inverse += axes.eigenvectors().col(k) * axes.eigenvectors().col(k).transpose() / axes.eigenvalues()[k];
  }
  const Mat3 gradient = with_motion * inverse, plane = Mat3::Identity() - turn.normal * turn.normal.transpose();
  turn.strain = 0.5 * plane * (gradient + gradient.transpose()) * plane;
  return turn;
}

}  // namespace supple
