// Holds the second level of search directions: the rigid motions of overlapping clusters of the body (clusters.h), and
// two stiffnesses against them: that of the paper's A, and the elastic one. A = M/h^2 + L resists turning, although
// turning costs no elastic energy. There are few of these motions, so the elastic stiffness against them can be
// computed (docs/method.md, "Bodies that turn").
//
// The motions at positions x are Z, of six columns for each cluster c with weights w_c and centre p_c: w_c e and
// w_c e x (x - p_c). Elements are kept in groups, one for each cluster and region. The stiffness of a group is computed
// at rest, about the group's own centre and in its own frame, in which it does not change when the group turns; a rigid
// motion of all clusters of a group costs no energy there, whatever its shape has become. Held vertices do not move.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/threads.h"
#include "sim/coarse/clusters.h"
#include "sim/model/model.h"

namespace supple {

class CoarseSystem {
 public:
  static constexpr int motions_of_cluster = 6;

  // Computes the clusters and groups of a model of one part and their values; does nothing where this model has them
  // already. The bits of the result do not depend on earlier models.
  void make(const Model& model);

  // Makes both matrices at x (n x 3 in the model's order): constant() is Z^T A Z, and hessian() has the elastic
  // stiffness in place of L. Returns false where some group is so far from its rest shape that there are no matrices.
  bool turn_to(const Positions& x);

  int columns() const { return motions_of_cluster * clusters_.count(); }  // r; 0 for a body without tetrahedra
  // Both matrices are r x r, and only the lower triangle is filled [N/m], [N], [N m].
  const Eigen::MatrixXd& constant() const { return constant_; }
  const Eigen::MatrixXd& hessian() const { return hessian_; }

  // Computes Z^T (f - M a). forces: f on the free vertices at x [N]; acceleration: a, which is taken out [m/s^2].
  void restrict(const Model& model, const Positions& x, const Positions& forces, const Vec3& acceleration,
                Threads* threads, Eigen::VectorXd& result);
  // Adds Z y to motions of the free vertices at x [m]. Returns the sum of m times what was added [kg m].
  Vec3 prolong(const Model& model, const Positions& x, const Eigen::VectorXd& y, Threads* threads, Positions& motions);

  // Adds Z^T of a force on one free vertex at x to r numbers.
  void restrict_one(std::int32_t vertex, const Vec3& force, const Positions& x, double* sums) const;

  // Describes how a cluster moves, to first order in the motion.
  struct Turn {
    Vec3 angle = Vec3::Zero();   // the angle by which the cluster turns [rad]
    Mat3 strain = Mat3::Zero();  // the symmetric rest of the gradient of the motion
    double volume = 0;           // [m^3]
    double stiffness = 0;        // the integral of k over the cluster [J]
  };
  // Finds the turns of the clusters in a motion (n x 3, or of the free vertices alone) from x.
  void find_turns(const Positions& x, const Positions& motion, std::vector<Turn>& turns) const;
  // Returns a bound of the energy that a motion of the free vertices takes by stretching what turns (turning.h) [J].
  double most_stretched(const Model& model, const Positions& motion) const;
  // Returns the weighted mean, at a vertex, of matrices that are given for each cluster.
  Mat3 mean_at(std::int32_t vertex, const std::vector<Mat3>& by_cluster) const;

 private:
  struct Group {
    int region = 0;
    std::int32_t cluster = 0;            // the cluster to which the elements belong
    double volume = 0;                   // [m^3]
    double stiffness = 0;                // k [Pa]
    std::vector<std::int32_t> clusters;  // ascending
    // The mean deformation gradient and the centre are sums over these vertices.
    std::vector<std::int32_t> vertex;
    std::vector<Vec3> gradient;  // [1/m]
    std::vector<double> share;
    Vec3 rest_center = Vec3::Zero();
    std::vector<std::int32_t> own;  // the vertices whose masses count here
    // The integrals of d_a phi d_b psi over the elements, where phi and psi are the functions w_c and w_c (X - O)_j
    // of the clusters; 12 x 12 numbers for each pair of clusters, entry 3 (4 c + j) + a.
    Eigen::MatrixXd gradients;
    Eigen::MatrixXd constant, hessian;  // 6 x 6 for each pair of clusters
  };

  void make_structure(const Model& model);
  void make_groups(const Model& model);
  void add_gradients(const Model& model);
  Eigen::MatrixXd point_products(const Model& model, const Group& group) const;
  void set_values(const Model& model, Group& group) const;
  void find_stretch_bound(const Model& model);

  std::uint64_t structure_ = 0, model_ = 0;
  Clusters clusters_;
  std::vector<Group> groups_;
  std::vector<std::int32_t> group_of_;  // by tetrahedron, in the order of lanes; empty once the groups are made
  std::vector<Vec3> centers_;           // p_c [m]
  Eigen::MatrixXd constant_, hessian_;
  double stretch_bound_ = 0;        // most_stretched() over (sum of m |d|^2)^2 [1/(kg^2 m^2 s^2)]
  std::vector<double> partial_;     // of chunked sums
  std::vector<double> by_cluster_;  // scratch of prolong()
  std::vector<Mat3> shift_;         // from a group's clusters to its centre, as cross products
};

}  // namespace supple
