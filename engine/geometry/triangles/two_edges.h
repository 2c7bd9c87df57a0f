// Describes two edges at one time, and finds when they pass through each other while their ends move evenly: when the
// volume of the tetrahedron of their ends changes its sign and they meet (Provot 1997, "Collision and self-collision
// handling in cloth model dedicated to design garments", has the condition). The signs are compared after each eighth
// of the way.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>

#include "base/types.h"

namespace supple {

using EdgeEnds = std::array<std::int32_t, 2>;  // two vertices

struct TwoEdges {
  Vec3 from, other_from;  // where they begin [m]
  Vec3 way, other_way;    // to where they end [m]
  Vec3 across;            // the cross product of both ways [m^2]
  double volume;          // six times the signed volume of the tetrahedron of their ends [m^3]

  TwoEdges(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d)
      : from(a), other_from(c), way(b - a), other_way(d - c), across(way.cross(other_way)) {
    volume = (from - other_from).dot(across);
  }
  // x: n x 3 [m].
  TwoEdges(const EdgeEnds& one, const EdgeEnds& other, const Positions& x)
      : TwoEdges(x.row(one[0]), x.row(one[1]), x.row(other[0]), x.row(other[1])) {}

  // Tells whether their lines are far from parallel, and so have closest places.
  bool are_lines() const {
    constexpr double least_sine = 0.05;
    return across.squaredNorm() > least_sine * least_sine * way.squaredNorm() * other_way.squaredNorm();
  }
  // Tells whether the lines are nearer to each other than this [m].
  bool are_nearer(double distance) const { return volume * volume < distance * distance * across.squaredNorm(); }
  // Returns the share of the one edge, or of the other one, at which their lines are closest.
  double share() const { return (other_from - from).cross(other_way).dot(across) / across.squaredNorm(); }
  double other_share() const { return (other_from - from).cross(way).dot(across) / across.squaredNorm(); }
  // Tells whether both places are on the edges, or beyond their ends by at most this share of their lengths. Edges that
  // are nearly parallel do not meet.
  bool meet(double beyond) const {
    if (!are_lines()) return false;
    const double s = share(), t = other_share(), end = 1 + beyond;
    return s >= -beyond && s <= end && t >= -beyond && t <= end;
  }
};

// Returns two edges at a share of the way from q to x, both n x 3 [m].
TwoEdges edges_at_share(const EdgeEnds& one, const EdgeEnds& other, const Positions& q, const Positions& x,
                        double share);

// Returns the first share of the way from q to x at which two edges pass through each other. The volume is a cubic
// function of the share; two roots in one eighth of the way are not found.
std::optional<double> edge_passage(const EdgeEnds& one, const EdgeEnds& other, const Positions& q, const Positions& x);

}  // namespace supple
