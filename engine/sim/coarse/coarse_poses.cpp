// Implements the part of CoarseSystem that steps use: its matrices in a pose, forces and motions of clusters, and their
// turns. The parts that do not change with the pose are in coarse_system.cpp.
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/stretches.h"
#include "sim/coarse/coarse_system.h"
#include "sim/coarse/cross_matrix.h"

namespace supple {
namespace {

// Holds a vector in a register, its fourth number 0; the compiler splits it where registers are narrower.
typedef double Four __attribute__((vector_size(4 * sizeof(double))));

Four load_three(const double* from) { return Four{from[0], from[1], from[2], 0}; }

// Returns (y, z, x, w) of (x, y, z, w).
Four next_of(const Four& a) { return __builtin_shufflevector(a, a, 1, 2, 0, 3); }

// Returns (z, x, y, w) of (x, y, z, w).
Four last_of(const Four& a) { return __builtin_shufflevector(a, a, 2, 0, 1, 3); }

Four cross(const Four& a, const Four& b) { return next_of(a) * last_of(b) - last_of(a) * next_of(b); }

using MotionBlock = Eigen::Matrix<double, rigid_motions, rigid_motions>;

// Expresses a block in the motions of its clusters about their own centres, along the world's axes. turn: the rotation
// from the group's frame to the world's; s_c, s_d: the ways from both clusters' centres to the group's, as cross
// products.
MotionBlock turned(const MotionBlock& block, const Mat3& turn, const Mat3& s_c, const Mat3& s_d) {
  const Mat3 b11 = turn * block.block<3, 3>(0, 0) * turn.transpose();
  const Mat3 b12 = turn * block.block<3, 3>(0, 3) * turn.transpose();
  const Mat3 b21 = turn * block.block<3, 3>(3, 0) * turn.transpose();
  const Mat3 b22 = turn * block.block<3, 3>(3, 3) * turn.transpose();
  MotionBlock result;
  const Mat3 upper = b12 - b11 * s_d;
  result.block<3, 3>(0, 0) = b11;
  result.block<3, 3>(0, 3) = upper;
  result.block<3, 3>(3, 0) = b21 + s_c * b11;
  result.block<3, 3>(3, 3) = b22 - b21 * s_d + s_c * upper;
  return result;
}

// Returns the sum of x_v g_v^T over some vertices. Those beyond the end of x do not count.
Mat3 gradient_of(const std::vector<std::int32_t>& vertices, const std::vector<Vec3>& gradients, const Positions& x) {
  Four columns[3] = {};
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (vertices[i] >= x.rows()) continue;
    const Four at = load_three(x.data() + 3 * std::size_t(vertices[i]));
    for (int j = 0; j < 3; ++j) columns[j] += at * gradients[i][j];
  }
  Mat3 sum;
  for (int j = 0; j < 3; ++j) sum.col(j) << columns[j][0], columns[j][1], columns[j][2];
  return sum;
}

}  // namespace

// Adds a group to the matrices of its part, or tells by `is_made` that the part has none.
void CoarseSystem::add_group(const Group& group, const Positions& x) {
  // Beyond these, the stiffness at rest says little of a group. With 0.4 and 2.5, spheres of spline materials were up
  // to four times farther from their solution than with one level, and bodies that were flattened by a violent impact
  // came to rest inside out; with 0.75 and 1.35, a ball of jelly that squashes as it rolls was three times as far.
  constexpr double least_stretch = 0.5, most_stretch = 2;
  Block& to_part = blocks_[group.part];
  Vec3 center = Vec3::Zero();
  for (std::size_t i = 0; i < group.vertex.size(); ++i) center += group.share[i] * x.row(group.vertex[i]).transpose();
  const SignedSvd pose(gradient_of(group.vertex, group.gradient, x));
  to_part.is_made = pose.stretch[2] > least_stretch && pose.stretch[0] < most_stretch;
  if (!to_part.is_made) return;
  const Mat3 turn = pose.rotation();
  shift_.clear();
  for (const std::int32_t c : group.clusters) shift_.push_back(cross_matrix(center - centers_[c]));
  const int first = clusters_.first[group.part];
  for (std::size_t c = 0; c < group.clusters.size(); ++c) {
    for (std::size_t d = 0; d <= c; ++d) {
      const auto from = static_cast<Eigen::Index>(rigid_motions * c), to = static_cast<Eigen::Index>(rigid_motions * d);
      const Eigen::Index row = rigid_motions * (group.clusters[c] - first),
                         column = rigid_motions * (group.clusters[d] - first);
      to_part.constant.block<rigid_motions, rigid_motions>(row, column) +=
          turned(group.constant.block<rigid_motions, rigid_motions>(from, to), turn, shift_[c], shift_[d]);
      to_part.hessian.block<rigid_motions, rigid_motions>(row, column) +=
          turned(group.hessian.block<rigid_motions, rigid_motions>(from, to), turn, shift_[c], shift_[d]);
    }
  }
}

bool CoarseSystem::turn_to(const Positions& x) {
  const int count = clusters_.count();
  centers_.resize(count);
  for (int c = 0; c < count; ++c) centers_[c] = x.row(clusters_.center[c]).transpose();
  blocks_.resize(parts());
  for (int part = 0; part < parts(); ++part) {
    const int size = columns_of(part);
    blocks_[part].constant.setZero(size, size);
    blocks_[part].hessian.setZero(size, size);
    blocks_[part].is_made = size > 0 && hampered_[part] != 0;
  }
  for (const Group& group : groups_) {
    if (blocks_[group.part].is_made) add_group(group, x);
  }
  for (int part = 0; part < parts(); ++part) {
    if (columns_of(part) > 0 && sheets_.is_sheet(part))
      sheets_.make_matrices(part, &centers_[clusters_.first[part]], x, blocks_[part].constant, blocks_[part].hessian);
  }
  return std::any_of(blocks_.begin(), blocks_.end(), [](const Block& block) { return block.is_made; });
}

// Torques are summed about the first centre of the part.
void CoarseSystem::sum_forces(const Model& model, const Piece& piece, const Positions& x, const Positions& forces,
                              const Vec3& acceleration) {
  const int first = clusters_.first[piece.part], count = clusters_.first[piece.part + 1] - first;
  const Four origin = load_three(centers_[first].data()), out = load_three(acceleration.data());
  double* sums = partial_.data() + piece.sums;
  std::fill(sums, sums + count * numbers_a_cluster, 0.0);
  for (int v = piece.first; v < piece.end; ++v) {
    const Four force = load_three(forces.data() + 3 * std::size_t(v)) - model.mass[v] * out;
    const Four torque = cross(load_three(x.data() + 3 * std::size_t(v)) - origin, force);
    for (int k = 0; k < Clusters::most_of_vertex; ++k) {
      double* to = sums + numbers_a_cluster * (clusters_.of[v][k] - first);
      const double weight = clusters_.weight[v][k];
      Four sum, turn;
      __builtin_memcpy(&sum, to, sizeof sum);
      __builtin_memcpy(&turn, to + 4, sizeof turn);
      sum += weight * force;
      turn += weight * torque;
      __builtin_memcpy(to, &sum, sizeof sum);
      __builtin_memcpy(to + 4, &turn, sizeof turn);
    }
  }
}

// Torques are moved to each cluster's own centre at the end.
void CoarseSystem::restrict(const Model& model, const Positions& x, const Positions& forces,
                            const std::vector<Vec3>& accelerations, Threads* threads, Eigen::VectorXd& result) {
  run_chunks(threads, static_cast<int>(pieces_.size()), long(model.free) * 12, [&](int number) {
    const Piece& piece = pieces_[number];
    sum_forces(model, piece, x, forces, accelerations[piece.part]);
  });
  result.setZero(columns());
  for (const Piece& piece : pieces_) {
    const double* sums = partial_.data() + piece.sums;
    for (int c = clusters_.first[piece.part]; c < clusters_.first[piece.part + 1]; ++c, sums += numbers_a_cluster) {
      result.segment<3>(rigid_motions * c) += Eigen::Map<const Vec3>(sums);
      result.segment<3>(rigid_motions * c + 3) += Eigen::Map<const Vec3>(sums + 4);
    }
  }
  for (int c = 0; c < clusters_.count(); ++c) {
    const Vec3 force = result.segment<3>(rigid_motions * c);
    result.segment<3>(rigid_motions * c + 3) -= (centers_[c] - centers_[clusters_.first[part_of_[c]]]).cross(force);
  }
}

// Adds the motion that by_cluster_ describes to a piece's vertices. Returns the sum of m times what was added [kg m].
Vec3 CoarseSystem::move_piece(const Model& model, const Piece& piece, const Positions& x, Positions& to) const {
  const Four origin = load_three(centers_[clusters_.first[piece.part]].data());
  Four moved = {0, 0, 0, 0};
  for (int v = piece.first; v < piece.end; ++v) {
    Four motion = {0, 0, 0, 0}, turn = {0, 0, 0, 0};
    for (int k = 0; k < Clusters::most_of_vertex; ++k) {
      const double* from = &by_cluster_[std::size_t(numbers_a_cluster) * clusters_.of[v][k]];
      const double weight = clusters_.weight[v][k];
      Four of_shift, of_turn;
      __builtin_memcpy(&of_shift, from, sizeof of_shift);
      __builtin_memcpy(&of_turn, from + 4, sizeof of_turn);
      motion += weight * of_shift;
      turn += weight * of_turn;
    }
    motion += cross(turn, load_three(x.data() + 3 * std::size_t(v)) - origin);
    for (int i = 0; i < 3; ++i) to.data()[3 * std::size_t(v) + i] += motion[i];
    moved += model.mass[v] * motion;
  }
  return {moved[0], moved[1], moved[2]};
}

const std::vector<Vec3>& CoarseSystem::prolong(const Model& model, const Positions& x, const Eigen::VectorXd& y,
                                               Threads* threads, Positions& to) {
  const int count = clusters_.count();
  by_cluster_.resize(std::size_t(count) * numbers_a_cluster);
  for (int c = 0; c < count; ++c) {
    const Vec3 turn = y.segment<3>(rigid_motions * c + 3);
    const Vec3 from_first = centers_[c] - centers_[clusters_.first[part_of_[c]]];
    const Vec3 shift = y.segment<3>(rigid_motions * c) - turn.cross(from_first);
    Eigen::Map<Eigen::Matrix<double, numbers_a_cluster, 1>>(&by_cluster_[std::size_t(c) * numbers_a_cluster]) << shift,
        0, turn, 0;
  }
  run_chunks(threads, static_cast<int>(pieces_.size()), long(model.free) * 12, [&](int number) {
    Eigen::Map<Vec3>(partial_.data() + pieces_[number].sums) = move_piece(model, pieces_[number], x, to);
  });
  moved_.assign(std::size_t(parts()), Vec3::Zero());
  for (const Piece& piece : pieces_) moved_[piece.part] += Eigen::Map<const Vec3>(partial_.data() + piece.sums);
  return moved_;
}

// A group whose mean deformation gradient F changes by D turns by the angle that minimises |D - [theta]x F|.
void CoarseSystem::find_turns(const Positions& x, const Positions& motion, std::vector<ClusterTurn>& turns) const {
  turns.assign(clusters_.count(), {});
  for (const Group& group : groups_) {
    const Mat3 gradient = gradient_of(group.vertex, group.gradient, x),
               change = gradient_of(group.vertex, group.gradient, motion);
    Vec3 torque = Vec3::Zero();
    for (int j = 0; j < 3; ++j) torque += gradient.col(j).cross(change.col(j));
    const Mat3 products = gradient * gradient.transpose();
    const Mat3 inertia = products.trace() * Mat3::Identity() - products;
    const Mat3 rate = change * gradient.inverse();
    ClusterTurn& turn = turns[group.cluster];
    turn.angle += group.volume * inertia.ldlt().solve(torque);
    turn.strain += group.volume * 0.5 * (rate + rate.transpose());
    turn.stiffness += group.volume * group.stiffness;
  }
  for (std::size_t c = 0; c < turns.size(); ++c) {
    if (volume_[c] <= 0) continue;
    turns[c].angle /= volume_[c];
    turns[c].strain /= volume_[c];
  }
  for (const SheetPatch& patch : patches_) turns[patch.cluster] = turn_of(patch, x, motion);
}

double CoarseSystem::most_stretched(const Model& model, const Positions& motion) const {
  double energy = 0;
  for (int p = 0; p < parts(); ++p) {
    const Part& part = model.parts[p];
    double sum = 0;
    for (int v = part.first_free; v < part.first_free + part.free; ++v)
      sum += model.mass[v] * motion.row(v).squaredNorm();
    energy += stretch_bounds_[p] * sum * sum;
  }
  return energy;
}

Mat3 CoarseSystem::mean_at(std::int32_t vertex, const std::vector<Mat3>& by_cluster) const {
  Mat3 sum = Mat3::Zero();
  for (int k = 0; k < Clusters::most_of_vertex; ++k)
    sum += clusters_.weight[vertex][k] * by_cluster[clusters_.of[vertex][k]];
  return sum;
}

void CoarseSystem::restrict_one(std::int32_t vertex, const Vec3& force, const Positions& x, double* sums) const {
  for (int k = 0; k < Clusters::most_of_vertex; ++k) {
    const std::int32_t c = clusters_.of[vertex][k];
    const Vec3 part = clusters_.weight[vertex][k] * force;
    const Vec3 torque = (x.row(vertex).transpose() - centers_[c]).cross(part);
    for (int i = 0; i < 3; ++i) {
      sums[rigid_motions * c + i] += part[i];
      sums[rigid_motions * c + 3 + i] += torque[i];
    }
  }
}

}  // namespace supple
