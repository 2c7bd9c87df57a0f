#include "geometry/triangles/triangle_tree.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <thread>
#include <utility>

#include "base/threads.h"

namespace supple {
namespace {

double half_area(const Bounds& box) {
  const Vec3 e = box.extent();
  return e.x() * e.y() + e.y() * e.z() + e.z() * e.x();
}

// Builds a tree, and parts of it at the same time: each node has its place in the list before it is made, because all
// subtrees of equally many triangles have equally many nodes.
class TreeBuilder {
 public:
  TreeBuilder(const TriMesh& mesh, TreeCut cut) : mesh_(mesh), cut_(cut), keys_(std::size_t(mesh.triangles.rows())) {
    measured_.reserve(keys_.size());
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
      const Vec3 a = corner_of(t, 0), b = corner_of(t, 1), c = corner_of(t, 2);
      Measured& own = measured_.emplace_back();
      own.centroid = (a + b + c) / 3;
      own.area = 0.5 * (b - a).cross(c - a);
      own.size = own.area.norm();
      for (const Vec3& corner : {a, b, c}) own.box.include(corner);
    }
  }

  TriangleTree run() {
    const auto all = std::int32_t(keys_.size());
    tree_.order.resize(keys_.size());
    std::iota(tree_.order.begin(), tree_.order.end(), 0);
    tree_.nodes.resize(std::size_t(nodes_of(all)));
    constexpr std::int32_t worth_threads = 50000;  // triangles
    std::vector<Part> waiting;
    add({0, 0, all}, all > worth_threads ? all / 8 : all, waiting);
    Threads threads(waiting.size() > 1 ? int(std::max(1u, std::thread::hardware_concurrency())) : 1);
    threads.run(int(waiting.size()), [&](int p) {
      std::vector<Part> none;
      add(waiting[std::size_t(p)], 0, none);
    });
    // The largest parts are summed again, in the final order of their triangles. Another order would give other last
    // bits, on which the side of a place can depend where parts of a surface touch.
    if (cut_ == TreeCut::smallest_boxes) {
      const TriangleTree::Parts parts = tree_.four_parts(0);
      for (int k = 0; k < parts.count; ++k) summarise(tree_.nodes[std::size_t(parts.node[std::size_t(k)])]);
    }
    return std::move(tree_);
  }

 private:
  using Node = TriangleTree::Node;

  struct Measured {  // a triangle
    Vec3 centroid;   // [m]
    Vec3 area;       // its vector [m^2]
    double size;     // the vector's length [m^2]
    Bounds box;      // [m]
  };

  // Says which triangles of the order make the subtree of a node.
  struct Part {
    std::int32_t node, first, count;
  };

  Vec3 corner_of(Eigen::Index triangle, int k) const { return mesh_.points.row(mesh_.triangles(triangle, k)); }

  // Returns how many of some triangles go to the first half.
  std::int32_t middle_of(std::int32_t count) const {
    constexpr std::int32_t leaf = TriangleTree::leaf_size;
    return cut_ == TreeCut::longest_side ? count / 2 : (count / 2 + leaf - 1) / leaf * leaf;
  }

  std::int32_t nodes_of(std::int32_t count) const {
    if (count <= TriangleTree::leaf_size) return 1;
    return 1 + nodes_of(middle_of(count)) + nodes_of(count - middle_of(count));
  }

  // Adds the nodes of a part, but leaves parts of at most `small` triangles in `waiting`.
  void add(const Part& part, std::int32_t small, std::vector<Part>& waiting) {
    if (part.count <= small) return waiting.push_back(part);
    Node& node = tree_.nodes[std::size_t(part.node)];
    node.first = part.first;
    node.count = part.count;
    summarise(node);
    if (part.count <= TriangleTree::leaf_size) return;
    divide(node);
    const Part one{part.node + 1, part.first, middle_of(part.count)};
    const Part other{one.node + nodes_of(one.count), one.first + one.count, part.count - one.count};
    node.other = other.node;
    add(one, small, waiting);
    add(other, small, waiting);
  }

  void divide(const Node& node) {
    int best = 0;
    if (cut_ == TreeCut::longest_side) {
      node.box.extent().maxCoeff(&best);
      return divide(node, best);
    }
    const std::span<const std::int32_t> part = tree_.triangles_of(node);
    const auto middle = std::size_t(middle_of(node.count));
    double least = infinity;
    for (int axis = 0; axis < 3; ++axis) {
      divide(node, axis);
      const double sum = half_area(box_of(part.first(middle))) + half_area(box_of(part.subspan(middle)));
      if (sum < least) {
        least = sum;
        best = axis;
      }
    }
    divide(node, best);
  }

  // Puts the triangles whose centroids are lower along an axis first. The keys lie next to each other, which takes less
  // time than to look up each.
  void divide(const Node& node, int axis) {
    const std::span part(tree_.order.data() + node.first, std::size_t(node.count));
    const std::span keys(keys_.data() + node.first, part.size());
    for (std::size_t i = 0; i < part.size(); ++i) keys[i] = {measured_[std::size_t(part[i])].centroid[axis], part[i]};
    std::nth_element(keys.begin(), keys.begin() + middle_of(node.count), keys.end());
    for (std::size_t i = 0; i < part.size(); ++i) part[i] = keys[i].second;
  }

  Bounds box_of(std::span<const std::int32_t> part) const {
    Bounds box;
    for (const std::int32_t t : part) {
      const Bounds& own = measured_[std::size_t(t)].box;
      box.lower = box.lower.cwiseMin(own.lower);
      box.upper = box.upper.cwiseMax(own.upper);
    }
    return box;
  }

  // Sets the node's box and its sums, in the present order of its triangles.
  void summarise(Node& node) {
    const std::span<const std::int32_t> part = tree_.triangles_of(node);
    node.box = box_of(part);
    Vec3 sum = Vec3::Zero();
    double weight = 0;
    node.area.setZero();
    for (const std::int32_t t : part) {
      const Measured& own = measured_[std::size_t(t)];
      node.area += own.area;
      sum += own.size * own.centroid;
      weight += own.size;
    }
    node.center = weight > 0 ? Vec3(sum / weight) : node.box.center();
    node.moment.setZero();
    double squared = 0;
    for (const std::int32_t t : part) {
      const Measured& own = measured_[std::size_t(t)];
      node.moment += (own.centroid - node.center) * own.area.transpose();
      for (int k = 0; k < 3; ++k) squared = std::max(squared, (corner_of(t, k) - node.center).squaredNorm());
    }
    node.radius = std::sqrt(squared);
  }

  const TriMesh& mesh_;
  const TreeCut cut_;
  TriangleTree tree_;
  std::vector<std::pair<double, std::int32_t>> keys_;  // scratch
  std::vector<Measured> measured_;
};

}  // namespace

TriangleTree::Parts TriangleTree::four_parts(std::int32_t node) const {
  Parts parts{{node}, 1};
  const auto count_of = [&](std::int32_t part) { return nodes[std::size_t(part)].count; };
  while (parts.count < std::ssize(parts.node)) {
    std::int32_t& largest =
        *std::max_element(parts.node.begin(), parts.node.begin() + parts.count,
                          [&](std::int32_t l, std::int32_t r) { return count_of(l) < count_of(r); });
    const Node& whole = nodes[std::size_t(largest)];
    if (whole.is_leaf()) break;
    parts.node[std::size_t(parts.count++)] = whole.other;
    ++largest;
  }
  return parts;
}

TriangleTree triangle_tree(const TriMesh& mesh, TreeCut cut) { return TreeBuilder(mesh, cut).run(); }

}  // namespace supple
