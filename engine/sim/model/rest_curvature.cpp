#include "sim/model/rest_curvature.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace supple {
namespace {

constexpr int squares_a_chunk = 2048, triangles_a_chunk = 512;

int chunks_of(std::size_t count, int size) { return (static_cast<int>(count) + size - 1) / size; }

Vec3 vector_at(const double* x, std::int32_t i) { return {x[3 * i], x[3 * i + 1], x[3 * i + 2]}; }

void set_vector(std::vector<double>& list, std::size_t i, const Vec3& v) {
  for (int c = 0; c < 3; ++c) list[3 * i + c] = v[c];
}

// Returns the factor that makes a vector a unit vector, and the factor's derivative by the vector's length, over this
// length. squared: the squared length. Below a tenth of the length at rest the factor is a polynomial in the squared
// length that has the same value and two derivatives there.
std::array<double, 2> unit_factor(double squared, double at_rest) {
  const double least = 0.1 * at_rest, ratio = squared / (least * least);
  if (ratio >= 1) {
    const double inverse = 1 / std::sqrt(squared);
    return {inverse, -inverse / squared};
  }
  return {(15.0 / 8 - 10.0 / 8 * ratio + 3.0 / 8 * ratio * ratio) / least,
          (-20.0 / 8 + 12.0 / 8 * ratio) / (least * least * least)};
}

// Sets d_s of a square, summed up from differences, so that the result does not depend on where the cloth is.
void set_square(const RestCurvature& curvature, const double* x, int s, std::vector<double>& square) {
  const std::int32_t begin = curvature.first_term[s], end = curvature.first_term[s + 1];
  const double* first = x + 3 * std::size_t(curvature.terms[begin].vertex);
  double sum[3] = {0, 0, 0};
  for (std::int32_t k = begin + 1; k < end; ++k) {
    const double* other = x + 3 * std::size_t(curvature.terms[k].vertex);
    for (int c = 0; c < 3; ++c) sum[c] += curvature.terms[k].factor * (other[c] - first[c]);
  }
  for (int c = 0; c < 3; ++c) square[3 * std::size_t(s) + c] = sum[c];
}

// Returns the energy of the squares that a triangle turns, and sets what follows from its axes.
double evaluate_triangle(const RestCurvature& curvature, const double* x, std::size_t t, CurvatureRoom& room) {
  const RestCurvature::Triangle& triangle = curvature.triangles[t];
  const TriangleAxes axes(triangle, x);
  Vec3 along = Vec3::Zero(), normal = Vec3::Zero();  // dE by these two axes; the third one is their product
  double energy = 0;
  for (std::int32_t k = triangle.first_turn; k < triangle.first_turn + triangle.turns; ++k) {
    const RestCurvature::Turn& turn = curvature.turns[k];
    const auto& c = turn.place;
    const Vec3 apart =
        vector_at(room.square.data(), turn.square) - c[0] * axes.along - c[1] * axes.across - c[2] * axes.normal;
    const Vec3 pull = turn.share * apart;
    energy += 0.5 * pull.dot(apart);
    set_vector(room.turned, k, pull);
    along -= c[0] * pull + c[1] * pull.cross(axes.normal);
    normal -= c[2] * pull + c[1] * axes.along.cross(pull);
  }
  const auto through = [](const Vec3& slope, const Vec3& v, double factor, double by_length) -> Vec3 {
    return factor * slope + by_length * v.dot(slope) * v;
  };
  const Vec3 of_edge = through(along, axes.edge, axes.of_edge, axes.edge_slope);
  const Vec3 of_cross = through(normal, axes.cross, axes.of_normal, axes.normal_slope);
  const Vec3 second = vector_at(x, triangle.corner[2]) - vector_at(x, triangle.corner[0]);
  const Vec3 at_first = of_edge + second.cross(of_cross), at_second = of_cross.cross(axes.edge);
  set_vector(room.corner, 3 * t, -at_first - at_second);
  set_vector(room.corner, 3 * t + 1, at_first);
  set_vector(room.corner, 3 * t + 2, at_second);
  return energy;
}

// Sorts numbers 0, 1, ... by key: those with key k are list[first[k] .. first[k + 1]), in ascending order.
template <class Key>
void sort_by(int keys, std::size_t count, const Key& key, std::vector<std::int32_t>& first,
             std::vector<std::int32_t>& list) {
  first.assign(std::size_t(keys) + 1, 0);
  for (std::size_t i = 0; i < count; ++i) ++first[std::size_t(key(i)) + 1];
  for (int k = 0; k < keys; ++k) first[std::size_t(k) + 1] += first[std::size_t(k)];
  list.resize(count);
  std::vector<std::int32_t> next(first.begin(), first.end() - 1);
  for (std::size_t i = 0; i < count; ++i) list[std::size_t(next[std::size_t(key(i))]++)] = static_cast<std::int32_t>(i);
}

}  // namespace

TriangleAxes::TriangleAxes(const RestCurvature::Triangle& triangle, const double* x) {
  const Vec3 origin = vector_at(x, triangle.corner[0]);
  edge = vector_at(x, triangle.corner[1]) - origin;
  cross = edge.cross(vector_at(x, triangle.corner[2]) - origin);
  const auto [edge_factor, edge_change] = unit_factor(edge.squaredNorm(), triangle.edge);
  const auto [normal_factor, normal_change] = unit_factor(cross.squaredNorm(), triangle.twice_area);
  of_edge = edge_factor;
  edge_slope = edge_change;
  of_normal = normal_factor;
  normal_slope = normal_change;
  along = of_edge * edge;
  normal = of_normal * cross;
  across = normal.cross(along);
}

void RestCurvature::index(int vertices) {
  sort_by(
      squares(), turns.size(), [&](std::size_t k) { return turns[k].square; }, first_of_square, of_square);
  std::vector<std::int32_t> square_of(terms.size()), order;
  for (int s = 0; s < squares(); ++s)
    std::fill(square_of.begin() + first_term[s], square_of.begin() + first_term[s + 1], s);
  sort_by(
      vertices, terms.size(), [&](std::size_t k) { return terms[k].vertex; }, first_of_vertex, order);
  of_vertex.clear();
  for (const std::int32_t k : order) of_vertex.push_back({square_of[k], terms[k].factor});
  sort_by(
      vertices, 3 * triangles.size(), [&](std::size_t k) { return triangles[k / 3].corner[k % 3]; }, first_corner,
      corners);
}

void evaluate_curvature(const RestCurvature& curvature, Threads* threads, const double* x, CurvatureRoom& room,
                        std::vector<double>& energy) {
  const std::size_t squares = curvature.first_term.size() - 1, triangles = curvature.triangles.size();
  room.square.resize(3 * squares);
  room.turned.resize(3 * curvature.turns.size());
  room.corner.resize(9 * triangles);
  energy.resize(triangles);
  const auto each = [&](std::size_t count, int size, const auto& body) {
    run_chunks(threads, chunks_of(count, size), long(count) * 20, [&](int c) {
      const std::size_t first = std::size_t(c) * std::size_t(size), end = std::min(count, first + std::size_t(size));
      for (std::size_t i = first; i < end; ++i) body(i);
    });
  };
  each(squares, squares_a_chunk, [&](std::size_t s) { set_square(curvature, x, static_cast<int>(s), room.square); });
  each(triangles, triangles_a_chunk, [&](std::size_t t) { energy[t] = evaluate_triangle(curvature, x, t, room); });
  each(squares, squares_a_chunk, [&](std::size_t s) {
    double sum[3] = {0, 0, 0};
    for (std::int32_t k = curvature.first_of_square[s]; k < curvature.first_of_square[s + 1]; ++k) {
      for (int c = 0; c < 3; ++c) sum[c] += room.turned[3 * std::size_t(curvature.of_square[k]) + c];
    }
    for (int c = 0; c < 3; ++c) room.square[3 * s + c] = sum[c];
  });
}

void curvature_slope(const RestCurvature& curvature, const CurvatureRoom& room, int vertex, double (&slope)[3]) {
  double sum[3] = {0, 0, 0};
  for (std::int32_t k = curvature.first_of_vertex[vertex]; k < curvature.first_of_vertex[vertex + 1]; ++k) {
    const auto& [square, factor] = curvature.of_vertex[k];
    for (int c = 0; c < 3; ++c) sum[c] += factor * room.square[3 * std::size_t(square) + c];
  }
  for (std::int32_t k = curvature.first_corner[vertex]; k < curvature.first_corner[vertex + 1]; ++k) {
    for (int c = 0; c < 3; ++c) sum[c] += room.corner[3 * std::size_t(curvature.corners[k]) + c];
  }
  for (int c = 0; c < 3; ++c) slope[c] = sum[c];
}

}  // namespace supple
