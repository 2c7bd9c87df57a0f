// Reads where budgets of time ended the steps of an earlier run, so that a film can end them there again and get the
// same bits.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scene/replay/played_session.h"
#include "sim/model/inputs.h"

namespace supple {

// Holds the cuts of one body by frame and substep.
using CutsByFrame = std::vector<std::vector<BudgetCuts>>;

// Returns the cuts of a step; nothing where it had no budget in the earlier run.
std::optional<BudgetCuts> cuts_at(const CutsByFrame& cuts, int frame, int substep);

// Reads a run's profile. bodies: the names of the film's bodies; frames: its length. Returns the cuts by body. Throws
// InputError where the run has fewer frames, lacks a body, or had no budget.
std::vector<CutsByFrame> repeated_cuts(const std::filesystem::path& run, const std::vector<std::string>& bodies,
                                       int frames);

// Returns the cuts of a live session by body; empty where there was no session. Throws InputError where the session
// names a step that it cannot have.
std::vector<CutsByFrame> repeated_cuts(const PlayedSession& session, const std::vector<std::string>& bodies);

}  // namespace supple
