#include "live/timeline.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>

#include "base/error.h"

namespace supple {
namespace {

constexpr std::size_t most_memory = std::size_t(256) << 20;  // of all states [bytes]

std::size_t bytes_of(const WorldState& state) {
  std::size_t numbers = 0;
  for (const State& body : state.bodies)
    numbers +=
        std::size_t(body.x.size() + body.v.size() + body.anchors.points.size() + body.memory.matrix_made_at.size());
  return sizeof(double) * numbers;
}

WorldState without_edits(WorldState state) {
  state.edits = {};
  return state;
}

}  // namespace

Timeline::Timeline(const World& world) { states_.push_back(without_edits(world.state())); }

void Timeline::add(FrameRow row, const World& world) {
  rows_.push_back(std::move(row));
  if (world.frames() % every_ != 0) return;
  states_.push_back(without_edits(world.state()));
  bytes_ = std::max(bytes_, bytes_of(states_.back()));
  if (bytes_ * states_.size() > most_memory && states_.size() > 2) thin_out();
}

// Keeps every second state.
void Timeline::thin_out() {
  every_ *= 2;
  std::erase_if(states_, [this](const WorldState& state) { return state.frames % every_ != 0; });
}

WorldState Timeline::state_before(int frames, const LiveEdits& all) const {
  const auto after = std::ranges::upper_bound(states_, frames, {}, &WorldState::frames);
  WorldState state = *std::prev(after);
  // Edits are listed in the order in which they were made, each kind by itself.
  std::size_t changes = 0, grabs = 0;
  std::vector<const Release*> releases;
  for (const Done& done : done_) {
    if (done.frames >= state.frames) break;
    changes += std::holds_alternative<TimedChange>(done.what);
    grabs += std::holds_alternative<LiveGrab>(done.what);
    if (const auto* release = std::get_if<Release>(&done.what)) releases.push_back(release);
  }
  state.edits.changes.assign(all.changes.begin(), all.changes.begin() + std::ptrdiff_t(changes));
  state.edits.grabs.assign(all.grabs.begin(), all.grabs.begin() + std::ptrdiff_t(grabs));
  for (LiveGrab& grab : state.edits.grabs) {
    const auto lets_go = [&grab](const Release* release) {
      return release->body == grab.body && release->handle == grab.name;
    };
    if (std::ranges::none_of(releases, lets_go)) grab.until = std::numeric_limits<double>::infinity();
  }
  return state;
}

void Timeline::redo(const Done& done, World& world) const {
  if (const auto* change = std::get_if<TimedChange>(&done.what)) world.change(*change);
  if (const auto* grab = std::get_if<LiveGrab>(&done.what)) world.grab(*grab);
  if (const auto* release = std::get_if<Release>(&done.what)) world.release(release->body, release->handle);
}

void Timeline::go_on_to(int frames, World& world) {
  rows_.resize(std::size_t(frames));
  std::erase_if(states_, [frames](const WorldState& state) { return state.frames > frames; });
  std::erase_if(done_, [frames](const Done& done) { return done.frames >= frames; });
  auto next = std::ranges::lower_bound(done_, world.frames(), {}, &Done::frames);
  while (world.frames() < frames) {
    const int frame = world.frames();
    for (; next != done_.end() && next->frames == frame; ++next) redo(*next, world);
    const auto repeat = [&](std::size_t body, int substep) {
      const auto& cuts = rows_[std::size_t(frame)].bodies[body].budget_cuts;
      if (substep < std::ssize(cuts)) world.body(body).repeat(BudgetCuts{cuts[std::size_t(substep)]});
    };
    if (!world.play(frame, {repeat, {}})) throw RunError(fmt::format("frame {} could not be made again", frame));
    for (std::size_t b = 0; b < world.size(); ++b) world.body(b).keep_to_clock();
  }
}

PlayedSession Timeline::played() const {
  PlayedSession played;
  for (const FrameRow& row : rows_) {
    played.hashes.push_back(row.state_hash);
    for (const BodyRow& body : row.bodies) {
      for (int substep = 0; substep < std::ssize(body.budget_cuts); ++substep)
        played.cuts.push_back({body.name, row.frame, substep, {body.budget_cuts[std::size_t(substep)]}});
    }
  }
  return played;
}

}  // namespace supple
