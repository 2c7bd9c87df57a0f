#include "app/bench/meeting_cases.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string_view>

#include "app/bench/sections.h"

namespace supple {
namespace {

constexpr double edge = 0.2;                     // of the cubes [m]
constexpr double frame_rate = 30;                // [1/s]
constexpr int inner_cells = 3, other_cells = 4;  // along an edge; bodies that meet rarely have equal meshes

std::string box(std::string_view name, const Vec3& extent, int cells, std::string_view keys) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nbox = {{ extent = {}, cells = [{}, {}, {}] }}\nmaterial = MATERIAL\n{}\n", name,
      list_text(extent), cells, cells, cells, keys);
}

std::string cube(std::string_view name, double length, int cells, std::string_view keys) {
  return box(name, Vec3::Constant(length), cells, keys);
}

std::string opening(int frames, std::string_view keys = "") {
  return fmt::format("frames = {}\nfps = {:g}\n{}", frames, frame_rate, keys);
}

constexpr std::string_view no_gravity = "gravity = [0, 0, 0]\n";
// Without damping, a soft body under another one swings for longer than these films last.
constexpr std::string_view damped = "[solver]\ndamping = 0.002\n";
constexpr std::string_view rubbing_ground =
    "[[collider]]\nshape = { half_space = { normal = [0, 1, 0] } }\nfriction = 0.5\n";

// Returns a scene of two cubes whose middles are `least` to `most` apart [m]. The second one is turned about its own
// middle. Both the way between them and the turn are random.
std::string in_each_other(int seed, double least, double most, double length) {
  std::mt19937 draw(static_cast<std::mt19937::result_type>(seed));
  const auto part = [&draw] { return double(draw()) / 4294967296.0; };  // 0 to below 1
  const double height = 2 * part() - 1, around = 2 * std::numbers::pi * part(), across = std::sqrt(1 - height * height);
  const Vec3 direction(across * std::cos(around), height, across * std::sin(around));
  const Vec3 middle = (least + (most - least) * part()) * direction;
  Vec3 turn;
  for (int c = 0; c < 3; ++c) turn[c] = 360 * part();
  const auto at = [](const Vec3& center, double high) {  // a position is that of the middle of the underside
    return "position = " + list_text(center - Vec3(0, high / 2, 0));
  };
  return opening(90, no_gravity) + cube("first", edge, other_cells, at(Vec3::Zero(), edge)) +
         cube("second", length, inner_cells,
              fmt::format("{}\nstart = {{ turn_deg = {} }}", at(middle, length), list_text(turn)));
}

void add_starts(std::vector<MeetingCase>& list) {
  constexpr int starts = 4;
  constexpr double inner_edge = 0.08;  // its corners are 0.07 m from its middle
  const auto add = [&list](const char* name, double least, double most, double length) {
    MeetingCase meeting{name, {}};
    for (int seed = 1; seed <= starts; ++seed) meeting.scenes.push_back(in_each_other(seed, least, most, length));
    list.push_back(std::move(meeting));
  };
  add("two cubes that start partly in each other", 0.12, 0.17, edge);
  add("two cubes that start deep in each other", 0.03, 0.09, edge);
  add("a small cube that starts wholly inside another", 0, 0.03, inner_edge);
}

// Returns a scene of a cube between two others whose outer faces are moved inwards, each by `move` [m].
std::string squeezed(double move) {
  constexpr double free = 0.005;  // between two bodies [m]
  const auto jaw = [&](const char* name, double side) {
    const std::string face = side < 0 ? "[[0, 0, 0], [0.01, 1, 1]]" : "[[0.99, 0, 0], [1, 1, 1]]";
    return box(
        name, Vec3(edge, 1.5 * edge, 1.5 * edge), other_cells,
        fmt::format("position = {}\n[[body.handles]]\nname = \"outer face\"\nselect = {{ box = {} }}\n"
                    "keys = [{{ t = 0 }}, {{ t = 1, move = {} }}]",
                    list_text(Vec3(side * (edge + free), -0.75 * edge, 0)), face, list_text(Vec3(-side * move, 0, 0))));
  };
  return opening(90, no_gravity) + std::string(damped) + jaw("left", -1) +
         cube("middle", edge, inner_cells, fmt::format("position = {}", list_text(Vec3(0, -edge / 2, 0)))) +
         jaw("right", 1);
}

void add_squeezes(std::vector<MeetingCase>& list) {
  const auto add = [&list](const char* name, double move, std::vector<double> stiffness) {
    MeetingCase meeting{name, {squeezed(move)}, std::move(stiffness)};
    meeting.comes_to_rest = true;
    meeting.order = Vec3::UnitX();
    meeting.alone_from = 1;
    list.push_back(std::move(meeting));
  };
  add("a cube that two of its kind squeeze together", 0.1, {});
  add("a cube that two stiff bodies squeeze to half its length", 0.055, {100, 1, 100});
}

// Returns a scene of a cube that falls on another one, which stands on the ground.
std::string fallen(double lower_density, double upper_density) {
  const auto one = [](const char* name, int cells, double density, const char* keys) {
    return cube(name, edge, cells, fmt::format("density = {:g}\n{}", density, keys));
  };
  return opening(120) + std::string(damped) + one("lower", other_cells, lower_density, "position = [0, 0.002, 0]") +
         one("upper", inner_cells, upper_density, "position = [0.03, 0.24, 0.02]\nvelocity = [0, -0.5, 0]") +
         std::string(rubbing_ground);
}

void add_falls(std::vector<MeetingCase>& list) {
  const auto add = [&list](const char* name, std::string scene, std::vector<double> stiffness) {
    MeetingCase meeting{name, {std::move(scene)}, std::move(stiffness)};
    meeting.comes_to_rest = true;
    meeting.order = Vec3::UnitY();
    list.push_back(std::move(meeting));
  };
  add("a soft cube falls on one 1e4 times as stiff", fallen(1000, 1000), {1e4, 1});
  add("a cube falls on one 1e4 times as soft", fallen(1000, 1000), {1, 1e4});
  add("a light cube falls on one 1e3 times as dense", fallen(1000, 1), {});
  add("a cube falls on one 1e3 times as light", fallen(1, 1000), {});
}

void add_impacts(std::vector<MeetingCase>& list) {
  for (const double sizes : {3.0, 10.0}) {
    MeetingCase meeting{fmt::format("an impact of {:g} edges a frame", sizes), {}};
    meeting.scenes.push_back(
        opening(30, no_gravity) +
        cube("left", edge, other_cells,
             fmt::format("position = [-0.5, 0, 0]\nvelocity = {}", list_text(Vec3(sizes * edge * frame_rate, 0, 0)))) +
        cube("right", edge, inner_cells, "position = [0, 0.02, 0.01]\nturn_deg = [10, 20, 30]"));
    meeting.stays_whole = false;
    meeting.order = Vec3::UnitX();
    meeting.ordered_frames = 1;  // later they fly on beside each other
    list.push_back(std::move(meeting));
  }
}

}  // namespace

std::vector<MeetingCase> meeting_cases() {
  std::vector<MeetingCase> list;
  add_starts(list);
  add_squeezes(list);
  add_falls(list);
  add_impacts(list);
  return list;
}

}  // namespace supple
