#include "scene/reading/meeting_check.h"

#include <algorithm>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/text.h"
#include "scene/config/config.h"
#include "scene/definition/body_def.h"
#include "scene/definition/meeting.h"
#include "scene/definition/scene_def.h"

namespace supple {
namespace {

// Records problems with names in lists, one for each name of a list: the bodies that are made of the pieces of one
// surface share their list.
class Complaints {
 public:
  explicit Complaints(Config& config) : config_(config) {}

  void add(const BodyDef& body, const std::string& name, const std::string& what) {
    const FilePlace& place = body.contact.meets_place;
    if (seen_.emplace(place, name).second) config_.complain({place, fmt::format("meets = '{}': {}", name, what)});
  }

 private:
  Config& config_;
  std::set<std::pair<FilePlace, std::string>> seen_;
};

std::vector<std::string> others_of(const SceneDef& scene, const BodyDef& body) {
  std::vector<std::string> names;
  for (const BodyDef& other : scene.bodies) {
    if (&other != &body) names.push_back(other.name);
  }
  return names;
}

// Returns the names of tables that make several bodies, each of which stands for all of these.
std::vector<std::string> tables_of(const SceneDef& scene) {
  std::vector<std::string> names;
  for (const BodyDef& body : scene.bodies)
    if (body.table != body.name && std::ranges::find(names, body.table) == names.end()) names.push_back(body.table);
  return names;
}

bool shares_list(const SceneDef& scene, const BodyDef& body) {
  return std::ranges::any_of(scene.bodies,
                             [&body](const BodyDef& other) { return &other != &body && other.place == body.place; });
}

std::string allowed_names(const std::vector<std::string>& others) {
  constexpr std::size_t most_listed = 12;
  if (others.empty()) return "the name of another body, and there is none";
  if (others.size() > most_listed) return fmt::format("the name of another body ({} have one)", others.size());
  return fmt::format("the name of another body: {}", word_list(others));
}

void check_names(const SceneDef& scene, const BodyDef& body, Complaints& complaints) {
  const std::vector<std::string> others = others_of(scene, body);
  std::vector<std::string> known = tables_of(scene);
  known.insert(known.end(), others.begin(), others.end());
  for (const std::string& name : *body.contact.meets) {
    if (std::ranges::find(known, name) != known.end()) continue;
    if (name != body.name) {
      complaints.add(body, name, fmt::format("must be {}{}", allowed_names(others), did_you_mean(name, known)));
    } else if (!shares_list(scene, body)) {
      complaints.add(body, name,
                     fmt::format("whether a body meets itself is said by self; must be {}", allowed_names(others)));
    }
  }
}

void check_pair(const BodyDef& body, const BodyDef& other, Complaints& complaints) {
  if (!asks_to_meet(body, other) || !both_allow_meeting(body, other)) return;
  const std::string why = why_not_meet(body, other);
  if (!why.empty()) complaints.add(body, other.name, fmt::format("body '{}' cannot meet it: {}", body.name, why));
}

}  // namespace

void check_meetings(const SceneDef& scene, Config& config) {
  Complaints complaints(config);
  for (const BodyDef& body : scene.bodies) {
    if (!body.contact.meets) continue;
    check_names(scene, body, complaints);
    for (const BodyDef& other : scene.bodies) {
      if (&other != &body) check_pair(body, other, complaints);
    }
  }
}

}  // namespace supple
