// Holds the energy by which cloth that is curved at rest resists bending: 1/2 share |d_s - R_t c|^2, summed over
// squares s and the triangles t around them. d_s is a sum over vertices (a curvature times the root of a stiffness, see
// bending.h), c is d_s at rest as triangle t sees it, and R_t are the triangle's axes. Each term, and its force, is
// zero in every turned copy of the shape at rest. |R_t c| is constant, so that for c = 0 this is the constant quadratic
// energy of flat cloth, and the stiffness in A bounds it. Such axes make the hinges of Garg, Grinspun, Wardetzky, Zorin
// 2007, "Cubic shells", turn with the sheet. Folded hinges, whose angle jumps from pi to -pi, are no special case: no
// angle is used. Not here: which squares there are (bending.h).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/threads.h"
#include "base/types.h"

namespace supple {

struct RestCurvature {
  struct Term {
    std::int32_t vertex;
    double factor;  // [sqrt(N/m)]
  };
  // Says how a triangle turns a square.
  struct Turn {
    std::int32_t square;
    double share;                 // of the square's energy; those of all triangles add up to 1
    std::array<double, 3> place;  // c, d_s at rest along the triangle's axes [sqrt(J)]
  };
  struct Triangle {
    std::array<std::int32_t, 3> corner;
    double edge, twice_area;  // at rest: the length from corner 0 to corner 1 [m], and twice the area [m^2]
    std::int32_t first_turn = 0, turns = 0;
  };

  std::vector<std::int32_t> first_term;  // by square: where its terms begin; then the number of all terms
  std::vector<Term> terms;
  std::vector<Triangle> triangles;
  std::vector<Turn> turns;  // by triangle

  // These lists follow from those above (index()).
  std::vector<std::int32_t> first_of_square, of_square;  // the turns of each square
  std::vector<std::int32_t> first_of_vertex;             // n + 1: where a vertex' squares begin in `of_vertex`
  struct Use {
    std::int32_t square;
    double factor;
  };
  std::vector<Use> of_vertex;
  std::vector<std::int32_t> first_corner, corners;  // the corners of triangles at each vertex: 3 triangle + corner

  bool empty() const { return triangles.empty(); }
  int squares() const { return static_cast<int>(first_term.size()) - 1; }
  // Returns whether a vertex belongs to curved cloth; other cloth of the same model has rows of Q instead.
  bool holds(int vertex) const { return !empty() && first_corner[vertex] < first_corner[vertex + 1]; }
  // Makes the lists by square and vertex. vertices: n of the model.
  void index(int vertices);
};

// Holds what an evaluation finds, for curvature_slope().
struct CurvatureRoom {
  std::vector<double> square;  // d_s [sqrt(J)], then dE/dd_s by square, 3 numbers each
  std::vector<double> turned;  // share (d_s - R_t c) by turn, 3 numbers each
  std::vector<double> corner;  // dE/dx through the axes, by triangle and corner, 3 numbers each [N]
};

// Evaluates the energy at x, 3 numbers by vertex [m], and keeps in `room` what curvature_slope() needs. energy: by
// triangle [J].
void evaluate_curvature(const RestCurvature& curvature, Threads* threads, const double* x, CurvatureRoom& room,
                        std::vector<double>& energy);

// Finds dE/dx of a vertex after an evaluation [N].
void curvature_slope(const RestCurvature& curvature, const CurvatureRoom& room, int vertex, double (&slope)[3]);

// Holds a triangle's axes as columns: along its first edge, in its plane across this edge, and its normal. Triangles
// whose edge or area is below a tenth of that at rest have shorter axes, which end at 0 smoothly.
struct TriangleAxes {
  Vec3 edge, cross;                 // the first edge [m] and the cross product of the first two [m^2]
  double of_edge, of_normal;        // factors from these to the axes
  double edge_slope, normal_slope;  // derivatives of the factors by length, over length
  Vec3 along, across, normal;

  TriangleAxes(const RestCurvature::Triangle& triangle, const double* x);
};

}  // namespace supple
