#include "sim/coarse/sheet_stiffness.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "sim/coarse/rest_moduli.h"
#include "sim/model/element_view.h"

namespace supple {
namespace {

// Calls visit(part, ElementView) for each triangle.
template <class Visit>
void for_each_triangle(const Model& model, const Visit& visit) {
  for (const Model::ChunkRange& range : model.chunks) {
    if (range.kind != ElementKind::triangle) continue;
    for_each_element(model, range,
                     [&](const ElementView& element) { visit(model.part_number(element.corner[0]), element); });
  }
}

// Returns the matrix from the lengths that a triangle's edges gain to the forces along them [N/m].
Mat3 edge_stiffness(const ElementView& triangle, const Membrane& membrane) {
  Eigen::Matrix2d inverse;
  inverse << triangle.field[0], triangle.field[1], triangle.field[2], triangle.field[3];
  const Eigen::Matrix2d flat = inverse.inverse();
  const Eigen::Vector2d edges[] = {flat.col(0), flat.col(1) - flat.col(0), -flat.col(1)};
  Mat3 gains;  // from the strains of warp and weft and twice their shear strain to what the edges gain in length [m]
  for (int e = 0; e < 3; ++e) {
    const Eigen::Vector2d d = edges[e].normalized();
    gains.row(e) << d[0] * d[0], d[1] * d[1], d[0] * d[1];
    gains.row(e) *= edges[e].norm();
  }
  const Mat3 strains = gains.inverse();
  return triangle.field[4] * strains.transpose() * plane_moduli(membrane) * strains;
}

}  // namespace

void SheetStiffness::make_structure(const Model& model, const Clusters& clusters) {
  sheets_.assign(model.parts.size(), {});
  for_each_triangle(model, [&](std::size_t part, const ElementView& element) {
    Sheet& sheet = sheets_[part];
    if (clusters.first[part] == clusters.first[part + 1]) return;
    Triangle to;
    to.first_share = static_cast<std::int32_t>(sheet.shares.size());
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = to.corner[k] = element.corner[k];
      if (v >= model.free) continue;
      for (int l = 0; l < most_of_vertex; ++l) {
        if (clusters.weight[v][l] <= 0) continue;
        const std::int32_t cluster = clusters.of[v][l] - clusters.first[part];
        auto share = std::find_if(sheet.shares.begin() + to.first_share, sheet.shares.end(),
                                  [&](const Share& known) { return known.cluster == cluster; });
        if (share == sheet.shares.end()) share = sheet.shares.insert(share, {cluster, {}});
        share->weight[k] = clusters.weight[v][l];
      }
    }
    std::sort(sheet.shares.begin() + to.first_share, sheet.shares.end(),
              [](const Share& a, const Share& b) { return a.cluster > b.cluster; });
    to.shares = static_cast<std::int32_t>(sheet.shares.size()) - to.first_share;
    sheet.triangles.push_back(to);
  });
  const Eigen::SparseMatrix<double> a = model.matrix.selfadjointView<Eigen::Lower>();
  for (std::size_t p = 0; p < sheets_.size(); ++p) {
    if (!sheets_[p].triangles.empty()) make_rows(model.parts[p], int(p), clusters, a, sheets_[p]);
  }
}

void SheetStiffness::make_rows(const Part& part, int number, const Clusters& clusters,
                               const Eigen::SparseMatrix<double>& a, Sheet& sheet) {
  sheet.first_free = part.first_free;
  const std::int32_t first = clusters.first[number];
  sheet.clusters = clusters.first[number + 1] - first;
  for (int v = part.first_free; v < part.first_free + part.free; ++v) {
    Vertex row{clusters.weight[v], clusters.of[v]};
    for (std::int32_t& cluster : row.cluster) cluster -= first;
    row.first_entry = static_cast<std::int32_t>(sheet.entries.size());
    row.first_joined = static_cast<std::int32_t>(sheet.joined.size());
    for (Eigen::SparseMatrix<double>::InnerIterator at(a, v); at; ++at) {
      Entry entry{static_cast<std::int32_t>(at.row()) - part.first_free};
      for (int l = 0; l < most_of_vertex; ++l) {
        const auto begin = sheet.joined.begin() + row.first_joined;
        const std::int32_t cluster = clusters.of[at.row()][l] - first;
        const auto known = std::find(begin, sheet.joined.end(), cluster);
        entry.slot[l] = static_cast<std::uint8_t>(known - begin);
        if (known == sheet.joined.end()) sheet.joined.push_back(cluster);
      }
      sheet.entries.push_back(entry);
    }
    row.entries = static_cast<std::int32_t>(sheet.entries.size()) - row.first_entry;
    row.joined = static_cast<std::int32_t>(sheet.joined.size()) - row.first_joined;
    SUPPLE_CHECK(row.joined, <=, most_joined);
    sheet.vertices.push_back(row);
  }
}

// Where cloth turns far within a step, turning makes it longer, which the stiffness at rest does not see. So H has a
// hundredth of L, which resists turning: enough for the triangles beside a held vertex, which turn most, and too little
// for a cluster. Without it, searches on a flat sheet that begins to swing tried 2 to 6 points an iteration.
void SheetStiffness::set_values(const Model& model) {
  constexpr double share_of_constant = 0.01;
  const double elastic = model.scheme.energy * model.scheme.theta * model.scheme.theta;
  std::vector<Eigen::Triplet<double>> terms;
  std::vector<std::size_t> next(sheets_.size(), 0);
  for_each_triangle(model, [&](std::size_t part, const ElementView& element) {
    if (!is_sheet(int(part))) return;
    Triangle& to = sheets_[part].triangles[next[part]++];
    const SystemTerm term = model.system_term(element);
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        if (element.corner[a] >= model.free || element.corner[b] >= model.free) continue;
        double product = 0;
        for (int j = 0; j < 3; ++j) product += term.row[a][j] * term.row[b][j];
        terms.emplace_back(element.corner[a], element.corner[b], elastic * term.weight * product);
      }
    }
    const Mat3 stiffness = elastic * edge_stiffness(element, model.fabrics[element.region].membrane);
    const Mat3 lower = stiffness.llt().matrixL();
    to.factor = {lower(0, 0), lower(1, 0), lower(1, 1), lower(2, 0), lower(2, 1), lower(2, 2)};
  });
  Eigen::SparseMatrix<double> stretching(model.free, model.free);
  stretching.setFromTriplets(terms.begin(), terms.end());
  const Eigen::SparseMatrix<double> a = model.matrix.selfadjointView<Eigen::Lower>();
  for (Sheet& sheet : sheets_) {
    for (std::size_t i = 0; i < sheet.vertices.size(); ++i) {
      const int v = sheet.first_free + static_cast<int>(i);
      Entry* entry = &sheet.entries[sheet.vertices[i].first_entry];
      Eigen::SparseMatrix<double>::InnerIterator other(stretching, v);
      for (Eigen::SparseMatrix<double>::InnerIterator at(a, v); at; ++at, ++entry) {
        SUPPLE_CHECK(entry->vertex + sheet.first_free, ==, at.row());
        entry->constant = entry->kept = at.value();
        if (!other || other.row() != at.row()) continue;
        entry->kept -= (1 - share_of_constant) * other.value();
        ++other;
      }
    }
  }
}

}  // namespace supple
