// Computes the stiffnesses of cloth against the rigid motions Z of its clusters: Z^T A Z, and Z^T (M/h^2 + H) Z with
// the elastic stiffness H. Cloth bends far more within a cluster than solids do, so nothing is kept from its rest shape
// but the stiffness of triangles against longer edges, and each step sums up the triangles where they lie. H resists
// what makes the edges of triangles longer, by the moduli that taut cloth has at rest; a rigid motion of all clusters
// of a triangle does not. All else, such as inertia, bending and springs, is that of A. Not here: solids, whose groups
// of elements turn as a whole (coarse_system.h).
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "sim/coarse/clusters.h"
#include "sim/model/model.h"

namespace supple {

class SheetStiffness {
 public:
  // Finds what joins the vertices and clusters of the parts that are made of triangles.
  void make_structure(const Model& model, const Clusters& clusters);
  // Sets the numbers of a model of this structure.
  void set_values(const Model& model);

  bool is_sheet(int part) const { return !sheets_[std::size_t(part)].triangles.empty(); }

  // Writes the lower triangles of both matrices of a part at x (n x 3), for motions about the centres of its clusters.
  void make_matrices(int part, const Vec3* centers, const Positions& x, Eigen::MatrixXd& constant,
                     Eigen::MatrixXd& hessian);

 private:
  static constexpr int most_of_vertex = Clusters::most_of_vertex;
  static constexpr int most_joined = 64;  // clusters of a vertex's row

  // Says how much a cluster of the part moves each corner of a triangle; held corners do not move.
  struct Share {
    std::int32_t cluster;
    std::array<double, 3> weight;
  };

  // Describes a triangle by its edges. Edge e goes from corner e to the next one.
  struct Triangle {
    std::array<std::int32_t, 3> corner{};
    std::int32_t first_share = 0, shares = 0;
    // The lower triangular factor of the matrix from the lengths that edges gain to the forces along them, in the
    // order 00, 10, 11, 20, 21, 22 [sqrt(N/m)].
    std::array<double, 6> factor{};
  };

  // Holds a free vertex's weights and clusters. The vertices of its row of A belong to the clusters `joined`.
  struct Vertex {
    std::array<double, most_of_vertex> weight;
    std::array<std::int32_t, most_of_vertex> cluster;  // in the part's numbering
    std::int32_t first_entry = 0, entries = 0, first_joined = 0, joined = 0;
  };

  // Describes an entry A_ij of a vertex's row, over the free vertices of the part.
  struct Entry {
    std::int32_t vertex;                              // j, of the part
    double constant = 0, kept = 0;                    // A_ij, and what H has of it beside the stiffness of edges [N/m]
    std::array<std::uint8_t, most_of_vertex> slot{};  // where j's clusters are among `joined`
  };

  struct Sheet {
    std::int32_t first_free = 0;
    int clusters = 0;
    std::vector<Triangle> triangles;
    std::vector<Share> shares;
    std::vector<Vertex> vertices;
    std::vector<Entry> entries;
    std::vector<std::int32_t> joined;
  };

  static void make_rows(const Part& part, int number, const Clusters& clusters, const Eigen::SparseMatrix<double>& a,
                        Sheet& sheet);
  // These add up longer_ and products_ (sheet_matrices.cpp). origin: the place about which motions are meant.
  void add_longer_edges(const Sheet& sheet, const Vec3& origin, const Positions& x);
  void add_rows(const Sheet& sheet, const Vec3& origin, const Positions& x);

  std::vector<Sheet> sheets_;  // by part
  // Scratch. longer_: 6 x 8 numbers for each pair of clusters; products_: 4 x 8, those of A and of what H keeps.
  AlignedVector<double> longer_, products_, places_;
};

}  // namespace supple
