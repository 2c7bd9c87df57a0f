#include "live/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/error.h"
#include "base/interrupts.h"
#include "base/text.h"
#include "film/record/unsolved_words.h"
#include "output/files/json_text.h"
#include "scene/config/config.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::chrono::milliseconds between_looks{100};  // from one look for a request to end the program to the next
constexpr int most_late = 3;                             // frames that the film may catch up after a slow one
constexpr std::size_t frames_of_rate = 30;               // the frames over which the rate is measured
constexpr std::size_t frames_of_budget = 10;             // after so many the budget follows what frames take
constexpr int frames_between_words = 10;
constexpr double tolerance = 1.0 / 250;  // of a grab's way, over the picture's height: two pixels of 540
constexpr const char* budget_path = "solver.budget_ms";
constexpr double furthest = 0.3;  // the longest way of a grab in a frame, over the body's size

// Returns what is wrong, as short as a page can show it. Where a value is wrong because of the values beside it, the
// message says only that: which values these are helps only somebody who writes a replay's file.
std::string message_of(const InputError& error) {
  std::string text;
  for (const Problem& problem : error.problems()) text += (text.empty() ? "" : "; ") + problem.message;
  constexpr std::string_view together = "does not go with what stands beside it";
  if (const std::size_t at = text.find(together); at != std::string::npos)
    text =
        text.substr(0, at + together.size()) + ": it wants other values than there are, which a replay's file can give";
  return text;
}

std::string vector_text(const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

std::string keys_text(const std::vector<MotionKey>& keys) {
  std::string text;
  for (const MotionKey& key : keys)
    text += fmt::format("{}{{ t = {}, move = {} }}", text.empty() ? "" : ", ", key.time, vector_text(key.move));
  return "[" + text + "]";
}

}  // namespace

// Holds what a pointer has grabbed.
struct LiveSession::Grabbed {
  std::string body, name;
  Vec3 place;               // where the pointer took hold [m]
  Eigen::Vector2d pointer;  // in the picture
  GrabbedWay way;
};

LiveSession::LiveSession(LiveDesk& desk, World& world, FrameLoop& loop, ReplayKeeper& keeper, bool starts_paused)
    : desk_(desk),
      world_(world),
      loop_(loop),
      keeper_(keeper),
      events_(desk.events, world),
      timeline_(world),
      saved_(std::make_shared<std::atomic<std::size_t>>(0)) {
  state_.paused = starts_paused;
  draw_on_new_stage();
  events_.tell_controls();
  tell_words();
  tell_state();
}

LiveSession::~LiveSession() { desk_.mailbox.close(); }

std::string LiveSession::play() {
  for (;;) {
    std::string message;
    FilmEnd end = FilmEnd::failed;
    try {
      end = loop_.run(*this, message);
    } catch (const std::exception& error) {
      message = error.what();
    }
    keeper_.keep(notes());
    const std::string undrawn = desk_.pictures.error();
    if (end == FilmEnd::interrupted || !undrawn.empty()) {
      events_.tell_end(undrawn.empty() ? "the program has ended" : undrawn);
      return undrawn;
    }
    recover(message);
  }
}

// Goes back to the last whole frame after a step that failed, without what was done since.
void LiveSession::recover(const std::string& message) {
  state_.paused = true;
  failure_ = message +
             "; the film is back at its last whole frame, without what was done after it. Where that is spoilt "
             "already, go back further";
  go(timeline_.frames());
  events_.say(failure_);
}

std::optional<FilmEnd> LiveSession::ends() {
  for (;;) {
    if (interrupted()) return FilmEnd::interrupted;
    serve_commands();
    if (!desk_.pictures.error().empty()) return FilmEnd::failed;
    if (desk_.pictures.has_own_view() != state_.own_view) tell_state();
    if (keeper_.error() != told_error_) tell_words();
    const Clock::time_point now = Clock::now();
    const bool runs = !state_.paused && desk_.is_followed && now >= due_;
    if (std::exchange(steps_once_, false) || runs) break;
    desk_.mailbox.wait_until(now < due_ && !state_.paused ? std::min(due_, now + between_looks) : now + between_looks);
  }
  const std::chrono::duration<double, std::milli> period(period_ms());
  const auto ticks = std::chrono::duration_cast<Clock::duration>(period);
  begun_ = Clock::now();
  due_ = std::max(due_, begun_ - most_late * ticks) + ticks;
  release_dropped();
  move_to_pointer();
  return std::nullopt;
}

void LiveSession::take(FrameRow row) {
  const Clock::time_point now = Clock::now();
  frame_ms_.push_back(std::chrono::duration<double, std::milli>(now - begun_).count());
  if (frame_ms_.size() > frames_of_budget) frame_ms_.pop_front();
  ended_.push_back(now);
  if (ended_.size() > frames_of_rate) ended_.pop_front();
  events_.tell_frame(row, measured_rate(), desk_.pictures.picture_ms());
  tally_.add(row);
  failure_.clear();
  timeline_.add(row, world_);
  const int frames = world_.frames();
  if (frames % frames_between_words == 0) {
    tell_words();
    if (!world_.script().at_work(frames).empty()) events_.tell_controls();
  }
  if (state_.keeps_rate && frames % int(frames_of_budget) == 0) adjust_budget();
  if (keeper_.wants_notes()) keeper_.keep(notes());
}

void LiveSession::serve_commands() {
  for (const PostedCommand& posted : desk_.mailbox.take()) serve(posted);
  if (std::exchange(controls_changed_, false)) events_.tell_controls();
}

void LiveSession::serve(const PostedCommand& posted) {
  if (posted.command.kind == CommandKind::save) return save(posted);
  try {
    desk_.pictures.note_input(posted.input);
    Json json = {{"input", posted.input}};
    json.update(carry_out(posted.command));
    posted.reply->give({200, json_text(json)});
  } catch (const InputError& error) {
    posted.reply->give(refusal_of(422, message_of(error)));
  } catch (const std::exception& error) {
    posted.reply->give(refusal_of(500, error.what()));
  }
}

void LiveSession::save(const PostedCommand& posted) {
  const auto take = [reply = posted.reply, saved = saved_, edits = timeline_.edits(),
                     name = world_.script().scene().name](const ReplayFiles& files, const std::string& error) {
    if (!error.empty()) return reply->give(refusal_of(500, error));
    Json json = {{"name", name + "-live.toml"}, {"replay", files.replay_text}};
    json["scene_name"] = files.scene.empty() ? Json(nullptr) : Json(files.scene.filename().string());
    json["scene"] = files.scene.empty() ? Json(nullptr) : Json(files.scene_text);
    reply->give({200, json_text(json)});
    *saved = edits;
  };
  if (!keeper_.write(notes(), take)) posted.reply->give(refusal_of(429, "too many ask for the replay"));
}

// Notes what was done, so that it can be done again.
void LiveSession::note(TimedEdit edit) {
  loop_.end_repeats();  // an earlier session's budgets are those of another motion from here on
  timeline_.add(std::move(edit));
}

LiveSession::Json LiveSession::carry_out(const Command& command) {
  switch (command.kind) {
    case CommandKind::set: change(command.path, command.value, command.over); break;
    case CommandKind::pause: state_.paused = true; break;
    case CommandKind::run:
      state_.paused = false;
      due_ = Clock::now();
      ended_.clear();
      break;
    case CommandKind::step: state_.paused = steps_once_ = true; break;
    case CommandKind::speed:
      state_.speed = command.factor;
      due_ = Clock::now();
      ended_.clear();
      break;
    case CommandKind::restart: go(0); break;
    case CommandKind::go: go(command.frame); break;
    case CommandKind::grab: return grab(command);
    case CommandKind::drag: drag(command); return Json::object();
    case CommandKind::drop: drop(command.on); break;
    case CommandKind::release: release(command.body, command.name); break;
    case CommandKind::keep_view: keep_view(); break;
    case CommandKind::show: show(command); break;
    case CommandKind::keep_rate: keep_rate(command.on); break;
    case CommandKind::orbit:
    case CommandKind::pan:
    case CommandKind::zoom:
    case CommandKind::home:
    case CommandKind::save: break;  // serve() saves, and the views do not come here (server.cpp)
  }
  tell_state();
  return Json::object();
}

// Changes a value from the next frame on, as a replay does.
void LiveSession::change(const std::string& path, const std::string& value, double over) {
  const auto parsed = ConfigValue::parse(value, path);
  TimedChange change{path,
                     {},
                     0,
                     over,
                     Ease::smooth,
                     RampRule::difference,
                     false,
                     {},
                     {},
                     parsed ? *parsed : ConfigValue::parse(toml_text(value), path).value(),
                     {path}};
  world_.change(change);
  note({world_.frames(), std::move(change)});
  controls_changed_ = controls_changed_ || !path.ends_with(".keys");
}

std::string LiveSession::name_for_grab(const Body& body) const {
  for (std::size_t number = 1 + world_.script().edits().grabs.size();; ++number) {
    std::string name = fmt::format("hand-{}", number);
    if (std::ranges::find(body.def.handles, name, &HandleDef::name) == body.def.handles.end()) return name;
  }
}

LiveSession::Json LiveSession::grab(const Command& command) {
  const OutputDef& output = world_.scene().output;
  const double aspect = double(output.width) / output.height;
  const Camera camera = desk_.pictures.seen();
  const std::optional<Pick> found = pick(world_, camera, aspect, command.at);
  if (!found) throw InputError("grab", "nothing is there");
  if (grabbed_) drop(false);
  tell_state();
  const Body& body = world_.bodies()[found->body];
  const std::string name = name_for_grab(body);
  const LiveGrab grab{body.def.name, name, found->vertices, found->stiffness};
  world_.grab(grab);
  note({world_.frames(), grab});
  grabbed_ = std::make_unique<Grabbed>(Grabbed{body.def.name, name, found->place, command.at,
                                               GrabbedWay(tolerance * picture_height_at(camera, found->place),
                                                          furthest * world_.body(found->body).model().size)});
  tell_state();
  return {{"grab", name}, {"body", body.def.name}};
}

void LiveSession::drag(const Command& command) {
  if (!grabbed_) throw InputError("drag", "nothing is grabbed");
  grabbed_->pointer = command.at;
}

// Plans the way of what is grabbed so that it is where the pointer is when the next frame ends.
void LiveSession::move_to_pointer() {
  if (!grabbed_) return;
  const SceneDef& scene = world_.scene();
  const double aspect = double(scene.output.width) / scene.output.height;
  const Vec3 there = point_in_plane(desk_.pictures.seen(), aspect, grabbed_->pointer, grabbed_->place);
  const auto keys = grabbed_->way.follow(scene.time_after(world_.frames()), 1 / scene.fps, there - grabbed_->place);
  if (!keys) return;
  try {
    change(fmt::format("body.{}.handles.{}.keys", grabbed_->body, grabbed_->name), keys_text(*keys), 0);
  } catch (const InputError& error) {
    events_.say(message_of(error));
  }
}

void LiveSession::drop(bool stays) {
  if (!grabbed_) return;
  const auto held = std::exchange(grabbed_, nullptr);
  if (stays) {
    pins_.push_back({held->name, world_.frames()});
  } else {
    release(held->body, held->name);
  }
}

// Lets a grab go, in the frame after the one in which it takes hold if need be.
void LiveSession::release(const std::string& body, const std::string& name) {
  const auto is_this = [&](const LiveGrab& grab) { return grab.body == body && grab.name == name; };
  const std::vector<LiveGrab> all = holding();
  const auto grab = std::ranges::find_if(all, is_this);
  if (grab != all.end() && grab->from >= world_.scene().time_after(world_.frames() - 1)) {
    if (!is_pending(*grab)) pending_.push_back({body, name});
    return;
  }
  world_.release(body, name);
  note({world_.frames(), Release{body, name}});
}

void LiveSession::release_dropped() {
  if (pending_.empty()) return;
  for (const Release& dropped : std::exchange(pending_, {})) release(dropped.body, dropped.handle);
  tell_state();
}

bool LiveSession::is_pinned(const LiveGrab& grab) const {
  return std::ranges::find(pins_, grab.name, &Pin::name) != pins_.end();
}

bool LiveSession::is_pending(const LiveGrab& grab) const {
  return std::ranges::any_of(pending_,
                             [&grab](const Release& one) { return one.body == grab.body && one.handle == grab.name; });
}

// Returns the grabs that hold, and those that will in the next frame.
std::vector<LiveGrab> LiveSession::holding() const {
  std::vector<LiveGrab> grabs;
  for (const LiveGrab& grab : world_.script().edits().grabs)
    if (std::isinf(grab.until)) grabs.push_back(grab);
  return grabs;
}

// Goes back to where the film had this many frames, without what was done after them.
void LiveSession::go(int frames) {
  const int made = timeline_.frames();
  if (frames > made) throw InputError("frame", fmt::format("the film has {} so far", count_text(made, "frame")));
  if (frames < made) keeper_.keep(notes());  // what is left behind
  grabbed_.reset();
  pending_.clear();
  const std::uint64_t hash = frames > 0 ? timeline_.played().hashes[std::size_t(frames - 1)] : 0;
  const WorldState state = timeline_.state_before(frames, world_.script().edits());
  loop_.go_to(state, FrameRows());  // before frames are made again: the pictures see all that was changed
  std::string failure;
  try {
    (void)timeline_.remake(frames, world_, interrupted);
  } catch (const std::exception& error) {
    failure = error.what();
    loop_.go_to(state, FrameRows());
  }
  const std::size_t edits = timeline_.edits();
  timeline_.cut(world_.frames());
  *saved_ = std::min(saved_->load(), timeline_.edits());
  loop_.go_to(world_.state(), FrameRows());
  if (!failure.empty()) {
    events_.say(fmt::format("{}; the film is back at frame {}", failure, world_.frames()));
  } else if (frames > 0 && world_.frames() == frames && world_.hash() != hash) {
    events_.say(fmt::format("frame {} came out with other bits than before", frames));
  }
  std::erase_if(pins_, [this](const Pin& pin) { return pin.frames > world_.frames(); });
  for (const LiveGrab& grab : holding())
    if (!is_pinned(grab)) release(grab.body, grab.name);
  if (world_.frames() < made) tally_ = {};
  ended_.clear();
  due_ = Clock::now();
  if (edits > timeline_.edits()) {
    keeper_.keep_apart(notes());
  } else {
    keeper_.keep(notes());
  }
  loop_.show_again();
  controls_changed_ = true;
  tell_words();
  tell_state();
}

// Lets the target draw on the loop's stage, beginning with the world as it is.
void LiveSession::draw_on_new_stage() {
  desk_.pictures.begin(*loop_.stage());
  loop_.show_again();
}

void LiveSession::show(const Command& command) {
  const std::string field = command.field.value_or(state_.field);
  const bool wireframe = command.wireframe.value_or(state_.wireframe), marks = command.marks.value_or(state_.marks);
  loop_.change_look({fmt::format("field.quantity={}", field), fmt::format("look.wireframe={}", wireframe),
                     fmt::format("look.marks={}", marks)});
  state_.field = field;
  state_.wireframe = wireframe;
  state_.marks = marks;
  draw_on_new_stage();
}

void LiveSession::keep_view() {
  const Camera camera = desk_.pictures.seen();
  change("camera",
         fmt::format("{{ position = {}, target = {}, fov_deg = {} }}", vector_text(camera.eye),
                     vector_text(camera.target), camera.fov_deg),
         0);
  events_.say("the film of the replay has this view from here on");
}

// Makes steps end when their share of a frame's time is over, or ends this. All budgets of the scene are set: its own,
// and those of bodies that have one.
void LiveSession::keep_rate(bool on) {
  if (on == state_.keeps_rate) return;
  if (on) {
    budgets_before_.clear();
    for (const LiveKey& key : world_.script().live(world_.frames()))
      if (key.key.path.ends_with(budget_path)) budgets_before_.emplace_back(key.key.path, key.key.value);
    if (budgets_before_.empty()) throw InputError("keep_rate", "no body's solver has a budget of time");
    budget_ms_ = period_ms() / double(world_.size() * std::size_t(world_.scene().substeps));
    set_budgets(budget_ms_);
  } else {
    for (const auto& [path, value] : budgets_before_) change(path, value, 0);
  }
  state_.keeps_rate = on;
}

void LiveSession::set_budgets(double ms) {
  budget_ms_ = ms;
  for (const auto& [path, before] : budgets_before_) change(path, fmt::format("{:.2f}", ms), 0);
}

// Gives steps more time where the last frames were too quick, and less where they were too slow.
void LiveSession::adjust_budget() {
  constexpr double used = 0.95, least = 0.3;  // of the time that a frame has; of a budget [ms]
  std::vector<double> took(frame_ms_.begin(), frame_ms_.end());
  std::ranges::sort(took);
  const double steps = double(world_.size()) * world_.scene().substeps;
  const double spare = used * period_ms() - took[took.size() / 2];
  const double budget = std::clamp(budget_ms_ + 0.7 * spare / steps, least, std::max(least, period_ms() / steps));
  if (std::abs(budget - budget_ms_) > 0.05 * budget_ms_) set_budgets(budget);
}

ReplayNotes LiveSession::notes() const { return {timeline_.frames(), world_.script().edits(), timeline_.played()}; }

// Returns how fast the film runs, over the speed that is wanted; 1 until it is known.
double LiveSession::measured_rate() const {
  if (ended_.size() < 2) return 1;
  const std::chrono::duration<double> took = ended_.back() - ended_.front();
  return double(ended_.size() - 1) / (world_.scene().fps * state_.speed * took.count());
}

bool LiveSession::has_unsaved_edits() const { return timeline_.edits() > *saved_; }

void LiveSession::tell_state() {
  state_.frames = world_.frames();
  state_.own_view = desk_.pictures.has_own_view();
  state_.grabbed = grabbed_ ? grabbed_->name : "";
  state_.pins.clear();
  for (const LiveGrab& grab : holding())
    if (is_pinned(grab) && !is_pending(grab)) state_.pins.push_back(grab);
  events_.tell_state(state_);
}

void LiveSession::tell_words() {
  tally_.set_unsolved_words({.meant = bodies_meant_unsolved(world_.scene())});
  std::vector<std::string> words = tally_.warnings();
  if (!failure_.empty()) words.insert(words.begin(), failure_);
  told_error_ = keeper_.error();
  if (!told_error_.empty()) words.push_back(told_error_);
  events_.tell_words(words);
}

}  // namespace supple
