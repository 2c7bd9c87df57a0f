// Checks the changes of a replay. All problems are found at once, and each message points to a line of the replay.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "scene/reading/scene_reader.h"
#include "scene/reading/table_readers.h"
#include "scene/replay/script_parts.h"

namespace supple {
namespace {

constexpr std::size_t most_problems = 20;
constexpr std::size_t most_checked = 2000;  // frames; a check takes 0.1 to 1 ms

std::vector<Problem> problems_of(Config document) {
  (void)read_scene(document);
  return document.take_problems();
}

// Returns the problems of a list that are not in the other one.
std::vector<Problem> beyond(const std::vector<Problem>& list, const std::vector<Problem>& other) {
  std::vector<Problem> rest;
  for (const Problem& problem : list) {
    const auto same = [&problem](const Problem& p) { return p.text() == problem.text(); };
    if (std::none_of(other.begin(), other.end(), same)) rest.push_back(problem);
  }
  return rest;
}

Problem at(const TimedChange& change, std::string message) { return {change.place, std::move(message)}; }

// Returns the problems that a change causes, as messages that point into the replay. A problem that appears at another
// place, in a file that the change does not touch, is reported at the change.
std::vector<Problem> as_caused_by(const TimedChange& change, const std::vector<Problem>& made) {
  std::vector<Problem> own;
  std::string elsewhere;
  for (const Problem& problem : made) {
    if (problem.place.source == change.place.source) own.push_back(problem);
    elsewhere += fmt::format("{}{} ({})", elsewhere.empty() ? "" : "; ", problem.message, problem.place.text());
  }
  if (!own.empty()) return own;
  const std::string table = table_of(change.path);
  const bool together = cost_of_change(table).has_value();
  return {at(
      change,
      fmt::format("{} = {} does not go with what stands beside it: {}{}", change.path, change.to.text(), elsewhere,
                  together ? fmt::format(". Change all of it at once: path = \"{}\", value = {{ ... }}", table) : ""))};
}

}  // namespace

void Script::Parts::add_problems(std::vector<Problem> more) {
  problems.insert(problems.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

void Script::Parts::report(Problem problem, const std::string& when, Reported& reported) {
  if (!reported.places.insert(problem.place.text()).second) return;
  problem.message += when;
  problems.push_back(std::move(problem));
}

bool Script::Parts::put(Config& document, const std::string& path, const ConfigValue& value, const FilePlace& place) {
  try {
    document.put(path, value, place, exclusive_keys());
    return true;
  } catch (const InputError& error) {
    const std::string table = table_of(path);
    const auto stands = table.ends_with(".material") ? document.value_at(table) : std::nullopt;
    const std::string preset = stands ? preset_in_full(stands->whole_text()) : "";
    if (preset.empty()) {
      add_problems(error.problems());
    } else {
      problems.push_back(
          {place, fmt::format("{} is the preset '{}' here, and a preset has no '{}'; write in its place what it "
                              "stands for: {}",
                              table, stands->whole_text(), path.substr(table.size() + 1), preset)});
    }
    return false;
  }
}

// Removes the changes whose paths lead to nothing.
void Script::Parts::put_each() {
  Config document = scene_file.copy();
  std::erase_if(changes,
                [&](const TimedChange& change) { return !put(document, change.path, change.to, change.place); });
}

// Returns the value at a path, or its default.
std::optional<ConfigValue> Script::Parts::value_at(const std::string& path, Config document) const {
  if (auto value = document.value_at(path)) return value;
  open_tables(document);
  open_table_of(document, path);
  (void)read_scene(document);
  for (const KnownKey& key : document.known()) {
    if (key.path == path) return ConfigValue::parse(key.value);
  }
  return std::nullopt;
}

// Finds the value at which a ramp begins. Returns the problems that keep the change from being a ramp.
std::vector<Problem> Script::Parts::prepare(TimedChange& ramp, std::size_t index) const {
  const auto before = [&] { return document_at(ramp.at + at_start, index); };
  if (!ramp.from) ramp.from = value_at(ramp.path, before());
  if (!ramp.from) {  // most often a misspelled path
    Config over = before();
    over.put(ramp.path, ramp.to, ramp.place, exclusive_keys());
    const std::vector<Problem> made = beyond(problems_of(std::move(over)), problems_of(before()));
    if (!made.empty()) return as_caused_by(ramp, made);
    return {at(ramp, fmt::format("{} has no value in the scene to begin with: give the ramp a 'from'", ramp.path))};
  }
  if (!ramp.from->joins(ramp.to)) {
    const bool only_jumps = !ramp.from->is_list_or_number() && !ramp.to.is_list_or_number();
    return {at(ramp, fmt::format("a ramp leads through numbers, or lists of them of one form; not from {} to {}{}",
                                 ramp.from->text(), ramp.to.text(),
                                 only_jumps ? ". Words and tables jump: leave out 'over' or 'frames'" : ""))};
  }
  if (ramp.by == RampRule::ratio && !(ramp.from->all_positive() && ramp.to.all_positive()))
    return {at(ramp, "by = \"ratio\": only between positive numbers")};
  return {};
}

void Script::Parts::prepare_ramps() {
  for (std::size_t i = 0; i < changes.size();) {
    std::vector<Problem> wrong = changes[i].over > 0 ? prepare(changes[i], i) : std::vector<Problem>();
    if (wrong.empty()) {
      ++i;
    } else {
      add_problems(std::move(wrong));
      changes.erase(changes.begin() + std::ptrdiff_t(i));
    }
  }
}

// Reads the scene as it is at a time, and reports its problems.
void Script::Parts::check_at(double time, const std::string& when, Reported& reported) {
  std::vector<Problem> found = problems_of(document_at(time, changes.size()));
  std::erase_if(found, [&](const Problem& problem) {
    return reported.places.contains(problem.place.text()) || reported.texts.contains(problem.text());
  });
  for (std::size_t i = changes.size(); i-- > 0 && !found.empty();) {
    if (!changes[i].done_at(time)) continue;
    std::vector<Problem> made;
    try {
      made = beyond(found, problems_of(document_at(time, changes.size(), i)));
    } catch (const InputError&) {
      continue;  // the paths of other changes lead into the value of this change
    }
    if (made.empty()) continue;
    for (const Problem& problem : made) reported.texts.insert(problem.text());
    for (Problem& problem : as_caused_by(changes[i], made)) report(std::move(problem), when, reported);
    found = beyond(found, made);
  }
  for (Problem& problem : found) report(std::move(problem), when, reported);
}

// Checks the frames from `first` to before `end` in which changes are at work. Where there are more than most_checked,
// checks evenly spread ones, and those between where one of them is wrong.
void Script::Parts::check_frames(int first, int end, Reported& reported) {
  std::vector<int> frames;
  for (int frame = first; frame < end; ++frame) {
    if (std::any_of(changes.begin(), changes.end(), [&](const TimedChange& c) { return at_work(c, frame); }))
      frames.push_back(frame);
  }
  const auto check = [&](std::size_t i) {
    check_at(start.time_after(frames[i]), fmt::format(" (first in frame {})", frames[i]), reported);
  };
  const std::size_t stride = 1 + frames.size() / most_checked;
  for (std::size_t i = 0; i < frames.size() && problems.size() < most_problems; i += stride) {
    const std::size_t last = std::min(i + stride, frames.size()) - 1;
    if (stride > 1 && problems_of(document_at(start.time_after(frames[last]), changes.size())).empty()) continue;
    for (std::size_t between = i; between <= last; ++between) check(between);
  }
}

void Script::Parts::check_changes() {
  try {
    put_each();
    prepare_ramps();
    Reported reported;
    check_at(first_moment(), "", reported);
    check_frames(0, start.frames, reported);
  } catch (const InputError& error) {  // a change depends on one that was removed
    if (problems.empty()) throw;
  }
  if (problems.empty()) return;
  std::stable_sort(problems.begin(), problems.end(),
                   [](const Problem& a, const Problem& b) { return a.place < b.place; });
  throw InputError(std::move(problems));
}

void Script::Parts::add_change(TimedChange change) {
  const auto place = std::ranges::upper_bound(changes, change.at, {}, &TimedChange::at);
  const auto index = static_cast<std::size_t>(place - changes.begin());
  const int first = static_cast<int>(std::lround(change.at * start.fps)) - start.frames_before();
  const int end = std::max(
      start.frames, 1 + static_cast<int>(std::ceil((change.at + change.over) * start.fps)) - start.frames_before());
  changes.insert(place, std::move(change));
  problems.clear();
  try {
    TimedChange& added = changes[index];
    Config document = document_at(added.at + at_start, index);
    if (put(document, added.path, added.to, added.place) && added.over > 0) add_problems(prepare(added, index));
    if (problems.empty()) {
      Reported reported;
      if (first == 0) check_at(first_moment(), "", reported);
      check_frames(first, end, reported);
    }
  } catch (const InputError& error) {
    add_problems(error.problems());
  }
  if (problems.empty()) return;
  changes.erase(changes.begin() + std::ptrdiff_t(index));
  throw InputError(std::exchange(problems, {}));
}

}  // namespace supple
