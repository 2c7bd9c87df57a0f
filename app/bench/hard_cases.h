// Lists hard cases: random, collapsed, mirrored and twisted starts; loads, impacts and spin; long and short steps;
// sizes from dust to mountains; bodies of unlike parts; stiff bodies that turn;
// meshes with slivers. Each has a rule that its run must keep.
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
  int seeds = 1;                  // how often it is played
  int copies = 0;                 // how many copies of it, turned in as many ways, must move alike; 0: none
  double poisson = 0.35;          // Poisson's ratio; where it is not this, materials without one are left out
  bool keeps_volume = false;      // within 5 % in all frames
  double stiffness = 1;           // of the whole body, over what is usual
  bool follows_solution = false;  // each step's error of motion against the solved step is below 0.05
  double far_stiffness = 1;       // of the half at the larger x, over what is usual
  double near_stiffness = 1;      // of the other half
  double far_density = 1;         // of the half at the larger x, over the other's
  bool has_second_part = false;   // a copy of the body that shares no vertex with it and that no handle holds
  bool is_start = false;          // whether it is about a start without gravity, from which a body may come to rest
  double turns_a_second = 0;      // at the start, about the diagonal [1, 1, 1] through the centre of mass
};

// paper_meshes: the folder with the meshes of the paper, of which some cases hang; nothing: these are left out.
std::vector<HardCase> hard_cases(const std::optional<std::filesystem::path>& paper_meshes);

}  // namespace supple
