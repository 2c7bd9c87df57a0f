// Holds what a live session notes beside its edits, so that a film of its replay repeats it and can tell whether it
// did.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/model/budget_cuts.h"

namespace supple {

class Config;
class ConfigTable;

// Tells where a budget of time ended a step of a body, or that it did not.
struct PlayedCut {
  std::string body;
  int frame = 0, substep = 0;
  BudgetCuts cuts;
};

struct PlayedSession {
  std::vector<std::uint64_t> hashes;  // hashes of the states after each frame (World::hash)
  std::vector<PlayedCut> cuts;        // cuts of all steps that had a budget of time, ordered by frame
  bool empty() const { return hashes.empty() && cuts.empty(); }
};

// Reads the table [session] of a replay, where there is one. Problems are recorded in the replay.
PlayedSession read_session(const ConfigTable& replay);

// Puts the table [session] into a replay in place of the one that it has; takes it out for an empty session.
void put_session(Config& replay, const PlayedSession& session);

}  // namespace supple
