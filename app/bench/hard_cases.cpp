#include "app/bench/hard_cases.h"

#include <fmt/core.h>

#include <algorithm>
#include <initializer_list>
#include <string_view>

namespace supple {
namespace {

std::string joined(std::initializer_list<std::string_view> parts) {
  std::string text;
  for (const std::string_view part : parts) text += part;
  return text;
}

std::string cube(std::string_view keys, int cells = 3, double edge = 0.2) {
  return fmt::format(
      "[[body]]\nname = \"cube\"\nbox = {{ extent = [{0:g}, {0:g}, {0:g}], cells = [{1}, {1}, {1}] }}\nmaterial = "
      "MATERIAL\n{2}\n",
      edge, cells, keys);
}

std::string bar(std::string_view keys) {
  return joined(
      {"[[body]]\nname = \"bar\"\nbox = { extent = [0.6, 0.2, 0.2], cells = [9, 3, 3] }\nmaterial = MATERIAL\n", keys,
       "\n"});
}

constexpr std::string_view held_end =
    "[[body.handles]]\nname = \"end\"\nselect = { box = [[0, 0, 0], [0.01, 1, 1]] }\n";
constexpr std::string_view ground = "[[collider]]\nshape = { half_space = { normal = [0, 1, 0] } }\n";
constexpr std::string_view weightless = "frames = 90\ngravity = [0, 0, 0]\n", two_seconds = "frames = 60\n";

using Cases = std::vector<HardCase>;

void add(Cases& list, const std::string& name, StableEnd end, std::initializer_list<std::string_view> scene,
         const std::string& only = {}) {
  list.push_back({name, joined(scene), end, only});
}

void add_starts(Cases& list) {
  const auto start = [&](const std::string& name, std::string_view keys, StableEnd end) {
    add(list, name, end, {weightless, cube(joined({"start = { ", keys, " }"}))});
  };
  add(list, "random positions", StableEnd::bounded,
      {"seed = SEED\n", weightless, cube("start = { random = [0.2, 0.2, 0.2] }")});
  list.back().seeds = 100;
  start("collapsed to a point", "flatten = \"point\"", StableEnd::bounded);
  start("collapsed to a line", "flatten = \"line\"", StableEnd::bounded);
  start("collapsed to a plane", "flatten = \"plane\"", StableEnd::bounded);
  start("mirrored", "stretch = [-1, 1, 1]", StableEnd::bounded);
  start("stretched 3 times", "stretch = [3, 1, 1]", StableEnd::recovered);
  start("stretched 10 times", "stretch = [10, 10, 10]", StableEnd::bounded);
  start("squashed to 1 %", "stretch = [1, 0.01, 1]", StableEnd::bounded);
  for (const double turns : {0.5, 2.0, 8.0})
    add(list, fmt::format("twisted {:g} turns", turns), turns < 1 ? StableEnd::recovered : StableEnd::bounded,
        {weightless, bar(fmt::format("start = {{ twist_deg = {:g} }}", 360 * turns))});
  for (HardCase& hard : list) hard.is_start = true;
}

void add_loads(Cases& list) {
  add(list, "hanging from its end", StableEnd::whole, {two_seconds, bar(held_end)});
  add(list, "gravity x 100", StableEnd::bounded, {two_seconds, "gravity = [0, -981, 0]\n", bar(held_end)});
  add(list, "shaken by its end", StableEnd::whole,
      {two_seconds, bar(held_end),
       "keys = [{ t = 0 }, { t = 0.3, move = [0, 0.6, 0] }, { t = 0.6 }, { t = 0.9, move = [0, 0.6, 0] }, { t = 1.2 "
       "}]"});
  add(list, "light as air", StableEnd::whole, {two_seconds, bar(joined({"density = 1\n", held_end}))});
  add(list, "overloaded", StableEnd::bounded, {two_seconds, bar(joined({"density = 2e4\n", held_end}))});
  for (const double rate : {1000.0, 30.0, 10.0, 2.0})
    add(list, fmt::format("steps of 1/{:g} s", rate), rate >= 30 ? StableEnd::whole : StableEnd::bounded,
        {fmt::format("frames = {}\nfps = {:g}\n", std::clamp(int(rate), 20, 100), rate), bar(held_end)});
  for (const double poisson : {0.0, 0.45, 0.49, 0.495, 0.4999}) {
    add(list, fmt::format("Poisson's ratio {:g}", poisson), StableEnd::whole, {two_seconds, bar(held_end)});
    list.back().poisson = poisson;
    list.back().keeps_volume = poisson > 0.48;
  }
  for (const int iterations : {1, 2, 3})
    add(list, fmt::format("{} iteration{}", iterations, iterations == 1 ? "" : "s"), StableEnd::bounded,
        {two_seconds, fmt::format("[solver]\niterations = {}\n", iterations), bar(held_end)});
  for (const int history : {0, 1, 100})
    add(list, fmt::format("window m = {}", history), StableEnd::whole,
        {two_seconds, fmt::format("[solver]\nhistory = {}\n", history), bar(held_end)});
}

void add_motions(Cases& list) {
  const auto falls = [&](const std::string& name, std::string_view keys, StableEnd end) {
    add(list, name, end, {two_seconds, cube(joined({"position = [0, 0.02, 0]\n", keys})), ground});
  };
  falls("dropped", "velocity = [0, -1, 0]", StableEnd::whole);
  falls("impact of one size a step", "velocity = [0, -6, 0]", StableEnd::bounded);
  falls("impact of three sizes a step", "velocity = [0, -18, 0]", StableEnd::bounded);
  add(list, "free fall", StableEnd::recovered, {two_seconds, cube("")});
  add(list, "1e4 sizes from the origin", StableEnd::recovered, {two_seconds, cube("position = [2000, 0, 0]")});
  for (const double edge : {1e-4, 1e-2, 1e2, 1e4})
    add(list, fmt::format("a cube of {:g} m", edge), StableEnd::bounded,
        {weightless, cube("start = { stretch = [1.5, 1, 1] }", 3, edge)});
  add(list, "one cell", StableEnd::recovered, {weightless, cube("start = { stretch = [2, 1, 1] }", 1)});
  add(list, "elements 1:100", StableEnd::bounded,
      {two_seconds,
       "[[body]]\nname = \"sheet\"\nbox = { extent = [1, 0.01, 1], cells = [4, 4, 4] }\nmaterial = MATERIAL\n",
       held_end});
}

// Adds bodies whose halves differ, that consist of two parts, or that spin; and two cases that are played as turned
// copies.
void add_unlike_parts(Cases& list) {
  const auto unlike = [&](const std::string& name, double HardCase::*ratio, double value, std::string_view density) {
    add(list, name, StableEnd::whole, {two_seconds, bar(joined({density, held_end}))});
    list.back().*ratio = value;
  };
  for (const double ratio : {1e2, 1e4, 1e6}) {
    unlike(fmt::format("the free half {:.0e} times as stiff", ratio), &HardCase::far_stiffness, ratio, "");
    unlike(fmt::format("the held half {:.0e} times as stiff", ratio), &HardCase::near_stiffness, ratio, "");
  }
  // The heavy half strains the bar by about its length.
  unlike("the free half 1e4 times as dense", &HardCase::far_density, 1e4, "density = 0.2\n");
  unlike("the held half 1e4 times as dense", &HardCase::far_density, 1e-4, "density = 1000\n");
  add(list, "two parts, one held", StableEnd::whole, {two_seconds, bar(held_end)});
  list.back().has_second_part = true;
  add(list, "two parts dropped", StableEnd::whole, {two_seconds, cube("position = [0, 0.02, 0]"), ground});
  list.back().has_second_part = true;
  for (const double turns : {1.0, 3.0, 10.0, 100.0}) {
    add(list, fmt::format("{:g} turns a second", turns), turns > 3 ? StableEnd::bounded : StableEnd::whole,
        {weightless, cube("")});
    list.back().turns_a_second = turns;
  }
  constexpr std::string_view turned = "gravity = GRAVITY\n";
  add(list, "24 turned copies, hanging", StableEnd::whole,
      {two_seconds, turned, bar(joined({"turn_deg = TURN\n", held_end}))});
  list.back().copies = 24;
  add(list, "24 turned copies, spinning", StableEnd::whole, {weightless, cube("turn_deg = TURN")});
  list.back().copies = 24;
  list.back().turns_a_second = 1;
}

// Adds stiff bodies that move by turning, which costs no elastic energy.
void add_turning(Cases& list) {
  const std::size_t first = list.size();
  constexpr std::string_view rough_ground =
      "[[collider]]\nshape = { half_space = { normal = [0, 1, 0] } }\nfriction = 0.5\n";
  constexpr std::string_view post =
      "[[collider]]\nshape = { box = { extent = [0.1, 1, 0.1], round = 0.01 } }\nposition = [0.35, 0, 0.08]\n";
  constexpr std::string_view hinge = "[[body.handles]]\nname = \"edge\"\nselect = { box = [[0, 0, 0], [0, 0, 1]] }\n";
  add(list, "a stiff cube that topples", StableEnd::whole,
      {two_seconds, cube("turn_deg = [0, 0, 30]\nposition = [0, 0.02, 0]", 4), rough_ground});
  add(list, "a stiff cube that tumbles", StableEnd::whole,
      {two_seconds, cube("position = [0, 0.02, 0]\nvelocity = [3, 0, 0]", 4), rough_ground});
  add(list, "a stiff bar that swings", StableEnd::whole, {two_seconds, bar(hinge)});
  add(list, "a stiff cube that hits a post off its middle", StableEnd::whole,
      {weightless, cube("velocity = [3, 0, 0]", 4), post});
  for (const double turns : {1.0, 3.0}) {
    add(list, fmt::format("a stiff cube, {:g} turns a second", turns), StableEnd::whole, {weightless, cube("", 4)});
    list.back().turns_a_second = turns;
  }
  add(list, "a stiff cube thrown with spin", StableEnd::whole,
      {two_seconds, cube("position = [0, 0.3, 0]\nvelocity = [1, 2, 0]", 4), rough_ground});
  list.back().turns_a_second = 2;
  for (std::size_t i = first; i < list.size(); ++i) {
    list[i].stiffness = 1e3;
    list[i].follows_solution = true;
  }
}

// Adds meshes of the paper that have slivers: elements with volumes of 1e-6 of the mean and dihedral angles below a
// degree.
void add_slivers(Cases& list, const std::filesystem::path& meshes) {
  for (const char* mesh : {"bunny", "ditto", "hippo", "squirrel_modified"}) {
    for (const char* axis : {"x", "y", "z"}) {
      for (const bool upper : {false, true}) {
        double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
        const int c = axis[0] - 'x';
        (upper ? low : high)[c] = upper ? 0.95 : 0.05;
        add(list, fmt::format("the paper's {} hanging from its {}{} end", mesh, upper ? '+' : '-', axis),
            StableEnd::whole,
            {two_seconds,
             fmt::format("[[body]]\nname = \"body\"\nmesh = \"{}\"\nsize = 1\nmaterial = MATERIAL\n",
                         (meshes / mesh).string() + ".mesh"),
             fmt::format("[[body.handles]]\nname = \"end\"\nselect = {{ box = [[{}, {}, {}], [{}, {}, {}]] }}\n",
                         low[0], low[1], low[2], high[0], high[1], high[2])},
            "{ model = \"neo-hookean\", young = 1e5, poisson = 0.4 }");
      }
    }
  }
}

}  // namespace

std::vector<HardCase> hard_cases(const std::optional<std::filesystem::path>& paper_meshes) {
  std::vector<HardCase> list;
  add_starts(list);
  add_loads(list);
  add_motions(list);
  add_unlike_parts(list);
  add_turning(list);
  if (paper_meshes) add_slivers(list, *paper_meshes);
  return list;
}

}  // namespace supple
