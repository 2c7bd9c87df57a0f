// Holds the Cholesky factor L L^T of a symmetric matrix C. The rows and columns of C are its members: they have numbers
// and fall into groups; two groups have entries with each other only if they share a part of the model
// (block_pattern.h). Blocks of groups are dense, and computed in single precision, column of blocks by column of
// blocks: what earlier columns subtract from a block is gathered when the block's turn comes ("left-looking"; Davis
// 2006, "Direct methods for sparse linear systems", section 4.8). When members come and go, those that stay keep their
// order in their group, and blocks that depend on nothing new stay; within a group on which nothing new acts, the first
// members keep their factor. With one group, this is a dense factor that grows at its end.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/threads.h"
#include "base/types.h"
#include "sim/contact/block_pattern.h"

namespace supple {

class BlockFactor {
 public:
  using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Members = std::vector<Eigen::Index>;

  // Writes entries of C: row i of `block` gets those of the member rows[i] with the first shift + i + 1 members of
  // `columns`, or with all of `columns` if these are fewer.
  using Fill = std::function<void(std::span<const Eigen::Index> rows, std::span<const Eigen::Index> columns,
                                  Eigen::Index shift, Eigen::Ref<RowMatrix> block)>;

  // Begins with these members; keys: the groups of all members by number. Nothing that came before has an influence.
  void begin(const Members& members, const std::vector<GroupKey>& keys);
  // Does the same, but keeps what it can. place: the numbers that earlier members have now, by their earlier numbers;
  // -1 for those that are gone.
  void replace(const Members& members, const std::vector<GroupKey>& keys, const std::vector<Eigen::Index>& place);
  // Adds a member. Until the next replace() it comes after all groups and leaves their factor as it is, unless what was
  // appended costs more than all groups: compute() then sorts it into the groups and factors all of them anew.
  void append(Eigen::Index member, const GroupKey& key);

  // Returns a rough count of the operations of the next compute().
  long work() const;
  // Computes what is not known of L. Returns false when C is not positive definite. threads: null for the calling one
  // alone; the result does not depend on them.
  bool compute(const Fill& fill, Threads* threads);

  // Solves C x = b in place for the members' numbers in a vector.
  void solve(Eigen::VectorXf& numbers) const;

  // These solve L X = B and L^T X = B in place, in double precision. The rows of X have the members' numbers; all
  // members must be of one group.
  void solve_lower(Eigen::Ref<Eigen::MatrixXd> numbers) const;
  void solve_upper(Eigen::Ref<Eigen::MatrixXd> numbers) const;

  // Computes W^T C^-1 W, for members of one group. rows: W, by number of the member.
  void multiply_rows(const RowMatrix& rows);
  void forget_rows();
  // Adds the lower triangle of that product.
  void add_product(Eigen::MatrixXd& sum) const;

 private:
  struct Block {
    int group;                // the group of its rows
    Eigen::MatrixXf numbers;  // the entries, in the top left corner
    Eigen::Index known = 0;   // rows that it holds already
  };
  struct Column {
    GroupKey key;
    Members members;
    RowMatrix lower;            // the block on the diagonal, in its top left corner
    Eigen::Index factored = 0;  // members that it holds already
    Eigen::Index first = 0;     // members that it held before the present compute()
    std::vector<Block> below;   // ascending
    bool is_new = false;        // whether its numbers are others than after the last compute()
    RowMatrix seen;             // the column's rows of L^-1 W, in the upper rows of this matrix
    Eigen::Index seen_members = 0;
    Eigen::MatrixXf product;  // the product of these rows with themselves, the lower triangle
    Eigen::Index summed = 0;  // members that the product holds already
    bool has_product = false;

    Eigen::Index size() const { return static_cast<Eigen::Index>(members.size()); }
    // Keeps only what belongs to the first `count` members.
    void keep(Eigen::Index count);
    void keep_rows(Eigen::Index count);
  };
  // Names the block by which an earlier column acts on a later one: its rows are those of the later one's group.
  struct Update {
    int column;
    int block;
  };
  void begin(std::vector<GroupKey> keys, std::vector<Members> members);
  void begin_if_appended_cost_much();
  void link();
  long operations(int group) const;
  void subtract_updates(int column, int group, Eigen::Index first_row, Eigen::Index first_column,
                        Eigen::Ref<Eigen::MatrixXf> target) const;
  bool factor_diagonal(int group, const Fill& fill);
  void factor_block(int group, Block& block, const Fill& fill) const;
  static void see_rows(const RowMatrix& rows, Column& column);
  static void sum_product(Column& column);

  std::vector<Column> columns_;               // in the order of elimination, and then those that were appended
  std::size_t ordered_ = 0;                   // how many of them were not appended
  std::vector<std::vector<Update>> updates_;  // by column: the blocks that act on it
  std::vector<std::vector<int>> levels_;      // each has columns on which only columns of earlier levels act
  bool is_linked_ = false;
};

}  // namespace supple
