// Holds the second level of search directions: the rigid motions of overlapping clusters of bodies (clusters.h), and
// two stiffnesses against them: that of the paper's A, and the elastic one. A = M/h^2 + L resists turning, although
// turning costs no elastic energy. There are few of these motions, so the elastic stiffness against them can be
// computed (docs/method.md, "Bodies that turn").
//
// The motions at positions x are Z, of six columns for each cluster c with weights w_c and centre p_c: w_c e and
// w_c e x (x - p_c). Elements are kept in groups, one for each cluster and region. The stiffness of a group is computed
// at rest, about the group's own centre and in its own frame, in which it does not change when the group turns; a rigid
// motion of all clusters of a group costs no energy there, whatever its shape has become. Held vertices do not move.
// Cloth is summed up where it lies (sheet_stiffness.h).
//
// Clusters and groups belong to one part of the model each. Columns of Z come part by part, and both matrices are kept
// as one block for each part, because the entries between parts are 0.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/threads.h"
#include "sim/coarse/clusters.h"
#include "sim/coarse/sheet_patches.h"
#include "sim/coarse/sheet_stiffness.h"
#include "sim/model/model.h"

namespace supple {

class CoarseSystem {
 public:
  // Computes the clusters and groups of a model and their values; does nothing if they are those of this model already.
  // The bits of the result do not depend on earlier models.
  void make(const Model& model);

  // Makes both matrices of each part at x (n x 3 in the model's order): constant() is Z^T A Z, and hessian() has the
  // elastic stiffness in place of L. A solid that A does not keep from turning has no matrices, nor has a part with a
  // group that is too far from its rest shape. Returns whether any part has them.
  bool turn_to(const Positions& x);

  // Returns the number of parts.
  int parts() const { return static_cast<int>(clusters_.first.size()) - 1; }
  int columns() const { return rigid_motions * clusters_.count(); }  // r
  // The columns of a part are first_column(part) .. first_column(part + 1) - 1; cloth of springs has none.
  int first_column(int part) const { return rigid_motions * clusters_.first[part]; }
  int columns_of(int part) const { return first_column(part + 1) - first_column(part); }
  // Tells whether the last turn_to has made matrices for a part.
  bool has_matrices(int part) const { return blocks_[part].is_made; }
  // These return Z^T A Z and Z^T (M/h^2 + H) Z with the columns of one part; only the lower triangles are filled [N/m],
  // [N], [N m].
  const Eigen::MatrixXd& constant(int part) const { return blocks_[part].constant; }
  const Eigen::MatrixXd& hessian(int part) const { return blocks_[part].hessian; }

  // Computes Z^T (f - M a). forces: f on the free vertices at x [N]; accelerations: a of each part, which is taken out
  // [m/s^2].
  void restrict(const Model& model, const Positions& x, const Positions& forces, const std::vector<Vec3>& accelerations,
                Threads* threads, Eigen::VectorXd& result);
  // Adds Z y to motions of the free vertices at x [m]. Returns by part the sum of m times the motions that were added
  // [kg m], which the next call overwrites.
  const std::vector<Vec3>& prolong(const Model& model, const Positions& x, const Eigen::VectorXd& y, Threads* threads,
                                   Positions& motions);

  // Adds Z^T of a force on one free vertex at x to r numbers.
  void restrict_one(std::int32_t vertex, const Vec3& force, const Positions& x, double* sums) const;

  // Finds the turns of the clusters in a motion (n x 3, or of the free vertices alone) from x.
  void find_turns(const Positions& x, const Positions& motion, std::vector<ClusterTurn>& turns) const;
  // Returns the part of the model that a cluster belongs to.
  int part_of(std::size_t cluster) const { return part_of_[cluster]; }
  // Returns an upper bound of the energy that a motion of the free vertices takes by stretching what turns (turning.h)
  // [J].
  double most_stretched(const Model& model, const Positions& motion) const;
  // Returns the weighted mean, at a vertex, of matrices that are given for each cluster.
  Mat3 mean_at(std::int32_t vertex, const std::vector<Mat3>& by_cluster) const;

 private:
  struct Group {
    int region = 0;
    std::int32_t cluster = 0;            // the cluster to which the elements belong
    int part = 0;                        // the part to which this cluster belongs
    double volume = 0;                   // [m^3]
    double stiffness = 0;                // k [Pa]
    std::vector<std::int32_t> clusters;  // those of the free vertices, ascending
    // The mean deformation gradient and the centre are sums over these vertices.
    std::vector<std::int32_t> vertex;
    std::vector<Vec3> gradient;  // [1/m]
    std::vector<double> share;
    Vec3 rest_center = Vec3::Zero();
    std::vector<std::int32_t> own;  // the vertices whose masses count here
    // The integrals of d_a phi d_b psi over the elements, where phi and psi are the functions w_c and w_c (X - O)_j of
    // the clusters, and O is rest_center; 12 x 12 numbers for each pair of clusters, entry 3 (4 c + j) + a.
    Eigen::MatrixXd gradients;
    Eigen::MatrixXd constant, hessian;  // 6 x 6 for each pair of clusters
  };

  // Holds the matrices of one part.
  struct Block {
    Eigen::MatrixXd constant, hessian;
    bool is_made = false;
  };
  // A force and a torque, or a shift and a turn, each with a fourth number.
  static constexpr int numbers_a_cluster = 8;
  // Describes some of the free vertices of one part, over which sums are made at once.
  struct Piece {
    int part;
    int first, end;    // vertices
    std::size_t sums;  // where the sums of the part's clusters begin in partial_
  };

  void make_structure(const Model& model);
  void make_pieces(const Model& model);
  void make_groups(const Model& model);
  void add_gradients(const Model& model);
  Eigen::MatrixXd point_products(const Model& model, const Group& group) const;
  void set_values(const Model& model, Group& group) const;
  void find_stretch_bounds(const Model& model);
  void find_hampered(const Model& model);
  void add_group(const Group& group, const Positions& x);
  void sum_forces(const Model& model, const Piece& piece, const Positions& x, const Positions& forces,
                  const Vec3& acceleration);
  Vec3 move_piece(const Model& model, const Piece& piece, const Positions& x, Positions& motions) const;

  std::uint64_t structure_ = 0, model_ = 0;
  Clusters clusters_;
  std::vector<Group> groups_;
  std::vector<SheetPatch> patches_;
  SheetStiffness sheets_;
  std::vector<std::int32_t> group_of_;  // by tetrahedron, in the order of lanes; empty once the groups are made
  std::vector<int> part_of_;            // by cluster
  std::vector<double> volume_;          // of the groups of each cluster [m^3]
  std::vector<Vec3> centers_;           // p_c [m]
  std::vector<Block> blocks_;           // by part
  std::vector<double> stretch_bounds_;  // by part: most_stretched() over (sum of m |d|^2)^2 [1/(kg^2 m^2 s^2)]
  std::vector<char> hampered_;          // by part: whether A keeps it from turning, or it is cloth of fabric
  std::vector<Piece> pieces_;           // of the parts that have clusters
  std::vector<double> partial_;         // sums over pieces
  std::vector<Vec3> moved_;             // the result of prolong()
  std::vector<double> by_cluster_;      // scratch of prolong()
  std::vector<Mat3> shift_;             // from a group's clusters to its centre, as cross products
};

}  // namespace supple
