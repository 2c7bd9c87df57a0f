#include "scene/replay/live_keys.h"

#include <array>
#include <sstream>

#include "scene/replay/script_parts.h"

namespace supple {
namespace {

struct LivePattern {
  std::string_view path;  // the pattern, which covers this path and all below it
  ChangeCost cost;
};

constexpr ChangeCost nothing{}, new_factor{true, false, false}, new_rule{false, true, false},
    new_surface{false, false, true}, tried{.trial = true};

// The first pattern that covers a path decides. A body's solver has the same keys as the scene's.
constexpr auto patterns = std::to_array<LivePattern>({
    {"gravity", nothing},
    {"wind.velocity", nothing},
    {"wind.gusts", nothing},
    {"wind.density", nothing},
    {"substeps", new_factor},
    {"solver.method", new_rule},
    {"solver.factor", new_factor},
    {"solver.fit_from", new_factor},
    {"solver.fit_to", new_factor},
    {"solver.integrator", new_factor},
    {"solver.damping", new_factor},
    {"solver.calming", nothing},
    {"solver.iterations", nothing},
    {"solver.history", nothing},
    {"solver.levels", nothing},
    {"solver.matrix", nothing},
    {"solver.elements", nothing},
    {"solver.rounds", nothing},
    {"solver.untangle", nothing},
    {"solver.chebyshev_delay", nothing},
    {"solver.chebyshev_radius", nothing},
    {"solver.line_search", nothing},
    {"solver.armijo", nothing},
    {"solver.target_error", nothing},
    {"solver.still", nothing},
    {"solver.budget_ms", nothing},
    {"solver.contact", nothing},
    {"body[].material", new_factor},
    {"body[].fibre", new_factor},
    {"body[].regions", new_factor},
    {"body[].plastic", nothing},
    {"body[].creep.time", nothing},
    {"body[].creep", new_factor},
    {"body[].label", nothing},
    {"body[].contact", nothing},
    {"body[].drag", nothing},
    {"body[].pressure", tried},
    {"body[].density", new_factor},
    {"body[].total_mass", new_factor},
    {"body[].cloth.stretch", new_factor},
    {"body[].cloth.shear", new_factor},
    {"body[].cloth.bend", new_factor},
    {"body[].handles[].stiffness", new_factor},
    {"body[].handles[].ease", nothing},
    {"body[].handles[].keys", nothing},
    {"collider[].shape", new_surface},
    {"collider[].position", nothing},
    {"collider[].turn_deg", nothing},
    {"collider[].friction", nothing},
    {"collider[].restitution", nothing},
    {"collider[].thickness", nothing},
    {"collider[].ease", nothing},
    {"collider[].keys", nothing},
    {"camera", nothing},
    {"look.ground", nothing},
    {"look.background", nothing},
    {"look.exposure", nothing},
    {"body[].color", nothing},
    {"body[].back_color", nothing},
    {"body[].gloss", nothing},
    {"body[].roughness", nothing},
    {"body[].translucent", nothing},
    {"collider[].color", new_surface},
    {"collider[].roughness", new_surface},
    {"collider[].translucent", new_surface},
});

// Tells whether a path is the pattern itself or lies below it.
bool covers(std::string_view pattern, std::string_view path) {
  return path == pattern || (path.starts_with(pattern) && path[pattern.size()] == '.');
}

std::optional<ChangeCost> cost_of_generic(std::string_view path) {
  constexpr std::string_view body_solver = "body[].solver";
  if (covers(body_solver, path)) path.remove_prefix(std::string_view("body[].").size());
  if (path == "solver") return ChangeCost{true, true, false};  // the whole table
  for (const LivePattern& pattern : patterns) {
    if (covers(pattern.path, path)) return pattern.cost;
  }
  return std::nullopt;
}

// Tells whether a path leads into an entry of a list whose entries have no names and are therefore called like the
// list.
bool names_no_entry(const std::string& path) {
  std::istringstream words(path);
  for (std::string before, word; std::getline(words, word, '.'); before = word) {
    if (word == before && word != "body" && word != "collider" && word != "handles") return true;
  }
  return false;
}

}  // namespace

ChangeCost& ChangeCost::operator|=(const ChangeCost& other) {
  factor |= other.factor;
  rule |= other.rule;
  surface |= other.surface;
  trial |= other.trial;
  return *this;
}

const char* ChangeCost::text() const {
  return factor ? "a new factor" : rule ? "the method starts anew" : surface ? "a new drawn surface" : "";
}

std::string generic_path(const std::string& path) {
  std::istringstream words(path);
  std::string generic;
  for (std::string word; std::getline(words, word, '.');) {
    generic += generic.empty() ? word : "." + word;
    if (word != "body" && word != "collider" && word != "handles") continue;
    generic += "[]";
    std::getline(words, word, '.');  // the element's name
  }
  return generic;
}

std::optional<ChangeCost> cost_of_change(const std::string& path) { return cost_of_generic(generic_path(path)); }

std::vector<LiveKey> live_keys(const Config& config) {
  std::vector<LiveKey> result;
  for (const KnownKey& key : config.known()) {
    if (key.type == "table" || key.type == "list of tables") continue;  // their keys are listed one by one
    if (names_no_entry(key.path)) continue;  // keys of motions and parts of shapes, whose list changes as a whole
    if (key.generic == "body[].handles[].stiffness" && key.value.find("hard") != std::string::npos)
      continue;  // a hard handle stays hard
    const auto cost = cost_of_change(key.path);
    if (!cost) continue;
    result.push_back({key, *cost});
    if (key.generic == "body[].density" && config.value_at(table_of(key.path) + ".cloth"))
      result.back().key.unit = "kg/m^2";               // a reader knows its keys before it knows what a body is made of
    constexpr std::string_view hard = "\"hard\" or ";  // a spring cannot become hard
    if (key.allowed.starts_with(hard)) result.back().key.allowed.erase(0, hard.size());
  }
  return result;
}

}  // namespace supple
