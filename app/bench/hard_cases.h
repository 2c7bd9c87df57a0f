// Lists hard cases: random, collapsed, mirrored and twisted starts; loads and impacts; long and short steps; sizes from
// dust to mountains; meshes with slivers. Each has a rule that its run must keep.
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
  std::string scene;  // the text of a scene; MATERIAL stands for a table, SEED for a number
  StableEnd end = StableEnd::bounded;
  std::string only = {};  // the one material that the case is about; empty: all
  int seeds = 1;          // how often it is played
};

// paper_meshes: the folder with the meshes of the paper, of which some cases hang; nothing: these are left out.
std::vector<HardCase> hard_cases(const std::optional<std::filesystem::path>& paper_meshes);

}  // namespace supple
