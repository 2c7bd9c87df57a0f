// Builds and solves the small system of the Woodbury identity, K^-1 + N^T A^-1 N over some stiff directions, whose
// solution is the forces at the contacts. The system takes the entries of A^-1 among the vertices of touching points
// alone, which are kept from step to step as long as A stays. Directions at right angles do not feel each other,
// because A is the same for x, y and z: on flat ground, normals and both tangents are three systems. Nor do directions
// feel each other that act on no common part of a model. So a system is sparse by blocks (block_factor.h), and dense
// for a body alone. C and its factor are in single precision.
//
// The second level of directions puts B^-1 = A^-1 + Z D Z^T in the place of A^-1. The matrix is then C + W D W^T, where
// C is K^-1 + N^T A^-1 N, and W = N^T Z. For several parts this matrix has the blocks of C. It is factored as it
// stands, whenever Z moves. For a body alone C keeps its factor and its three systems, and the rest is added by (C + W
// D W^T)^-1 = C^-1 - C^-1 W (1 + D W^T C^-1 W)^-1 D W^T C^-1 (Woodbury), or by L^-T (1 + V D V^T)^-1 L^-1 with C = L
// L^T and V = L^-1 W, where there are fewer directions than three quarters of the columns of W. With the first formula
// for several parts, a row of 80 cubes takes 3.5 times as long, because all columns of W are coupled there.
#pragma once

#include <Eigen/LU>
#include <array>
#include <functional>
#include <vector>

#include "base/types.h"
#include "sim/contact/block_factor.h"
#include "sim/contact/contact_stencil.h"
#include "sim/linear/inverse_entries.h"
#include "sim/model/system.h"

namespace supple {

// Describes a direction in which a point of the body has a stiffness that A does not contain. With such directions the
// matrix is A + sum k n n^T, where n has `axis` times the point's weights at its free vertices.
struct StiffDirection {
  ContactStencil stencil;
  Vec3 axis;         // of unit length
  double stiffness;  // k [N/m]

  // Returns the product of n with a vector by free vertex.
  double along(const Positions& d) const { return stencil.of_free(d).dot(axis); }
  // Adds `factor` times n.
  void add(double factor, Positions& sums) const { stencil.spread(factor * axis, sums); }
};

// Lists, by number, the directions that are solved for together.
struct CoupledDirections {
  std::vector<Vec3> axes;  // all that occur; where they are many, every direction counts as coupled with the list
  std::vector<Eigen::Index> members;
};

// Adds a direction to the list of those with which it is coupled; lists that it connects are merged. Returns the index
// of the list.
std::size_t couple(const StiffDirection& direction, Eigen::Index number, std::vector<CoupledDirections>& lists);

// Describes motions Z of a model's parts, such that B^-1 = A^-1 + Z D Z^T takes the place of A^-1
// (coarse/second_level.h).
struct AddedMotions {
  std::uint64_t pose = 0;         // another number wherever Z or D is another one; not 0
  std::vector<int> first_column;  // where the columns of Z of each part begin, and r, the number of all
  // Adds the products of a direction n with the columns of Z, n^T Z, to r numbers. The products are 0 for parts on
  // which n does not act.
  std::function<void(const StiffDirection&, double* row)> add_row;
  std::function<const Eigen::MatrixXd&(int part)> difference;  // the block of D
};

class Capacitance {
 public:
  // Returns the directions in the order of their numbers, which is not that in which they were set.
  const std::vector<StiffDirection>& directions() const { return directions_; }

  // Takes all directions out of the system. set() and append() do so, too, where the system is not positive definite.
  void clear();

  // Makes a step independent of earlier ones, except for entries that would be computed again with the same result.
  // parts: those of the model on whose vertices the directions will act; without this call, it has one part.
  void begin_step(const System& system, const std::vector<Part>& parts);

  // Says which motions the systems have that are built from now on; null: none. They must stay as they are until the
  // next call.
  void add_motions(const AddedMotions* motions) { motions_ = motions; }

  // Builds the system of these directions, which must be sorted by their points' first vertices. Where the present
  // system has a direction, or one that is nearly the same, it keeps its own, because a correction need not be exact.
  // append() adds directions to the system. Both return false when the system is not positive definite. threads: null
  // for the calling one alone.
  bool set(const System& system, const std::vector<StiffDirection>& wanted, Threads* threads);
  bool append(const System& system, const std::vector<StiffDirection>& more, Threads* threads);

  // Solves in place; the numbers are ordered by direction.
  void solve(Eigen::VectorXf& answer) const;

  // Returns W y, for W = N^T Z, which has a row for each direction, and r numbers.
  Eigen::VectorXf seen_by_directions(const Eigen::VectorXd& y) const;
  // Returns W^T f for numbers by direction.
  Eigen::VectorXd seen_by_motions(const Eigen::VectorXf& f) const;

  // Returns how many numbers of A^-1 and of its factor are kept from step to step.
  std::int64_t kept_numbers() const { return entries_.stored_numbers(); }

 private:
  using RowMatrix = BlockFactor::RowMatrix;
  // Holds a point of a body and the places of its free vertices among the kept entries.
  struct Point {
    const ContactStencil* stencil = nullptr;
    std::array<InverseEntries::Place, std::tuple_size_v<decltype(ContactStencil::vertex)>> place = {};
  };

  bool has_several_parts() const { return parts_.count() > 1; }
  void know_motions();
  bool extend(Threads* threads);
  void couple_motions();
  void couple_few();
  void solve_few(Eigen::VectorXf& answer) const;
  void keep_rows(const std::vector<Eigen::Index>& place);
  void fill(std::span<const Eigen::Index> rows, std::span<const Eigen::Index> columns, Eigen::Index shift,
            Eigen::Ref<RowMatrix> block) const;
  void add_products_of_motions(std::span<const Eigen::Index> rows, std::span<const Eigen::Index> columns,
                               Eigen::Ref<RowMatrix> block) const;
  Point point_of(const ContactStencil& stencil) const;
  float entry(const Point& a, const Point& b) const;
  std::size_t home_of(const StiffDirection& direction, Eigen::Index number);

  VertexParts parts_;
  std::vector<StiffDirection> directions_;
  std::vector<GroupKey> keys_;  // by direction: the parts on which it acts
  std::vector<CoupledDirections> lists_;
  std::vector<BlockFactor> factors_;  // by list
  InverseEntries entries_;
  std::uint64_t entries_of_ = 0;  // System::id

  const AddedMotions* motions_ = nullptr;
  std::uint64_t motions_of_ = 0;  // the pose of the motions that the system has; 0: it has none
  // Several parts have W and W D here, each row with the columns of the parts on which its direction acts.
  std::vector<std::size_t> begin_;  // by direction: where its numbers begin in the next two, and the end
  std::vector<float> row_, row_times_;
  // One part has all columns of W here.
  RowMatrix rows_;           // W
  std::vector<char> known_;  // by direction: whether its row is known
  bool is_changed_ = true;   // whether C, W or D are others than in the last couple_motions()
  bool are_few_ = false;     // whether the directions are so few that the second formula serves
  // W^T C^-1 W; where are_few_, 1 + V D V^T. C is the matrix without the motions.
  Eigen::MatrixXd between_;
  Eigen::PartialPivLU<Eigen::MatrixXd> both_;  // the factor of 1 + D W^T C^-1 W, or of 1 + V D V^T
};

}  // namespace supple
