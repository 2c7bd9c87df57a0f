// Tests how the clusters of a body's second level are spread over it.
#include "sim/coarse/clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "sim/model/element_view.h"
#include "support/contact_scene.h"

namespace supple {
namespace clusters_test {

using test::bar;
using test::Held;

constexpr double unreached = std::numeric_limits<double>::infinity();

bool is_clearly_less(double a, double b) { return a < b * (1 - 1e-9); }

struct Edge {
  std::int32_t from, to;
  double length;
};

std::vector<Edge> edges_of(const Model& model) {
  std::vector<Edge> edges;
  for_each_element(model, [&](const ElementView& element) {
    for (int a = 0; a < corners_of(element.kind); ++a) {
      for (int b = 0; b < corners_of(element.kind); ++b) {
        const std::int32_t from = element.corner[a], to = element.corner[b];
        if (a != b) edges.push_back({from, to, (model.rest.row(from) - model.rest.row(to)).norm()});
      }
    }
  });
  return edges;
}

// Returns the distances of all vertices from one, along edges: every edge is tried until none makes a way shorter.
std::vector<double> plain_distances(const Model& model, const std::vector<Edge>& edges, std::int32_t start) {
  std::vector<double> distance(std::size_t(model.vertices), unreached);
  distance[start] = 0;
  for (bool is_shorter = true; is_shorter;) {
    is_shorter = false;
    for (const Edge& edge : edges) {
      if (!(distance[edge.from] + edge.length < distance[edge.to])) continue;
      distance[edge.to] = distance[edge.from] + edge.length;
      is_shorter = true;
    }
  }
  return distance;
}

std::int32_t furthest(const std::vector<double>& distance) {
  std::int32_t found = 0;
  for (std::int32_t v = 1; v < std::ssize(distance); ++v) {
    if (is_clearly_less(distance[found], distance[v])) found = v;
  }
  return found;
}

// Finds the centres of a body of one part as make_clusters() does, but with all distances from all centres.
std::vector<std::int32_t> plain_centers(const Model& model, int count) {
  const std::vector<Edge> edges = edges_of(model);
  std::vector<double> from_any = plain_distances(model, edges, 0), nearest(std::size_t(model.vertices), unreached);
  std::replace(from_any.begin(), from_any.end(), unreached, -1.0);
  std::vector<std::int32_t> centers = {furthest(from_any)};
  while (true) {
    const std::vector<double> distance = plain_distances(model, edges, centers.back());
    for (std::size_t v = 0; v < nearest.size(); ++v) nearest[v] = std::min(nearest[v], distance[v]);
    if (std::ssize(centers) == count) break;
    centers.push_back(furthest(nearest));
  }
  for (int round = 0; round < 3; ++round) {
    std::vector<std::int32_t> owner(nearest.size(), -1);
    std::fill(nearest.begin(), nearest.end(), unreached);
    for (std::size_t c = 0; c < centers.size(); ++c) {
      const std::vector<double> distance = plain_distances(model, edges, centers[c]);
      for (std::size_t v = 0; v < nearest.size(); ++v) {
        if (!is_clearly_less(distance[v], nearest[v])) continue;
        nearest[v] = distance[v];
        owner[v] = static_cast<std::int32_t>(c);
      }
    }
    for (std::size_t c = 0; c < centers.size(); ++c) {
      Vec3 sum = Vec3::Zero();
      double mass = 0, best = unreached;
      for (int v = 0; v < model.vertices; ++v) {
        if (owner[v] != std::int32_t(c)) continue;
        sum += model.mass[v] * model.rest.row(v).transpose();
        mass += model.mass[v];
      }
      for (int v = 0; v < model.vertices; ++v) {
        const double away = (model.rest.row(v).transpose() - sum / mass).norm();
        if (owner[v] != std::int32_t(c) || !is_clearly_less(away, best)) continue;
        best = away;
        centers[c] = v;
      }
    }
  }
  return centers;
}

// Returns two cubes beside each other that are one body.
BodyDescription two_pieces() {
  BodyDescription body = test::cube(3);
  const Positions& rest = body.mesh.rest;
  const Tetrahedra& tets = body.mesh.tets;
  const Eigen::Index vertices = rest.rows(), count = tets.rows();
  Positions both(2 * vertices, 3);
  both << rest, (1.3 * rest).rowwise() + Eigen::RowVector3d(1, 0, 0);
  Tetrahedra all(2 * count, 4);
  all << tets, tets.array() + std::int32_t(vertices);
  body.mesh.rest = both;
  body.mesh.tets = all;
  body.mesh.regions.clear();
  return body;
}

TEST(Clusters, WeightsAddUpToOneAndCentresLieAlongABar) {
  const Model model = build_model(bar(Corotated{1e4, 3e4}, Held::hard_end, Precision::double_precision, 4));
  const Clusters clusters = make_clusters(model, {4});
  ASSERT_EQ(clusters.count(), 4);
  std::vector<double> along;
  for (const std::int32_t center : clusters.center) along.push_back(model.rest(center, 0));
  std::sort(along.begin(), along.end());
  for (std::size_t c = 1; c < along.size(); ++c) EXPECT_GT(along[c] - along[c - 1], 0.02);
  for (int v = 0; v < model.vertices; ++v) {
    double sum = 0;
    for (const double weight : clusters.weight[v]) {
      EXPECT_GE(weight, 0);
      sum += weight;
    }
    EXPECT_NEAR(sum, 1, 1e-14);
  }
}

TEST(Clusters, ABodyThatIsTurnedHasTheSame) {
  BodyDescription body = bar(Corotated{1e4, 3e4}, Held::nothing, Precision::double_precision, 3);
  const Clusters before = make_clusters(build_model(body), {5});
  body.mesh.rest *= Eigen::AngleAxisd(1, Vec3(3, 1, 2).normalized()).toRotationMatrix().transpose();
  EXPECT_EQ(make_clusters(build_model(body), {5}).center, before.center);
}

TEST(Clusters, CentresAreThoseOfAPlainSearch) {
  int number = 0;
  for (const BodyDescription& body :
       {bar(Corotated{1e4, 3e4}, Held::nothing, Precision::double_precision, 3),
        bar(Corotated{1e4, 3e4}, Held::hard_end, Precision::double_precision, 2), test::cube(5),
        test::sheet({0.4, 0.3}, {9, 7}, {test::all_membranes().front(), 0.01}), two_pieces()}) {
    const Model model = build_model(body);
    ASSERT_EQ(model.parts.size(), 1u);
    for (const int count : {1, 2, 5, 9})
      EXPECT_EQ(make_clusters(model, {count}).center, plain_centers(model, count)) << number << ", " << count;
    ++number;
  }
}

}  // namespace clusters_test
}  // namespace supple
