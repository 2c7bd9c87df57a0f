// The small system of the Woodbury identity, K^-1 + N^T A^-1 N over some stiff directions: it gives the forces at
// contacts that keep them from moving. It takes the entries of A^-1 among the vertices of touching points alone, which
// are kept from step to step as long as A stays. Directions at right angles do not feel each other, because A is the
// same for x, y and z: on flat ground normals and both tangents are three systems. Nor do directions that act on no
// common part of a model: a system is sparse by blocks (block_factor.h), and dense for a body alone. All in single
// precision.
#pragma once

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
  std::vector<Vec3> axes;  // all that occur; where they are many, all other directions count as coupled
  std::vector<Eigen::Index> members;
};

// Adds a direction to the list of those with which it is coupled; lists that it connects are merged. Returns the index
// of the list.
std::size_t couple(const StiffDirection& direction, Eigen::Index number, std::vector<CoupledDirections>& lists);

class Capacitance {
 public:
  // Returns the directions in the order of their numbers, which is not that in which they were set.
  const std::vector<StiffDirection>& directions() const { return directions_; }

  // Leaves a system without directions. The same remains of a system that is not positive definite.
  void clear();

  // Makes a step independent of earlier ones, except for entries that would be computed again with the same result.
  // parts: of the model whose vertices the directions will act on; without this call it has one.
  void begin_step(const System& system, const std::vector<Part>& parts);

  // Builds the system of these directions, which must be sorted by their points' first vertices. What the present
  // system has of them, or nearly so, stays as it is, because a correction need not be exact. Returns false when the
  // system is not positive definite. threads: null for the calling one alone.
  bool set(const System& system, const std::vector<StiffDirection>& wanted, Threads* threads);
  bool append(const System& system, const std::vector<StiffDirection>& more, Threads* threads);

  // Solves in place; the numbers are ordered by direction.
  void solve(Eigen::VectorXf& answer) const;

  using RowMatrix = BlockFactor::RowMatrix;

  // Makes ready rows(), W, of what each direction is on some coarse motions, and between(), W^T C^-1 W for the system's
  // matrix C. first_column: where the motions of each part begin, and r, the number of all. `find_row` writes the r
  // numbers of a direction, which are 0 for parts on which it does not act; it is asked once for each of a pose (which
  // is not 0), for as long as the direction stays. Returns whether anything is new.
  using FindRow = std::function<void(const StiffDirection&, float* row)>;
  bool know_rows(std::uint64_t pose, const std::vector<int>& first_column, const FindRow& find_row, Threads* threads);
  const RowMatrix& rows() const { return rows_; }
  const Eigen::MatrixXd& between() const { return between_; }

  // Returns how many numbers of A^-1 and of its factor are kept from step to step.
  std::int64_t kept_numbers() const { return entries_.stored_numbers(); }

 private:
  bool extend(Threads* threads);
  void keep_rows(const std::vector<Eigen::Index>& place);
  void fill(std::span<const Eigen::Index> rows, std::span<const Eigen::Index> columns, Eigen::Index shift,
            Eigen::Ref<RowMatrix> block) const;
  float entry(const ContactStencil& a, const ContactStencil& b) const;

  VertexParts parts_;
  std::vector<StiffDirection> directions_;
  std::vector<GroupKey> keys_;  // by direction: the parts on which it acts
  std::vector<CoupledDirections> lists_;
  std::vector<BlockFactor> factors_;  // of the lists
  InverseEntries entries_;
  std::uint64_t entries_of_ = 0;  // System::id
  std::uint64_t rows_of_ = 0;     // the pose of the rows; 0: there are none
  RowMatrix rows_;
  std::vector<char> known_;        // by direction: whether its row is known
  std::size_t lists_counted_ = 0;  // in `between_`
  Eigen::MatrixXd between_;
};

}  // namespace supple
