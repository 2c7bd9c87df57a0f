#include "scene/replay/script.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "base/text.h"
#include "scene/reading/model_scene.h"
#include "scene/reading/replay_start.h"
#include "scene/reading/scene_reader.h"
#include "scene/reading/sweep.h"
#include "scene/replay/script_parts.h"

namespace supple {
namespace {

// Reads a time, given in seconds or as a frame.
double read_time(const ConfigTable& table, const FrameRate& fps, const Key& seconds, const Key& frames, bool required) {
  const auto in_seconds = table.number_if_given(seconds, Range::at_least(0));
  std::optional<int> in_frames;
  if (table.has(frames.name)) in_frames = table.integer(frames, std::nullopt, Range::between(0, 1000000));
  if (in_seconds && in_frames)
    table.complain(frames.name, fmt::format("either '{}' or '{}', not both", seconds.name, frames.name));
  if (required && !in_seconds && !in_frames)
    table.complain(fmt::format("when? '{}' [s] or '{}' is missing", seconds.name, frames.name));
  return in_seconds ? *in_seconds : fps.time_of(in_frames.value_or(0));
}

std::string object_of(const std::string& path) {
  for (const char* list : {"body.", "collider."}) {
    if (!path.starts_with(list)) continue;
    const std::size_t begin = std::string_view(list).size();
    return path.substr(begin, path.find('.', begin) - begin);
  }
  return "";
}

std::optional<TimedChange> read_change(const ConfigTable& table, const FrameRate& fps) {
  const std::string path =
      table.text({"path", "", "the value, as --set takes it; `supple info --live SCENE` lists them"}, std::nullopt);
  const double at =
      read_time(table, fps, {"t", "s", "when it begins"}, {"frame", "", "the frame that it begins with"}, true);
  const double over = read_time(table, fps, {"over", "s", "how long it takes; without it the value jumps"},
                                {"frames", "", "how many frames it takes"}, false);
  const Ease ease = table.word<Ease>({"ease", "", "how a ramp starts and ends"}, Ease::smooth);
  const RampRule by = table.word<RampRule>({"by", "", "a ramp adds the same or multiplies by the same in equal times"},
                                           RampRule::difference);
  const auto from = table.value({"from", "", "where a ramp begins; the value that is in force then"}, "none");
  const auto to = table.value({"value", "", "what it becomes"});
  if (!to || !table.has("path")) return std::nullopt;
  const auto cost = cost_of_change(path);
  if (!cost) {
    table.complain(
        "path", fmt::format("'{}' cannot change while the film runs; `supple info --live SCENE` lists what can", path));
    return std::nullopt;
  }
  if (from && over <= 0) table.complain("from", "from: of ramps, which have an 'over' or 'frames'");
  return TimedChange{path, object_of(path), at, over, ease, by, false, *cost, from, *to, table.place("value")};
}

}  // namespace

std::optional<double> TimedChange::done_at(double time) const {
  if (time < at + time_tolerance) return std::nullopt;
  if (over <= 0) return 1;
  if (time - at <= at_start) return 0;
  const double s = (time - at) / over;
  return s >= 1 - time_tolerance ? 1 : ease == Ease::smooth ? s * s * (3 - 2 * s) : s;
}

namespace {

// Tells for each of the first `count` changes whether it is a jump that the next jump of the same value replaces, with
// no other change of the same table, or of a part of the value, in between. A program that sets a value in every frame
// has thousands of these.
std::vector<char> replaced_jumps(const std::vector<TimedChange>& changes, std::size_t count, double time,
                                 std::optional<std::size_t> left_out) {
  std::vector<char> replaced(count, 0);
  std::unordered_map<std::string, const TimedChange*> next_in_table;
  std::unordered_set<std::string> changed_in_part;  // values whose parts change before the next jump of the whole
  for (std::size_t i = count; i-- > 0;) {
    const TimedChange& change = changes[i];
    if (i == left_out || !change.done_at(time)) continue;
    const TimedChange*& next = next_in_table[table_of(change.path)];
    const bool has_parts = changed_in_part.erase(change.path) > 0;
    replaced[i] = next != nullptr && next->path == change.path && next->over <= 0 && change.over <= 0 && !has_parts;
    next = &change;
    for (std::string whole = table_of(change.path); !whole.empty(); whole = table_of(whole))
      changed_in_part.insert(whole);
  }
  return replaced;
}

}  // namespace

Config Script::Parts::document_at(double time, std::size_t count, std::optional<std::size_t> left_out) const {
  Config document = scene_file.copy();
  const std::vector<char> replaced = replaced_jumps(changes, count, time, left_out);
  for (std::size_t i = 0; i < count; ++i) {
    const TimedChange& change = changes[i];
    const auto done = change.done_at(time);
    if (i == left_out || !done || replaced[i] != 0) continue;
    document.put(
        change.path,
        change.over > 0 ? ConfigValue::between(*change.from, change.to, *done, change.by, change.whole) : change.to,
        change.place, exclusive_keys());
  }
  for (const std::string& setting : last_settings) document.set(setting, exclusive_keys());
  return document;
}

bool Script::Parts::at_work(const TimedChange& change, int frame) const {
  const double from = start.time_after(frame - 1), to = start.time_after(frame);
  if (change.over <= 0)
    return change.at > start.time_at_start() + time_tolerance && change.at > from - time_tolerance &&
           change.at < to - time_tolerance;
  return change.at < to - time_tolerance && change.at + change.over > from + time_tolerance;
}

SceneDef Script::Parts::read(Config& document) const {
  SceneDef scene = read_scene(document);
  document.finish();
  scene.name = start.name;
  return scene;
}

Script::Script(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Script::Script(Script&&) noexcept = default;
Script::~Script() = default;

namespace {

bool is_whole_number(const Config& scene, const std::string& path) {
  return std::any_of(scene.known().begin(), scene.known().end(),
                     [&](const KnownKey& key) { return key.path == path && key.type == "whole number"; });
}

}  // namespace

void open_tables(Config& document) {
  std::vector<std::string> tables = {"camera", "look", "solver", "wind"};
  if (document.value_at("collider")) tables.emplace_back("solver.contact");
  for (const std::string& table : tables) {
    if (!document.value_at(table)) document.put(table, *ConfigValue::parse("{}"), {}, {});
  }
}

std::string table_of(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? "" : path.substr(0, dot);
}

void open_table_of(Config& document, const std::string& path) {
  const std::string table = table_of(path);
  if (table.empty() || document.value_at(table)) return;
  try {
    document.put(table, *ConfigValue::parse("{}"), {}, {});
  } catch (const InputError&) {  // a part of the path names nothing that is there
  }
}

// Reads the scene that the replay starts with, and the changes.
void Script::Parts::read_replay(const std::filesystem::path& assets, const std::vector<std::string>& asked_for,
                                std::optional<std::size_t> sweep_point) {
  scene_file = start_of_replay(*replay, assets, problems,
                               [this](Config& document, const std::string& path, const ConfigValue& value,
                                      const FilePlace& place) { put(document, path, value, place); });
  const ConfigTable root = replay->root();
  for (const std::string& setting : asked_for) scene_file.set(setting, exclusive_keys());
  if (sweep_point) put_sweep_point(scene_file, *sweep_point);
  Config plain = scene_file.copy();
  start = read_scene(plain);
  const std::vector<Problem> of_scene = plain.take_problems();
  for (const ConfigTable& table : root.tables({"change", "", "a value that changes while the film runs"})) {
    if (auto change = read_change(table, start.fps)) changes.push_back(std::move(*change));
  }
  session = read_session(root);
  open_tables(plain);
  for (const TimedChange& change : changes) open_table_of(plain, change.path);
  (void)read_scene(plain);  // so that the types of all keys are known
  for (TimedChange& change : changes) change.whole = is_whole_number(plain, change.path);
  for (const std::vector<Problem>& more : {of_scene, replay->take_problems()})
    problems.insert(problems.end(), more.begin(), more.end());
  if (!of_scene.empty()) throw InputError(std::move(problems));
  std::stable_sort(changes.begin(), changes.end(),
                   [](const TimedChange& a, const TimedChange& b) { return a.at < b.at; });
}

Script Script::load(const SceneSource& source, const std::filesystem::path& assets,
                    const std::vector<std::string>& settings, std::optional<std::size_t> sweep_point) {
  auto parts = std::make_unique<Parts>(
      Parts{source, settings, std::nullopt, load_document(source, assets), {}, {}, {}, {}, std::nullopt, {}, {}});
  if (supple::is_replay(parts->scene_file)) {
    parts->replay = parts->scene_file.copy();
    parts->read_replay(assets, settings, sweep_point);
    parts->check_changes();
  } else {
    for (const std::string& setting : settings) parts->scene_file.set(setting, exclusive_keys());
    if (sweep_point) put_sweep_point(parts->scene_file, *sweep_point);
  }
  parts->start.name = source.name();
  Config document = parts->document_at(parts->first_moment(), parts->changes.size());
  parts->start = parts->read(document);
  return Script(std::move(parts));
}

ChangeCost cost_for(const std::string& name, const std::vector<TimedChange>& changes) {
  ChangeCost cost;
  for (const TimedChange& change : changes) {
    if (change.object.empty() || change.object == name) cost |= change.cost;
  }
  return cost;
}

bool Script::is_replay() const { return parts_->replay.has_value(); }
const SceneDef& Script::scene() const { return parts_->start; }
const std::vector<TimedChange>& Script::changes() const { return parts_->changes; }
const PlayedSession& Script::session() const { return parts_->session; }

std::vector<const TimedChange*> Script::at_work(int frame) const {
  std::vector<const TimedChange*> result;
  for (const TimedChange& change : parts_->changes) {
    if (parts_->at_work(change, frame)) result.push_back(&change);
  }
  return result;
}

SceneDef Script::scene_at(int frame) const {
  Config document = parts_->document_at(parts_->start.time_after(frame), parts_->changes.size());
  return parts_->read(document);
}

void Script::Parts::apply_edits() {
  if (!unedited) unedited.emplace(Unedited{scene_file.copy(), changes});
  scene_file = unedited->scene_file.copy();
  for (const LiveGrab& grab : edits.grabs) {
    Config table = document_of(grab);
    scene_file.append("body." + grab.body + ".handles", table.root().all_but("body"), {table.name()});
  }
  changes = unedited->changes;
  changes.insert(changes.end(), edits.changes.begin(), edits.changes.end());
  std::ranges::stable_sort(changes, {}, &TimedChange::at);
  Config document = document_at(first_moment(), changes.size());
  start = read(document);
}

void Script::add(TimedChange change) {
  const auto cost = cost_of_change(change.path);
  if (!cost) {
    throw InputError({Problem{change.place, fmt::format("'{}' cannot change while the film runs; `supple info --live "
                                                        "SCENE` lists what can",
                                                        change.path)}});
  }
  constexpr double most_frames = 1e6;  // as the file of a replay may say
  if (!(change.over * parts_->start.fps <= most_frames))
    throw InputError(
        {Problem{change.place, fmt::format("over = {:g} s: {:g} frames are the most", change.over, most_frames)}});
  change.object = object_of(change.path);
  change.cost = *cost;
  if (change.over > 0) {
    Config plain = parts_->scene_file.copy();
    open_tables(plain);
    open_table_of(plain, change.path);
    (void)read_scene(plain);
    change.whole = is_whole_number(plain, change.path);
  }
  if (!parts_->unedited) parts_->unedited.emplace(Parts::Unedited{parts_->scene_file.copy(), parts_->changes});
  parts_->add_change(change);
  const bool from_start = change.at <= time_tolerance;
  // A ramp was given its beginning meanwhile.
  const auto place = std::ranges::upper_bound(parts_->changes, change.at, {}, &TimedChange::at);
  parts_->edits.changes.push_back(*std::prev(place));
  if (!from_start) return;
  Config document = parts_->document_at(parts_->first_moment(), parts_->changes.size());
  parts_->start = parts_->read(document);
}

void Script::add(const LiveGrab& grab) {
  parts_->edits.grabs.push_back(grab);
  try {
    parts_->apply_edits();
  } catch (const InputError&) {
    parts_->edits.grabs.pop_back();
    parts_->apply_edits();
    throw;
  }
}

void Script::end_grab(const std::string& body, const std::string& name, double until) {
  std::vector<LiveGrab>& grabs = parts_->edits.grabs;
  const auto grab =
      std::ranges::find_if(grabs, [&](const LiveGrab& one) { return one.body == body && one.name == name; });
  SUPPLE_CHECK(grab == grabs.end(), ==, false);
  grab->until = until;
  parts_->apply_edits();
}

const LiveEdits& Script::edits() const { return parts_->edits; }

void Script::set_edits(LiveEdits edits) {
  std::swap(parts_->edits, edits);
  try {
    parts_->apply_edits();
    Config last = parts_->document_at(infinity, parts_->changes.size());
    (void)parts_->read(last);
  } catch (const InputError&) {
    parts_->edits = std::move(edits);
    parts_->apply_edits();
    throw;
  }
}

Script Script::with(const std::vector<std::string>& settings) const {
  const Parts& own = *parts_;
  auto parts = std::make_unique<Parts>(Parts{own.source,
                                             own.settings,
                                             std::nullopt,
                                             own.scene_file.copy(),
                                             {},
                                             own.changes,
                                             {},
                                             {},
                                             std::nullopt,
                                             own.session,
                                             settings});
  parts->start = own.start;
  Config document = parts->document_at(parts->first_moment(), parts->changes.size());
  parts->start = parts->read(document);
  return Script(std::move(parts));
}

namespace {

// Tells whether a change of `path` overwrites everything that a change of `other` sets.
bool replaces(const std::string& path, const std::string& other) {
  return other.starts_with(path) && (other.size() == path.size() || other[path.size()] == '.');
}

// Warns of ramps that are cut off by a later change of the same value.
void warn_of_broken_ramps(const std::vector<TimedChange>& changes, std::vector<Problem>& list) {
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const TimedChange& ramp = changes[i];
    for (std::size_t j = i + 1; j < changes.size() && changes[j].at < ramp.at + ramp.over - time_tolerance; ++j) {
      const TimedChange& later = changes[j];
      if (!replaces(later.path, ramp.path)) continue;
      list.push_back(
          {later.place,
           fmt::format("from {:g} s on this change sets {}; the ramp of line {} ({:g} to {:g} s) ends there, "
                       "unfinished",
                       later.at, ramp.path, ramp.place.line, ramp.at, ramp.at + ramp.over)});
      break;
    }
  }
}

}  // namespace

std::vector<Problem> Script::warnings() const {
  std::vector<Problem> list;
  const double end = parts_->start.time_after(parts_->start.frames - 1);
  const auto warn = [&list](const FilePlace& place, std::string message) {
    list.push_back({place, std::move(message)});
  };
  for (const TimedChange& change : parts_->changes) {
    if (change.at > end - time_tolerance) {
      warn(change.place,
           fmt::format("{} would change at {:g} s, when the film is over ({:g} s)", change.path, change.at, end));
    } else if (change.at + change.over > end + time_tolerance) {
      warn(change.place, fmt::format("the film is over ({:g} s) before {} has changed all the way", end, change.path));
    }
  }
  warn_of_broken_ramps(parts_->changes, list);
  for (const BodyDef& body : parts_->start.bodies) {
    for (const HandleDef& handle : body.handles) {
      bool holds = !handle.grabs;
      for (int step = 0; step < parts_->start.frames * parts_->start.substeps && !holds; ++step)
        holds = handle.holds_at(parts_->start.time_at_start() + step * parts_->start.time_step());
      if (!holds)
        warn(handle.select.place,
             fmt::format("handle '{}' of body '{}' never holds: from {:g} to {:g} s no step of this film begins",
                         handle.name, body.name, handle.from, handle.until));
    }
  }
  return list;
}

std::string Script::scene_json() const {
  return parts_->document_at(parts_->first_moment(), parts_->changes.size()).as_json();
}
std::string Script::scene_json_at(int frame) const {
  return parts_->document_at(parts_->start.time_after(frame), parts_->changes.size()).as_json();
}
std::string Script::replay_json() const { return parts_->replay ? parts_->replay->as_json() : ""; }

std::vector<LiveKey> Script::live(std::optional<int> frame) const {
  const double time = frame ? parts_->start.time_after(*frame) : parts_->first_moment();
  Config document = parts_->document_at(time, parts_->changes.size());
  open_tables(document);
  for (const BodyDef& body : parts_->start.bodies) {
    open_table_of(document, "body." + body.name + ".contact.self");
    if (body.cloth) open_table_of(document, "body." + body.name + ".drag.normal");
  }
  (void)read_scene(document);
  return live_keys(document);
}

}  // namespace supple
