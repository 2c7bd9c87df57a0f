// Sums the winding numbers of a soup of triangles for many places at once: the tree is walked once for all of them, and
// the loops over their lanes become vector instructions.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "geometry/triangles/triangle_soup.h"

namespace supple {
namespace {

constexpr int lanes = 8;  // of a group
constexpr int groups = 8;
constexpr double pi = std::numbers::pi;
constexpr double far = 2.5;  // a part counts as far beyond this many of its radii: section 3.2 of the paper has 2

using Lanes = std::array<double, lanes>;

// Computes the angle of (x, y), from -pi to pi and 0 for (0, 0). The angle is halved three times: tan(a / 2) is
// tan(a) / (1 + sqrt(1 + tan(a)^2)). What is left is below 0.2, where eleven terms of the arcus tangent's series have
// an error below round-off.
inline double angle_of(double y, double x) {
  const double ax = std::abs(x), ay = std::abs(y), larger = std::max(ax, ay), unit = larger > 0 ? larger : 1;
  const double u = ax / unit, v = ay / unit, whole = std::sqrt(u * u + v * v) + u;
  double t = v / (whole > 0 ? whole : 1);
  t = t / (1 + std::sqrt(1 + t * t));
  t = t / (1 + std::sqrt(1 + t * t));
  const double z = t * t;
  double series = 1.0 / 21;
  series = 1.0 / 19 - z * series;
  series = 1.0 / 17 - z * series;
  series = 1.0 / 15 - z * series;
  series = 1.0 / 13 - z * series;
  series = 1.0 / 11 - z * series;
  series = 1.0 / 9 - z * series;
  series = 1.0 / 7 - z * series;
  series = 1.0 / 5 - z * series;
  series = 1.0 / 3 - z * series;
  series = 1.0 - z * series;
  // Where x is negative, the angle is pi minus this one.
  return std::copysign((x < 0 ? pi : 0) + (x < 0 ? -8 : 8) * (t * series), y);
}

}  // namespace

// Holds up to 64 places and their sums.
struct TriangleSoup::Packet {
  std::array<Lanes, groups> x{}, y{}, z{}, sum{};

  // Adds the expansion of a part to the places from which it is far away: with the gradient of the dipoles' field,
  // which is I / d^3 - 3 d d' / d^5, equation 15 of the paper. Returns the active lanes of the other places.
  std::uint8_t add_far(std::size_t g, const TriangleTree::Node& node, std::uint8_t active) {
    const Mat3& m = node.moment;
    const double trace = m.trace(), reach = far * node.radius, reach2 = reach * reach;
    Lanes term, near;
    for (std::size_t k = 0; k < lanes; ++k) {
      const double dx = node.center.x() - x[g][k], dy = node.center.y() - y[g][k], dz = node.center.z() - z[g][k];
      const double squared = dx * dx + (dy * dy + dz * dz);
      const double first = node.area.x() * dx + (node.area.y() * dy + node.area.z() * dz) + trace;
      const double mx = m(0, 0) * dx + (m(0, 1) * dy + m(0, 2) * dz), my = m(1, 0) * dx + (m(1, 1) * dy + m(1, 2) * dz),
                   mz = m(2, 0) * dx + (m(2, 1) * dy + m(2, 2) * dz);
      const double second = dx * mx + (dy * my + dz * mz);
      const bool is_far = squared > reach2;
      const double safe = is_far ? squared : 1;
      term[k] = (first - 3 * second / safe) / (safe * std::sqrt(safe) * (4 * pi));
      near[k] = is_far ? 0 : 1;
    }
    std::uint8_t left = 0;
    for (std::size_t k = 0; k < lanes; ++k) {
      const bool on = (active >> k & 1) != 0, is_near = near[k] != 0;
      sum[g][k] += on && !is_near ? term[k] : 0;
      left |= std::uint8_t(int(on && is_near) << k);
    }
    return left;
  }

  // Adds a triangle's signed solid angle over 4 pi: Van Oosterom and Strackee, The solid angle of a plane triangle,
  // 1983, equation 8.
  void add_triangle(std::size_t g, const Vec3& pa, const Vec3& pb, const Vec3& pc, std::uint8_t active) {
    Lanes term;
    for (std::size_t k = 0; k < lanes; ++k) {
      const double ax = pa.x() - x[g][k], ay = pa.y() - y[g][k], az = pa.z() - z[g][k];
      const double bx = pb.x() - x[g][k], by = pb.y() - y[g][k], bz = pb.z() - z[g][k];
      const double cx = pc.x() - x[g][k], cy = pc.y() - y[g][k], cz = pc.z() - z[g][k];
      const double la = std::sqrt(ax * ax + (ay * ay + az * az)), lb = std::sqrt(bx * bx + (by * by + bz * bz)),
                   lc = std::sqrt(cx * cx + (cy * cy + cz * cz));
      const double up = ax * (by * cz - bz * cy) + (ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx));
      const double over = la * lb * lc + (ax * bx + (ay * by + az * bz)) * lc + (bx * cx + (by * cy + bz * cz)) * la +
                          (cx * ax + (cy * ay + cz * az)) * lb;
      term[k] = angle_of(up, over) / (2 * pi);
    }
    for (std::size_t k = 0; k < lanes; ++k) sum[g][k] += (active >> k & 1) != 0 ? term[k] : 0;
  }
};

void TriangleSoup::winding_numbers(const std::vector<Vec3>& places, std::vector<double>& result) const {
  constexpr std::size_t size = groups * lanes;
  result.resize(places.size());
  for (std::size_t begin = 0; begin < places.size(); begin += size) {
    const std::size_t count = std::min(size, places.size() - begin);
    Packet packet;
    for (std::size_t i = 0; i < size; ++i) {
      const Vec3& p = places[begin + std::min(i, count - 1)];
      packet.x[i / lanes][i % lanes] = p.x();
      packet.y[i / lanes][i % lanes] = p.y();
      packet.z[i / lanes][i % lanes] = p.z();
    }
    struct Entry {
      std::int32_t node;
      std::array<std::uint8_t, groups> active;  // lanes
    };
    Entry root{0, {}};
    for (std::size_t g = 0; g < groups; ++g) root.active[g] = g * lanes < count ? 0xff : 0;
    TreeStack<Entry> stack(root);
    while (!stack.empty()) {
      const Entry entry = stack.pop();
      const TriangleTree::Node& node = tree_.nodes[std::size_t(entry.node)];
      std::array<std::uint8_t, groups> near{};
      bool any = false;
      for (std::size_t g = 0; g < groups; ++g) {
        if (entry.active[g] != 0) near[g] = packet.add_far(g, node, entry.active[g]);
        any |= near[g] != 0;
      }
      if (!any) continue;
      if (!node.is_leaf()) {
        stack.push({node.other, near});
        stack.push({entry.node + 1, near});
        continue;
      }
      for (const std::int32_t t : tree_.triangles_of(node)) {
        const Vec3 a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
        for (std::size_t g = 0; g < groups; ++g)
          if (near[g] != 0) packet.add_triangle(g, a, b, c, near[g]);
      }
    }
    for (std::size_t i = 0; i < count; ++i) result[begin + i] = packet.sum[i / lanes][i % lanes];
  }
}

double TriangleSoup::winding_number(const Vec3& p) const {
  std::vector<double> result;
  winding_numbers({p}, result);
  return result.front();
}

}  // namespace supple
