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
        std::size_t(body.x.size() + body.v.size() + body.anchors.points.size() + body.memory.matrix_made_at.size()) +
        body.flow.plastic.size() + body.flow.hardened.size() + body.flow.viscous.size();
  return sizeof(double) * numbers;
}

WorldState without_edits(WorldState state) {
  state.edits = {};
  return state;
}

}  // namespace

Timeline::Timeline(const World& world) { states_.push_back(without_edits(world.state())); }

void Timeline::add(const FrameRow& row, const World& world) {
  played_.hashes.push_back(row.state_hash);
  for (const BodyRow& body : row.bodies) {
    for (int substep = 0; substep < std::ssize(body.budget_cuts); ++substep)
      played_.cuts.push_back({body.name, row.frame, substep, {body.budget_cuts[std::size_t(substep)]}});
  }
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
  for (const TimedEdit& edit : edits_) {
    if (edit.frames >= state.frames) break;
    changes += std::holds_alternative<TimedChange>(edit.what);
    grabs += std::holds_alternative<LiveGrab>(edit.what);
    if (const auto* release = std::get_if<Release>(&edit.what)) releases.push_back(release);
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

void Timeline::redo(const TimedEdit& edit, World& world) const {
  if (const auto* change = std::get_if<TimedChange>(&edit.what)) world.change(*change);
  if (const auto* grab = std::get_if<LiveGrab>(&edit.what)) world.grab(*grab);
  if (const auto* release = std::get_if<Release>(&edit.what)) world.release(release->body, release->handle);
}

bool Timeline::remake(int frames, World& world, const std::function<bool()>& stops) const {
  auto next = std::ranges::lower_bound(edits_, world.frames(), {}, &TimedEdit::frames);
  auto cut = std::ranges::lower_bound(played_.cuts, world.frames(), {}, &PlayedCut::frame);
  while (world.frames() < frames) {
    if (stops()) return false;
    const int frame = world.frames();
    for (; next != edits_.end() && next->frames == frame; ++next) redo(*next, world);
    const auto end = std::find_if(cut, played_.cuts.end(), [frame](const PlayedCut& one) { return one.frame > frame; });
    const auto repeat = [&](std::size_t body, int substep) {
      const auto noted = std::find_if(cut, end, [&](const PlayedCut& one) {
        return one.body == world.bodies()[body].def.name && one.substep == substep;
      });
      world.body(body).repeat(noted == end ? std::nullopt : std::optional(noted->cuts));
    };
    const bool made = world.play(frame, {repeat, {}});
    for (std::size_t b = 0; b < world.size(); ++b) world.body(b).keep_to_clock();
    if (!made) throw RunError(fmt::format("frame {} could not be made again", frame));
    cut = end;
  }
  return true;
}

void Timeline::cut(int frames) {
  played_.hashes.resize(std::size_t(frames));
  std::erase_if(played_.cuts, [frames](const PlayedCut& one) { return one.frame >= frames; });
  std::erase_if(states_, [frames](const WorldState& state) { return state.frames > frames; });
  std::erase_if(edits_, [frames](const TimedEdit& edit) { return edit.frames >= frames; });
}

}  // namespace supple
