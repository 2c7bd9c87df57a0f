// Makes many bodies of a few: [[scatter]] puts copies of the bodies that it names at random places, with random turns
// and sizes. The copies take the bodies' place in the scene. They share the tables of these, so that a path such as
// body.hippo.material.young sets the value of all copies of `hippo`.
#pragma once

#include <vector>

#include "scene/config/config.h"
#include "scene/definition/body_def.h"

namespace supple {

// Selects how copies are turned, in addition to the turn of their body.
enum class ScatterTurn {
  heading,  // about the vertical
  any,
  none,
};
template <>
struct Names<ScatterTurn> {
  static constexpr std::array table = {Name{ScatterTurn::heading, "heading"}, Name{ScatterTurn::any, "any"},
                                       Name{ScatterTurn::none, "none"}};
};

// Describes one copy.
struct ScatteredCopy {
  std::string body;  // name of the body that is copied
  Vec3 position;     // [m]
  Eigen::Quaterniond turn;
  double size;  // factor of the body's size
};

struct Scattering {
  std::vector<std::string> bodies;
  std::vector<ScatteredCopy> copies;
};

// Reads the tables [[scatter]] of a scene's root. seed: the scene's.
std::vector<Scattering> read_scatterings(const ConfigTable& root, std::uint64_t seed);

// Returns the copies of a body, named NAME_1, NAME_2, ...; the body itself where nothing scatters it. table: that of
// the body.
std::vector<BodyDef> copies_of(const std::vector<Scattering>& scatterings, const ConfigTable& table, BodyDef body);

// Complains of bodies that are scattered but not there. names: those that the tables [[body]] have.
void check_scattered(const ConfigTable& root, const std::vector<Scattering>& scatterings,
                     const std::vector<std::string>& names);

}  // namespace supple
