// Holds the second level of search directions: the rigid motions of overlapping clusters of the body (clusters.h), with
// the elastic stiffness against them and that of the paper's A. A = M/h^2 + L resists turning, although turning costs
// no elastic energy; among these motions, of which there are few, the elastic stiffness is known
// (docs/method.md, "Bodies that turn").
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

  // Computes what belongs to a model; does nothing where that is done. The bits do not depend on earlier models.
  void make(const Model& model);

  // Makes the matrices at x (n x 3 in the model's order): A's and the Hessian's, Z^T (M/h^2 + ...) Z. Returns false
  // where some group is so far from its rest shape that there are none.
  bool turn_to(const Positions& x);

  int columns() const { return motions_of_cluster * clusters_.count(); }         // r; 0: the body has no tetrahedra
  // r x r, the lower triangle [N/m], [N], [N m]
  const Eigen::MatrixXd& constant() const { return constant_; }
  const Eigen::MatrixXd& hessian() const { return hessian_; }

  // Computes Z^T (f - M a) for forces on the free vertices at x [N] and an acceleration that is taken out [m/s^2].
  void restrict(const Model& model, const Positions& x, const Positions& forces, const Vec3& acceleration,
                Threads* threads, Eigen::VectorXd& result);
  // Adds Z y to motions of the free vertices at x [m]. Returns the sum of m times what was added [kg m].
  Vec3 prolong(const Model& model, const Positions& x, const Eigen::VectorXd& y, Threads* threads, Positions& motions);

  // Adds Z^T of a force on one free vertex at x to r numbers.
  void restrict_one(std::int32_t vertex, const Vec3& force, const Positions& x, double* sums) const;

  // Describes how a cluster moves, to first order in the motion.
  struct Turn {
    Vec3 angle = Vec3::Zero();   // by which it turns [rad]
    Mat3 strain = Mat3::Zero();  // the symmetric rest of the gradient of the motion
    double volume = 0;           // [m^3]
    double stiffness = 0;        // the integral of k over it [J]
  };
  // Finds the turns of the clusters in a motion (n x 3, or of the free vertices alone) from x.
  void find_turns(const Positions& x, const Positions& motion, std::vector<Turn>& turns) const;
  // Returns a bound of the energy that a motion of the free vertices takes by stretching what turns (turning.h) [J].
  double most_stretched(const Model& model, const Positions& motion) const;
  // Interpolates what is known by cluster.
  Mat3 mean_at(std::int32_t vertex, const std::vector<Mat3>& by_cluster) const;

 private:
  struct Group {
    int region = 0;
    std::int32_t cluster = 0;            // to which the elements belong
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
  double stretch_bound_ = 0;        // over the square of the sum of m |d|^2 [1/(kg^2 m^2 s^2)]
  std::vector<double> partial_;     // of chunked sums
  std::vector<double> by_cluster_;  // of what is prolonged
  std::vector<Mat3> shift_;         // from a group's clusters to its centre, as cross products
};

}  // namespace supple
