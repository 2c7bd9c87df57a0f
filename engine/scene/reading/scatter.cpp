#include "scene/reading/scatter.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "scene/definition/rotation.h"
#include "scene/definition/start_state.h"

namespace supple {
namespace {

constexpr int most_copies = 300;  // of one table

Vec3 point_in(const std::vector<Vec3>& box, UniformNumbers& numbers) {
  Vec3 point;
  for (int i = 0; i < 3; ++i) point[i] = numbers.between(box[0][i], box[1][i]);
  return point;
}

// Spreads points over a box: each new one is the furthest of several random ones from those that are there (Mitchell
// 1991, "Spectrally optimal sampling for distribution ray tracing").
std::vector<Vec3> spread_points(const std::vector<Vec3>& box, int count, UniformNumbers& numbers) {
  constexpr int candidates = 40;
  std::vector<Vec3> points;
  for (int n = 0; n < count; ++n) {
    Vec3 best = box[0];
    double furthest = -1;
    for (int c = 0; c < candidates; ++c) {
      const Vec3 point = point_in(box, numbers);
      double nearest = std::numeric_limits<double>::infinity();
      for (const Vec3& other : points) nearest = std::min(nearest, (point - other).squaredNorm());
      if (nearest <= furthest) continue;
      furthest = nearest;
      best = point;
    }
    points.push_back(best);
  }
  return points;
}

// Returns a random turn; all turns are equally likely (Shoemake 1992, "Uniform random rotations").
Eigen::Quaterniond any_turn(UniformNumbers& numbers) {
  const double share = numbers.between(0, 1);
  const double a = numbers.between(0, 2 * std::numbers::pi), b = numbers.between(0, 2 * std::numbers::pi);
  return {std::sqrt(share) * std::cos(b), std::sqrt(1 - share) * std::sin(a), std::sqrt(1 - share) * std::cos(a),
          std::sqrt(share) * std::sin(b)};
}

Eigen::Quaterniond turn_of_copy(ScatterTurn rule, UniformNumbers& numbers) {
  if (rule == ScatterTurn::any) return any_turn(numbers);
  if (rule == ScatterTurn::none) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(numbers.between(0, 2 * std::numbers::pi), Vec3::UnitY()));
}

std::vector<std::string> read_names(const ConfigTable& table) {
  if (!table.has("bodies")) table.complain("'bodies' is missing: such as bodies = [\"hippo\", \"bunny\"]");
  return table.required_texts({"bodies", "", "names of the bodies whose copies it makes, in turn"}, "names of bodies");
}

Scattering read_scattering(const ConfigTable& table, std::uint64_t scene_seed) {
  Scattering result;
  result.bodies = read_names(table);
  const int count = table.integer({"count", "", "copies in all"}, std::nullopt, Range::between(1, most_copies));
  std::vector<Vec3> box = table.vectors(
      {"box", "m", "lower and upper corner of the space for the copies' positions, which are spread over it"}, 2);
  if (box.size() == 2 && (box[0].array() > box[1].array()).any())
    table.complain("box", "box: the first corner must be the lower one");
  const auto rule = table.word<ScatterTurn>(
      {"turn", "", "random turns, after the body's own: about the vertical, any, or none"}, ScatterTurn::heading);
  const auto given = table.word_or_pair({"sizes", "", "same, or the least and the largest factor of the bodies' size"},
                                        "same", {{"same"}}, Range::above(0, 1000));
  const auto* factors = std::get_if<Eigen::Vector2d>(&given);
  const Eigen::Vector2d sizes = factors != nullptr ? *factors : Eigen::Vector2d(1, 1);
  if (sizes[0] > sizes[1]) table.complain("sizes", "sizes: the first number must be the smaller one");
  const auto seed = static_cast<std::uint64_t>(
      table.integer({"seed", "", "of places, turns and sizes, beside the scene's"}, 1, Range::between(0, 2e9)));
  if (result.bodies.empty() || box.size() != 2) return result;
  UniformNumbers numbers(seed * 0x9e3779b97f4a7c15ull + scene_seed);
  const std::vector<Vec3> points = spread_points(box, count, numbers);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Quaterniond turn = turn_of_copy(rule, numbers);
    result.copies.push_back(
        {result.bodies[i % result.bodies.size()], points[i], turn, numbers.between(sizes[0], sizes[1])});
  }
  return result;
}

BodyDef copy_of(const BodyDef& body, const ScatteredCopy& copy, int number) {
  BodyDef result = body;
  result.name = fmt::format("{}_{}", body.name, number);
  // A caption for each of many copies would cover the picture.
  if (body.label == body.name) result.label.clear();
  result.position = copy.position;
  const Eigen::Quaterniond turn = copy.turn * rotation_from_degrees(body.turn_deg);
  const Vec3 angles = turn.toRotationMatrix().eulerAngles(2, 1, 0);
  result.turn_deg = Vec3(angles[2], angles[1], angles[0]) * (180 / std::numbers::pi);
  if (result.size) {
    *result.size *= copy.size;
  } else {
    result.scale *= copy.size;
  }
  return result;
}

}  // namespace

std::vector<Scattering> read_scatterings(const ConfigTable& root, std::uint64_t seed) {
  std::vector<Scattering> scatterings;
  for (const ConfigTable& table : root.tables({"scatter", "", "copies of bodies at random places"}))
    scatterings.push_back(read_scattering(table, seed));
  return scatterings;
}

std::vector<BodyDef> copies_of(const std::vector<Scattering>& scatterings, const ConfigTable& table, BodyDef body) {
  const auto has_body = [&](const Scattering& s) { return std::ranges::count(s.bodies, body.name) > 0; };
  if (std::ranges::none_of(scatterings, has_body)) return {std::move(body)};
  if (table.has("position"))
    table.complain("position",
                   fmt::format("position: '{}' is scattered, and its copies have places of their own", body.name));
  std::vector<BodyDef> copies;
  for (const Scattering& scattering : scatterings) {
    for (const ScatteredCopy& copy : scattering.copies) {
      if (copy.body == body.name) copies.push_back(copy_of(body, copy, static_cast<int>(copies.size()) + 1));
    }
  }
  return copies;
}

void check_scattered(const ConfigTable& root, const std::vector<Scattering>& scatterings,
                     const std::vector<std::string>& names) {
  const std::vector<ConfigTable> tables = root.tables({"scatter", "", "copies of bodies at random places"});
  for (std::size_t i = 0; i < tables.size(); ++i) {
    for (const std::string& name : scatterings[i].bodies) {
      if (std::ranges::count(names, name) == 0)
        tables[i].complain("bodies", fmt::format("bodies: no body is called '{}'{}", name, did_you_mean(name, names)));
    }
  }
}

}  // namespace supple
