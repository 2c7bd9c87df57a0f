// Implements the part of SheetStiffness that steps use. Sums are made about the first centre of the part, and moved to
// each cluster's own at the end.
#include <algorithm>

#include "sim/coarse/cross_matrix.h"
#include "sim/coarse/sheet_stiffness.h"
#include "sim/elements/triangle.h"

namespace supple {
namespace {

// Holds eight numbers in a register, or in as many as the machine needs.
typedef double Eight __attribute__((vector_size(8 * sizeof(double))));

Eight load_eight(const double* from) {
  Eight numbers;
  __builtin_memcpy(&numbers, from, sizeof numbers);
  return numbers;
}

void add_eight(double* to, const Eight& numbers) {
  const Eight sum = load_eight(to) + numbers;
  __builtin_memcpy(to, &sum, sizeof sum);
}

// The numbers of a row: one for each rigid motion of a cluster, and two zeros.
constexpr int row_length = 8;
constexpr std::size_t longer_numbers = rigid_motions * row_length;
constexpr std::size_t product_numbers = 4 * row_length;  // rows 1, x, y, z; columns 1, x, y, z of A, and of H

// Returns how far an end of an edge moves along the edge by a unit of each rigid motion about the origin: the edge's
// direction, and the moment of that. Both ends move alike.
Eight line_of(const Vec3& from, const Vec3& to) {
  const Vec3 edge = to - from;
  const double length = edge.norm();
  const Vec3 n = length > 0 ? Vec3(edge / length) : Vec3::Zero();
  const Vec3 moment = from.cross(n);
  return Eight{n.x(), n.y(), n.z(), moment.x(), moment.y(), moment.z(), 0, 0};
}

using Block = Eigen::Matrix<double, rigid_motions, rigid_motions>;

// Returns the sum of a_ij E_i^T E_j, where E_i = [1, -[r_i]x] moves vertex i, from the sums of a_ij (1, r_i)(1, r_j)^T.
Block block_of(const double* products) {
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>, 0, Eigen::OuterStride<row_length>> m(products);
  const Mat3 outer = m.block<3, 3>(1, 1);
  Block b;
  b.block<3, 3>(0, 0) = m(0, 0) * Mat3::Identity();
  b.block<3, 3>(0, 3) = -cross_matrix(m.block<1, 3>(0, 1).transpose());
  b.block<3, 3>(3, 0) = cross_matrix(m.block<3, 1>(1, 0));
  b.block<3, 3>(3, 3) = outer.trace() * Mat3::Identity() - outer.transpose();
  return b;
}

// Expresses a block in motions about centres that are at s_c and s_d, given as cross products.
Block moved(const Block& b, const Mat3& s_c, const Mat3& s_d) {
  Block result = b;
  result.block<3, 6>(3, 0) -= s_c * b.block<3, 6>(0, 0);
  result.block<6, 3>(0, 3) += result.block<6, 3>(0, 0).eval() * s_d;
  return result;
}

}  // namespace

void SheetStiffness::add_longer_edges(const Sheet& sheet, const Vec3& origin, const Positions& x) {
  Eight rows[3 * most_of_vertex][3];
  for (const Triangle& triangle : sheet.triangles) {
    const Share* shares = &sheet.shares[triangle.first_share];
    Vec3 at[3];
    for (int k = 0; k < 3; ++k) at[k] = x.row(triangle.corner[k]).transpose() - origin;
    const Eight line[3] = {line_of(at[0], at[1]), line_of(at[1], at[2]), line_of(at[2], at[0])};
    const auto& [l00, l10, l11, l20, l21, l22] = triangle.factor;
    for (int c = 0; c < triangle.shares; ++c) {
      const auto& [w0, w1, w2] = shares[c].weight;
      const double gain[3] = {w1 - w0, w2 - w1, w0 - w2};
      rows[c][0] = gain[0] * l00 * line[0] + gain[1] * l10 * line[1] + gain[2] * l20 * line[2];
      rows[c][1] = gain[1] * l11 * line[1] + gain[2] * l21 * line[2];
      rows[c][2] = gain[2] * l22 * line[2];
    }
    for (int c = 0; c < triangle.shares; ++c) {
      for (int d = c; d < triangle.shares; ++d) {
        double* to = &longer_[longer_numbers * (std::size_t(shares[c].cluster) * sheet.clusters + shares[d].cluster)];
        for (int i = 0; i < rigid_motions; ++i, to += row_length)
          add_eight(to, rows[c][0][i] * rows[d][0] + rows[c][1][i] * rows[d][1] + rows[c][2][i] * rows[d][2]);
      }
    }
  }
}

void SheetStiffness::add_rows(const Sheet& sheet, const Vec3& origin, const Positions& x) {
  const auto count = static_cast<std::ptrdiff_t>(sheet.vertices.size());
  places_.resize(std::size_t(count) * row_length);
  for (std::ptrdiff_t v = 0; v < count; ++v) {
    const Vec3 at = x.row(sheet.first_free + v).transpose() - origin;
    double* to = &places_[std::size_t(v) * row_length];
    for (int half = 0; half < 2; ++half, to += 4) to[0] = 1, to[1] = at[0], to[2] = at[1], to[3] = at[2];
  }
  for (std::ptrdiff_t v = 0; v < count; ++v) {
    const Vertex& row = sheet.vertices[std::size_t(v)];
    Eight sums[most_joined];
    std::fill(sums, sums + row.joined, Eight{});
    for (const Entry *entry = &sheet.entries[row.first_entry], *end = entry + row.entries; entry < end; ++entry) {
      const double a = entry->constant, b = entry->kept;
      const Eight part = Eight{a, a, a, a, b, b, b, b} * load_eight(&places_[std::size_t(entry->vertex) * row_length]);
      const Vertex& other = sheet.vertices[entry->vertex];
      for (int l = 0; l < most_of_vertex; ++l) sums[entry->slot[l]] += other.weight[l] * part;
    }
    const double* place = &places_[std::size_t(v) * row_length];
    for (int k = 0; k < most_of_vertex; ++k) {
      if (row.weight[k] <= 0) continue;
      for (int s = 0; s < row.joined; ++s) {
        const std::int32_t other = sheet.joined[row.first_joined + s];
        if (other > row.cluster[k]) continue;
        double* to = &products_[product_numbers * (std::size_t(row.cluster[k]) * sheet.clusters + other)];
        for (int i = 0; i < 4; ++i, to += row_length) add_eight(to, row.weight[k] * place[i] * sums[s]);
      }
    }
  }
}

void SheetStiffness::make_matrices(int part, const Vec3* centers, const Positions& x, Eigen::MatrixXd& constant,
                                   Eigen::MatrixXd& hessian) {
  const Sheet& sheet = sheets_[std::size_t(part)];
  const std::size_t pairs = std::size_t(sheet.clusters) * sheet.clusters;
  longer_.assign(longer_numbers * pairs, 0.0);
  products_.assign(product_numbers * pairs, 0.0);
  add_longer_edges(sheet, centers[0], x);
  add_rows(sheet, centers[0], x);
  for (int c = 0; c < sheet.clusters; ++c) {
    const Mat3 s_c = cross_matrix(centers[c] - centers[0]);
    for (int d = 0; d <= c; ++d) {
      const Mat3 s_d = cross_matrix(centers[d] - centers[0]);
      const std::size_t pair = std::size_t(c) * sheet.clusters + d;
      const Eigen::Map<const Eigen::Matrix<double, rigid_motions, rigid_motions, Eigen::RowMajor>, 0,
                       Eigen::OuterStride<row_length>>
          longer(&longer_[longer_numbers * pair]);
      const double* products = &products_[product_numbers * pair];
      constant.block<rigid_motions, rigid_motions>(rigid_motions * c, rigid_motions * d) =
          moved(block_of(products), s_c, s_d);
      hessian.block<rigid_motions, rigid_motions>(rigid_motions * c, rigid_motions * d) =
          moved(block_of(products + 4) + longer, s_c, s_d);
    }
  }
}

}  // namespace supple
