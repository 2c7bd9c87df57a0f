// Tests that a tree of triangles has each of them once, and that its nodes know what lies below them.
#include "geometry/triangles/triangle_tree.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "support/surfaces.h"

namespace supple {
namespace triangle_tree_test {

using Node = TriangleTree::Node;

void check_node(const TriangleTree& tree, const TriMesh& mesh, const Node& node) {
  Bounds box;
  Vec3 area = Vec3::Zero();
  double radius = 0;
  for (const std::int32_t t : tree.triangles_of(node)) {
    const auto corner = [&](int k) -> Vec3 { return mesh.points.row(mesh.triangles(t, k)); };
    area += 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (int k = 0; k < 3; ++k) {
      box.include(corner(k));
      radius = std::max(radius, (corner(k) - node.center).norm());
    }
  }
  EXPECT_EQ(node.box.lower, box.lower);
  EXPECT_EQ(node.box.upper, box.upper);
  EXPECT_NEAR((node.area - area).norm(), 0, 1e-12);
  EXPECT_NEAR(node.radius, radius, 1e-12);
  EXPECT_EQ(node.is_leaf(), node.count <= TriangleTree::leaf_size);
}

// The larger surface is one that several threads share.
TEST(TriangleTree, HasEachTriangleInOneLeafAndKnowsWhatLiesBelowEachNode) {
  for (const TriMesh& mesh :
       {test::box_surface(Vec3(1, 2, 3)), test::torus_surface(1, 0.4, 31, 15), test::sphere_surface(1, 240, 120)}) {
    for (const TreeCut cut : {TreeCut::longest_side, TreeCut::smallest_boxes}) {
      const TriangleTree tree = triangle_tree(mesh, cut);
      std::vector<std::int32_t> sorted = tree.order, all(std::size_t(mesh.triangles.rows()));
      std::sort(sorted.begin(), sorted.end());
      std::iota(all.begin(), all.end(), 0);
      EXPECT_EQ(sorted, all);
      EXPECT_EQ(tree.nodes[0].count, std::ssize(all));
      for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
        const Node& node = tree.nodes[n];
        check_node(tree, mesh, node);
        if (node.is_leaf()) continue;
        const Node& one = tree.nodes[n + 1];
        const Node& other = tree.nodes[std::size_t(node.other)];
        EXPECT_EQ(one.first, node.first);
        EXPECT_EQ(other.first, node.first + one.count);
        EXPECT_EQ(one.count + other.count, node.count);
      }
    }
  }
}

TEST(TriangleTree, CutIntoSmallestBoxesHasAllLeavesFullButTheLast) {
  const TriMesh mesh = test::torus_surface(1, 0.4, 31, 15);
  const TriangleTree tree = triangle_tree(mesh, TreeCut::smallest_boxes);
  const auto all = std::int32_t(mesh.triangles.rows());
  ASSERT_NE(all % TriangleTree::leaf_size, 0);
  for (const Node& node : tree.nodes) {
    if (!node.is_leaf()) continue;
    EXPECT_EQ(node.first % TriangleTree::leaf_size, 0);
    EXPECT_EQ(node.count, std::min(TriangleTree::leaf_size, all - node.first));
  }
}

TEST(TriangleTree, FourPartsTogetherHaveTheTrianglesOfTheirNode) {
  const TriangleTree tree = triangle_tree(test::torus_surface(1, 0.4, 31, 15), TreeCut::smallest_boxes);
  for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
    const TriangleTree::Parts parts = tree.four_parts(std::int32_t(n));
    std::int32_t count = 0;
    bool are_leaves = true;
    for (int k = 0; k < parts.count; ++k) {
      const Node& part = tree.nodes[std::size_t(parts.node[std::size_t(k)])];
      EXPECT_GE(part.first, tree.nodes[n].first);
      count += part.count;
      are_leaves &= part.is_leaf();
    }
    EXPECT_EQ(count, tree.nodes[n].count);
    EXPECT_TRUE(parts.count == 4 || are_leaves);
  }
}

TEST(TriangleTree, AStackKeepsWhatWaitsLongestLowest) {
  TreeStack<int> stack(5);
  const auto waits_for = [](int entry, int other) { return entry > other; };
  for (const int entry : {2, 9, 1, 9}) stack.push_below(1, entry, waits_for);
  std::vector<int> popped;
  while (!stack.empty()) popped.push_back(stack.pop());
  EXPECT_EQ(popped, (std::vector<int>{1, 2, 9, 9, 5}));
}

}  // namespace triangle_tree_test
}  // namespace supple
