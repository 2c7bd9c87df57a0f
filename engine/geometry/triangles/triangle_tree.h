// Orders triangles in a balanced binary tree, and tells of each of its parts in which box it lies and how it looks from
// afar: by the first two terms of the expansion of Barill, Dickson, Schmidt, Levin, Jacobson, Fast winding numbers for
// soups and clouds, 2018, section 3. It asks nothing of the triangles: triangle_soup.h and triangle_solid.h do.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

// Says how a part of the triangles is cut in two, at the middle of their centroids along an axis.
enum class TreeCut {
  longest_side,    // across the longest side of the part's box, into equal numbers: quick to build
  smallest_boxes,  // across the axis that leaves the two smallest boxes, into whole leaves: quick to search
};

struct TriangleTree {
  static constexpr int leaf_size = 4;  // triangles, at most

  struct Node {
    Bounds box;
    Vec3 center = Vec3::Zero();         // mean of the triangles, weighted by area [m]
    Vec3 area = Vec3::Zero();           // sum of their area vectors [m^2]
    Mat3 moment = Mat3::Zero();         // sum of (centroid - center) x area vector, as outer products [m^3]
    double radius = 0;                  // distance from the centre to the furthest corner [m]
    std::int32_t first = 0, count = 0;  // its triangles are [first, first + count) of the order
    std::int32_t other = 0;             // its children are the next node and this one; 0: it is a leaf
    bool is_leaf() const { return other == 0; }
  };

  // Names up to four nodes that together have the triangles of one.
  struct Parts {
    std::array<std::int32_t, 4> node;
    int count;
  };
  // Returns parts of a node. The largest part, at first the node itself, is replaced by its children until there are
  // four parts, or it is a leaf.
  Parts four_parts(std::int32_t node) const;

  std::span<const std::int32_t> triangles_of(const Node& node) const {
    return {order.data() + node.first, std::size_t(node.count)};
  }

  std::vector<std::int32_t> order;  // the triangles, so that each node has a range of them
  std::vector<Node> nodes;          // the root first
};

// Builds the tree, on all threads if that is worth it; the bits are those of one thread. Triangles without area do no
// harm.
TriangleTree triangle_tree(const TriMesh& mesh, TreeCut cut);

// Holds the nodes that wait during a walk through a tree. 2^31 triangles make 31 levels, with one sibling waiting at
// each; where nodes have four children they make 15 levels with three.
template <class Entry>
class TreeStack {
 public:
  explicit TreeStack(const Entry& root) { push(root); }
  bool empty() const { return size_ == 0; }
  int size() const { return size_; }
  void push(const Entry& entry) { entries_[std::size_t(size_++)] = entry; }
  Entry pop() { return entries_[std::size_t(--size_)]; }

  // Pushes an entry, but below those last entries, down to the place `from`, for which waits_for(entry, other) is true.
  template <class WaitsFor>
  void push_below(int from, const Entry& entry, const WaitsFor& waits_for) {
    int place = size_++;
    for (; place > from && waits_for(entry, entries_[std::size_t(place - 1)]); --place)
      entries_[std::size_t(place)] = entries_[std::size_t(place - 1)];
    entries_[std::size_t(place)] = entry;
  }

 private:
  std::array<Entry, 64> entries_;
  int size_ = 0;
};

}  // namespace supple
