#include "world_face.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "base/error.h"
#include "base/hash.h"
#include "base/read_file.h"
#include "base/text.h"
#include "film/earlier_run.h"
#include "film/plan/loaded_film.h"
#include "film/plan/shipped_files.h"
#include "film/record/body_recorder.h"
#include "output/files/whole_file.h"
#include "scene/replay/script_trial.h"
#include "sim/measures/fields.h"
#include "sim/measures/measures.h"

namespace supple::python {
namespace {

// Returns the value of an enum that a word names. Throws InputError.
template <Named E>
E word(const std::string& text, const char* place) {
  if (const auto value = value_named<E>(text)) return *value;
  throw InputError(place, fmt::format("'{}' is none of {}", text, word_list(all_names<E>())));
}

SceneSource source_of(const py::object& source) {
  if (py::isinstance<py::dict>(source)) return {"dict", document_of(source.cast<py::dict>())};
  return scene_file(path_of(source));
}

py::tuple tuple_of(const Vec3& v) { return py::make_tuple(v.x(), v.y(), v.z()); }

}  // namespace

void warn(const std::string& text) {
  const py::object kind = py::module_::import("supple").attr("SuppleWarning");
  if (PyErr_WarnEx(kind.ptr(), text.c_str(), 1) < 0) throw py::error_already_set();
}

WorldFace::WorldFace(const py::object& source, const py::dict& set, int threads) {
  if (threads < 0 || threads > 256) throw InputError("threads", "must be 1 to 256, or 0 for all cores");
  const SceneSource from = source_of(source);
  std::vector<std::string> settings = settings_of(set);
  {
    const py::gil_scoped_release others_run;
    Script script = load_script(from, settings);
    std::vector<Body> bodies = assemble(script.scene(), {UserCache::of_user(), {}});
    try_changes(script, bodies);
    for (const Problem& problem : said(all_warnings(script, bodies))) warnings_.push_back(problem.text());
    const int all = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    held_ = std::make_unique<Held>(threads > 0 ? threads : all, std::move(script), std::move(bodies));
    const std::string json = held_->world.script().scene_json() + held_->world.script().replay_json();
    scene_ = hash_bytes(json.data(), json.size());
    FilmPlan plan;
    plan.threads = threads;
    for (std::string& note : go_on_from_run(plan, held_->solvers.steps, held_->world))
      warnings_.push_back(std::move(note));
    held_->world.start(held_->solvers.steps, &held_->threads);
  }
  held_->errors.emplace(held_->world, held_->solvers, held_->threads);
  views_.resize(held_->world.size());
  for (std::size_t b = 0; b < held_->world.size(); ++b) {
    own_handles_.push_back(held_->world.bodies()[b].def.handles.size());
    own_handled_.push_back(std::ssize(held_->world.body(b).model().handled));
  }
  for (const std::string& text : warnings_) warn(text);
}

double WorldFace::time() {
  const Lock held = locked();
  return held->world.scene().time_after(held->world.frames() - 1);
}

WorldFace::~WorldFace() {
  if (getpid() == process_) return;
  (void)held_.release();  // its threads are in the process that made it
}

WorldFace::Lock WorldFace::locked() { return {Busy::Use(busy_), held_.get()}; }

WorldFace::Lock WorldFace::whole() {
  Lock held = locked();
  if (failed_ || held->world.is_within_frame())
    throw std::runtime_error(
        "a step of this frame has failed or was interrupted: step() finishes a frame that was "
        "interrupted, restore() goes back to a state");
  return held;
}

WorldPictures& WorldFace::Held::drawn() {
  if (!pictures) pictures = std::make_unique<WorldPictures>(world, threads);
  return *pictures;
}

int WorldFace::frame() {
  const Lock held = locked();
  return held->world.frames() - (failed_ || held->world.is_within_frame() ? 1 : 0);
}

void WorldFace::step(int frames, bool errors) {
  if (frames < 0) throw InputError("frames", "must not be negative");
  const Lock held = locked();
  for (int made = 0; made < frames; ++made) {
    take_frame(errors);
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

void WorldFace::take_frame(bool errors) {
  World& world = held_->world;
  if (failed_) throw std::runtime_error("a step of this frame has failed: restore() goes back to a state");
  bool interrupted = false, made = false;
  StepWatch watch;
  watch.prepared = [&](std::size_t b, int substep) {
    if (errors && substep + 1 == world.scene().substeps) held_->errors->before_step(b);
  };
  watch.made = [&](std::size_t b, int substep) {
    const StepReport& report = world.body(b).report();
    add_up(rows_[b], report);
    contacts_[b] = report.contacts.touching;
    if (errors && !report.failed && substep + 1 == world.scene().substeps) measured_[b] = held_->errors->of_step(b);
  };
  watch.stops = [&] {
    const py::gil_scoped_acquire interpreter;
    interrupted = PyErr_CheckSignals() != 0;
    return interrupted;
  };
  failed_ = true;  // until the steps are made: a matrix that cannot be factored throws
  {
    const py::gil_scoped_release others_run;
    if (!world.is_within_frame()) {
      world.enter(world.frames());
      rows_.assign(world.size(), {});
      contacts_.assign(world.size(), 0);
      measured_.assign(errors ? world.size() : 0, std::nullopt);
    }
    if (errors) measured_.resize(world.size());
    made = world.step(watch);
  }
  failed_ = !made && !interrupted;
  refresh();
  if (interrupted) throw py::error_already_set();
  for (std::size_t b = 0; b < world.size(); ++b) {
    const StepReport& report = world.body(b).report();
    failed_ = failed_ || (!made && report.failed);
    if (failed_) throw StepFailed(failure_text(world.frames() - 1, world.bodies()[b].def.name, report.failure));
    const bool meant = is_meant(world.bodies()[b].def, WarningKind::unsolved);
    if (made && rows_[b].unsolved && !meant && !std::exchange(warned_, true))
      warn(
          fmt::format("frame {}: a step of body '{}' did not come near its solution (said once; report has 'unsolved')",
                      world.frames() - 1, world.bodies()[b].def.name));
  }
}

py::dict WorldFace::report() {
  const Lock held = locked();
  py::dict report, bodies;
  double all = -held->world.saved_ms();
  for (std::size_t b = 0; b < rows_.size(); ++b) {
    const StepRow& row = rows_[b];
    all += row.step_ms;
    py::dict body;
    body["step_ms"] = row.step_ms;
    body["evaluate_ms"] = row.evaluate_ms;
    body["solve_ms"] = row.solve_ms;
    body["lbfgs_ms"] = row.lbfgs_ms;
    body["matrix_ms"] = row.matrix_ms;
    body["other_ms"] = row.other_ms;
    body["iterations"] = row.iterations;
    body["newton_iterations"] = row.newton_iterations;
    body["line_search"] = row.line_search;
    body["error_estimate"] = row.error_estimate;
    body["motion_estimate"] = row.motion_estimate;
    body["unsolved"] = row.unsolved;
    body["stop_reason"] = row.stop_reason;
    body["contacts"] = contacts_[b];
    bodies[held->world.bodies()[b].def.name.c_str()] = body;
  }
  py::list pairs;
  for (const BodyTouch& touch : rows_.empty() ? std::vector<BodyTouch>() : held->world.touches()) {
    py::dict pair;
    pair["bodies"] = py::make_tuple(held->world.bodies()[touch.a].def.name, held->world.bodies()[touch.b].def.name);
    pair["contacts"] = touch.contacts;
    pair["depth"] = touch.depth;
    pair["force"] = tuple_of(touch.force);
    pairs.append(pair);
  }
  report["frame"] = held->world.frames() - 1;
  report["step_ms"] = rows_.empty() ? 0.0 : all;
  report["bodies"] = bodies;
  report["pairs"] = pairs;
  return report;
}

py::dict WorldFace::error() {
  const Lock held = locked();
  if (measured_.empty()) throw std::runtime_error("no errors were measured: step(errors=True) measures them");
  py::dict errors;
  for (std::size_t b = 0; b < measured_.size(); ++b) {
    if (!measured_[b]) continue;
    py::dict body;
    body["error"] = measured_[b]->error ? py::object(py::float_(*measured_[b]->error)) : py::none();
    body["motion_error"] = measured_[b]->motion;
    body["reference_converged"] = measured_[b]->converged;
    errors[held->world.bodies()[b].def.name.c_str()] = body;
  }
  return errors;
}

std::vector<std::string> WorldFace::live() {
  std::vector<std::string> paths;
  for (const LiveKey& key : locked()->world.script().live()) paths.push_back(key.key.path);
  return paths;
}

void WorldFace::change(const std::string& path, const py::object& value, double over, const std::string& ease,
                       const std::string& by, const py::object& start) {
  const Lock held = whole();
  const std::string place = fmt::format("set {}", path);
  if (!(over >= 0) || !std::isfinite(over)) throw InputError(place, "over: must not be negative");
  const auto read = [&](const py::object& given) {
    const std::string text = toml_of(given, place);
    if (auto result = ConfigValue::parse(text, place)) return *result;
    throw InputError(place, fmt::format("{} is no value of a scene", text));
  };
  TimedChange change{path, {}, 0, over, {}, {}, false, {}, {}, read(value), {place}};
  change.ease = word<Ease>(ease, "ease");
  change.by = word<RampRule>(by, "by");
  if (!start.is_none()) change.from = read(start);
  if (change.from && over == 0) throw InputError(place, "start: of ramps, which take some time ('over')");
  held->world.change(std::move(change));
}

std::string WorldFace::grab(const std::string& body, const py::object& vertices, double stiffness, std::string name) {
  const Lock held = whole();
  const std::string place = fmt::format("grab of body '{}'", body);
  const std::size_t number = held->world.body_named(body);
  const std::vector<HandleDef>& handles = held->world.bodies()[number].def.handles;
  while (name.empty()) {  // a name is never given twice, so that a hand of a state that was left moves no other one
    const std::string free = fmt::format("grab_{}", ++grabs_);
    if (std::ranges::find(handles, free, &HandleDef::name) == handles.end()) name = free;
  }
  if (name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") != name.npos)
    throw InputError(place, fmt::format("name '{}': letters, digits, _ and - alone", name));
  if (!(stiffness > 0) || !std::isfinite(stiffness)) throw InputError(place, "stiffness: must be above 0 [N/m]");
  LiveGrab grab{body, name, {}, stiffness};
  for (const std::int32_t v : vertices_of(vertices, place, held->world.body(number).model().vertices))
    grab.vertices.push_back(v + 1);
  if (grab.vertices.empty()) throw InputError(place, "no vertices are given");
  held->world.grab(std::move(grab));
  return name;
}

void WorldFace::move(const std::string& body, const std::string& handle, const py::object& move,
                     const py::object& turn_deg) {
  bool first = false;
  {
    const Lock held = whole();
    const double now = held->world.scene().time_after(held->world.frames() - 1);
    const std::vector<LiveGrab>& grabs = held->world.script().edits().grabs;
    const bool holds = std::ranges::any_of(
        grabs, [&](const LiveGrab& grab) { return grab.body == body && grab.name == handle && grab.until > now; });
    if (!holds)
      throw InputError(handle, fmt::format("holds nothing of body '{}': it has let go, or was grabbed after the "
                                           "state that was restored",
                                           body));
    first = held->world.frames() == 0;
  }
  const auto key = [](double t, const Vec3& to, const Vec3& turn) {
    py::dict values;
    values["t"] = t;
    values["move"] = tuple_of(to);
    values["turn_deg"] = tuple_of(turn);
    return values;
  };
  // A change moves evenly over its frame, but before the first frame it holds from the start.
  py::list keys;
  if (first) keys.append(key(0, Vec3::Zero(), Vec3::Zero()));
  keys.append(key(first ? 1 / fps() : 0, vector_of(move, "move"), vector_of(turn_deg, "turn_deg")));
  change(fmt::format("body.{}.handles.{}.keys", body, handle), keys, 0, "smooth", "difference", py::none());
}

void WorldFace::restore(const Snapshot& snapshot) {
  const WorldState& state = snapshot.state;
  const Lock held = locked();
  bool suits = state.bodies.size() == held->world.size();
  for (std::size_t b = 0; suits && b < state.bodies.size(); ++b) {
    std::size_t handles = own_handles_[b];
    Eigen::Index handled = own_handled_[b];
    for (const LiveGrab& grab : state.edits.grabs) {
      if (grab.body != held->world.bodies()[b].def.name) continue;
      ++handles;
      handled += std::ssize(grab.vertices);
    }
    suits = state.bodies[b].x.rows() == held->world.body(b).model().vertices &&
            state.bodies[b].anchors.holds.size() == handles && state.bodies[b].anchors.points.rows() == handled;
  }
  if (!suits) throw InputError("state", "is of a world with other bodies or handles");
  {
    const py::gil_scoped_release others_run;
    held->world.restore(state);
  }
  failed_ = false;
  foreign_ = snapshot.foreign || snapshot.scene != scene_;
  rows_.clear();
  measured_.clear();
  refresh();
}

void WorldFace::save_replay(const py::object& path) {
  const Lock held = whole();
  if (held->world.frames() == 0) throw std::runtime_error("no frame was made that a replay could repeat");
  if (foreign_)
    throw std::runtime_error(
        "the state that was restored is of a world with other values, from which no replay can start");
  const std::filesystem::path file = std::filesystem::weakly_canonical(std::filesystem::absolute(path_of(path)));
  if (std::filesystem::exists(file) && !std::filesystem::is_regular_file(file))
    throw InputError(file.string(), "is no file that could be replaced");
  const ReplayFiles files = held->world.script().replay_files(file, held->world.frames());
  if (!files.scene.empty() && std::filesystem::exists(files.scene) && read_text(files.scene) != files.scene_text)
    throw InputError(files.scene.string(), "exists, and the replay would need this name for a scene of its own");
  if (!files.scene.empty()) write_whole_file(files.scene, files.scene_text);
  write_whole_file(file, files.replay_text);
}

Image WorldFace::draw(const std::vector<std::string>& settings) {
  const Lock held = whole();
  static const pid_t first = getpid();  // OpenGL has threads of its own, and a process inherits none
  if (first != getpid()) {
    throw RunError(
        "this process was forked from one that has drawn, and OpenGL does not outlive that: start pools with "
        "multiprocessing.get_context(\"spawn\")");
  }
  const py::gil_scoped_release others_run;
  return held->drawn().draw(settings);
}

std::vector<std::string> WorldFace::names() {
  std::vector<std::string> names;
  for (const Body& body : locked()->world.bodies()) names.push_back(body.def.name);
  return names;
}

void WorldFace::refresh() {
  for (std::size_t b = 0; b < views_.size(); ++b) {
    const MovingBody& body = held_->world.body(b);
    if (views_[b].x) sort_rows(body.model(), body.state().x, *views_[b].x);
    if (views_[b].v) sort_rows(body.model(), body.state().v, *views_[b].v);
  }
}

py::array WorldFace::view(std::size_t body, std::shared_ptr<Positions> Views::*rows) {
  Views& views = views_.at(body);
  const bool of_x = rows == &Views::x;
  py::object& array = of_x ? views.x_array : views.v_array;
  if (!array) {
    const Lock held = locked();
    const MovingBody& moving = held->world.body(body);
    views.*rows = std::make_shared<Positions>(moving.model().vertices, 3);
    sort_rows(moving.model(), of_x ? moving.state().x : moving.state().v, *(views.*rows));
    array = view_of(views.*rows);
  }
  return array;
}

py::array WorldFace::forces(std::size_t body) {
  const Lock held = locked();
  MovingBody& moving = held->world.body(body);
  if (!held->world.has_stepped() || !held->world.scene().may_touch())
    return copy_of(Positions(Positions::Zero(moving.model().vertices, 3)));
  return copy_of(contact_forces(moving.model(), moving.workspace(), moving.state().x));
}

py::array WorldFace::field(std::size_t body, const std::string& quantity) {
  const Lock held = whole();
  const auto wanted = word<FieldQuantity>(quantity, "field");
  if (wanted == FieldQuantity::none || wanted == FieldQuantity::distance)
    throw InputError("field", fmt::format("'{}' is no quantity of a body by itself", quantity));
  const std::vector<double> values = held->drawn().field(wanted).at(body);
  if (values.empty()) throw InputError("field", fmt::format("this body has no '{}'", quantity));
  return py::array_t<double>(py::ssize_t(values.size()), values.data());
}

py::array WorldFace::masses(std::size_t body) {
  const Lock held = locked();
  const Model& model = held->world.body(body).model();
  py::array_t<double> array(model.vertices);
  for (int v = 0; v < model.vertices; ++v)
    array.mutable_at(model.input_of[std::size_t(v)]) = model.mass[std::size_t(v)];
  return array;
}

py::dict WorldFace::deformation(std::size_t body) {
  const Lock held = locked();
  const MovingBody& moving = held->world.body(body);
  const Deformation shape = supple::deformation(moving.model(), moving.state().x, &held->threads);
  py::dict result;
  result["stretch"] = shape.stretch;
  result["inverted"] = shape.inverted;
  result["collapsed"] = shape.collapsed;
  return result;
}

}  // namespace supple::python
