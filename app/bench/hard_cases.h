// Lists hard cases: random, collapsed, mirrored and twisted starts; loads, impacts and spin; long and short steps;
// sizes from dust to mountains; bodies of unlike parts; stiff bodies that turn; meshes with slivers. Each case has a
// rule that its run must keep.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace supple {

// Names the state in which a case must end.
enum class StableEnd {
  recovered,  // at rest: nothing inverted or without volume, no stretch left
  whole,      // nothing inverted or without volume
  bounded,    // finite, and no energy from nothing: all that physics promises
};

struct HardCase {
  std::string name;
  std::string scene;  // the text of a scene; MATERIAL stands for a table, SEED for a number, TURN for angles in degrees
                      // and GRAVITY for a vector
  StableEnd end = StableEnd::bounded;
  std::string only = {};          // the one material that the case is about; empty: all
  int seeds = 1;                  // how many random starts are played
  int copies = 0;                 // how many copies of the case, each turned in another way, must move alike; 0: none
  double poisson = 0.35;          // Poisson's ratio; with another value, materials without one are left out
  bool keeps_volume = false;      // the volume must stay within 5 % in all frames
  double stiffness = 1;           // stiffness of the whole body, over the usual one
  bool follows_solution = false;  // each step's error of motion against the solved step is below 0.05
  double far_stiffness = 1;       // stiffness of the half at the larger x, over the usual one
  double near_stiffness = 1;      // stiffness of the other half, over the usual one
  double far_density = 1;         // density of the half at the larger x, over the other half's
  bool has_second_part = false;   // whether there is a copy of the body, with vertices of its own, that no handle holds
  bool is_start = false;          // whether it is about a start without gravity, from which a body may come to rest
  double turns_a_second = 0;      // at the start, about the diagonal [1, 1, 1] through the centre of mass
};

// Returns all cases. paper_meshes: the folder with the meshes of the paper, which some cases need; nothing: these cases
// are left out.
std::vector<HardCase> hard_cases(const std::optional<std::filesystem::path>& paper_meshes);

}  // namespace supple
