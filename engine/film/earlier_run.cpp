#include "film/earlier_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/interrupts.h"
#include "base/text.h"
#include "base/timing.h"
#include "base/trace.h"
#include "film/plan/loaded_film.h"
#include "film/plan/run_plan.h"
#include "film/record/checkpoint.h"
#include "film/record/film_identity.h"
#include "film/record/repeated_cuts.h"
#include "output/files/json_text.h"
#include "output/motion/point_cache.h"
#include "output/run/run_folder.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

RunRecord run_with_frame(const EarlierFrame& from) {
  RunRecord run = read_run(from.run);
  int frames = std::numeric_limits<int>::max();
  const auto info = parsed_json<Json>(run.info_json);
  for (const Json& mesh : info.value("meshes", Json::array()))
    frames = std::min(frames, PointCacheReader(run.motion(mesh.at("body").get<std::string>())).frames());
  if (frames == 0) throw InputError(run.folder.string(), "has no frame yet to go on from");
  if (from.frame >= frames)
    throw InputError(run.folder.string(), fmt::format("has frames 0 to {}, and no frame {}", frames - 1, from.frame));
  return run;
}

// Loads the film of the run again, so that its steps can be made. plan: the plan of the film that goes on from the run.
LoadedFilm film_of_run(const RunRecord& run, const EarlierFrame& from, const FilmPlan& plan, const Solvers& solvers) {
  FilmPlan earlier = plan_of_run(run, {}, {});
  earlier.pictures = FilmPictures::none;
  earlier.threads = plan.threads;
  earlier.cache = plan.cache;
  earlier.quiet = plan.quiet;
  LoadedFilm film = load_film(earlier, {});
  try {
    check_same_motion(run, film);
  } catch (const InputError& changed) {
    std::vector<Problem> problems = changed.problems();
    problems.push_back(
        {from.place, fmt::format("the steps of {} are made again, for which its scene has to be as it was: "
                                 "what is new stands in another file, or in --set",
                                 from.run.string())});
    throw InputError(std::move(problems));
  }
  go_on_from_run(earlier, solvers, film.world);
  return film;
}

// Returns the run's checkpoint, if it has one of at most this many frames that this program has written on this
// machine.
std::optional<WorldState> checkpoint_of(const RunRecord& run, const LoadedFilm& film, int frames) {
  const std::string identity = identity_of(film.info, film.world.script(), film.world.bodies(), FilmPlan());
  try {
    WorldState state = read_motion_checkpoint(RunFolder::checkpoint_of(run.folder), identity);
    if (state.frames <= frames) return state;
  } catch (const InputError&) {  // there is none, or another program has written it: the run is made from its start
  }
  return std::nullopt;
}

// Makes the frames that are left until so many are made. cuts: where budgets of time ended the run's steps, by body;
// empty where the run had none.
void play_until(World& world, int frames, const std::vector<CutsByFrame>& cuts) {
  while (world.frames() < frames) {
    const int frame = world.frames();
    const bool made = world.play(frame, {[&](std::size_t body, int substep) {
                                           if (!cuts.empty())
                                             world.body(body).repeat(cuts_at(cuts[body], frame, substep));
                                         },
                                         {}});
    if (!made) throw RunError(fmt::format("frame {} of the run, which is made again, fails", frame));
    if (interrupted()) throw RunError("interrupted before the first frame");
  }
}

// Returns what a world's scene says of a body after the frames that the world has entered: its table, or all that may
// bear on it where a table makes several bodies.
Json table_of_body(const World& world, std::size_t body) {
  const auto scene = parsed_json<Json>(world.script().scene_json_at(world.frames() - 1));
  const Json& tables = scene.at("body");
  if (tables.size() == world.size()) return tables.at(body);
  return Json::array(
      {world.bodies()[body].def.name, tables, scene.value("scatter", Json()), scene.value("seed", Json())});
}

// Tells whether what a body's solver remembers holds for the body of the film too.
bool is_same_model(const World& earlier, std::size_t there, const World& world, std::size_t here) {
  const Json a = table_of_body(earlier, there), b = table_of_body(world, here);
  return a == b && earlier.scene().time_step() == world.scene().time_step();
}

// Tells whether two worlds have colliders of the same names in the same order: bounces know colliders by their numbers.
bool have_same_colliders(const World& a, const World& b) {
  return std::ranges::equal(a.colliders().colliders, b.colliders().colliders, {}, &Collider::name, &Collider::name);
}

EarlierState state_of(const MovingBody& body) {
  const Model& model = body.model();
  const State& state = body.state();
  EarlierState earlier;
  earlier.x = in_input_order(model, state.x);
  earlier.v = in_input_order(model, state.v);
  earlier.time = state.time;
  earlier.flow = state.flow;
  earlier.memory = state.memory;
  earlier.bounces = state.bounces;
  for (std::size_t h = 0; h < state.anchors.holds.size(); ++h) {
    EarlierState::Held held{
        body.body().def.handles[h].name, {}, {}, state.anchors.centers[h], state.anchors.holds[h] != 0};
    std::vector<Eigen::Index> rows;
    for (std::size_t i = 0; i < model.handled.size(); ++i) {
      if (model.handled[i].handle != std::int32_t(h)) continue;
      held.vertices.push_back(model.input_of[model.handled[i].vertex]);
      rows.push_back(Eigen::Index(i));
    }
    held.points = state.anchors.points(rows, Eigen::all);
    earlier.handles.push_back(std::move(held));
  }
  return earlier;
}

bool have_same_mesh(const Body& a, const Body& b) {
  const auto same = [](const auto& one, const auto& other) { return one.rows() == other.rows() && one == other; };
  return a.description.mesh.rest.rows() == b.description.mesh.rest.rows() &&
         same(a.description.mesh.tets, b.description.mesh.tets) && same(surface_of(a), surface_of(b));
}

// Refuses a body to which the state of the run's body cannot be carried over.
void check_fits(const Body& body, const MovingBody& there, const EarlierFrame& from) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(
        {{from.place, fmt::format("body '{}' cannot go on from {}: {}", body.def.name, from.run.string(), why)}});
  };
  if (!have_same_mesh(body, there.body()))
    refuse(fmt::format("it has another mesh here, with {} vertices, and had {} there",
                       body.description.mesh.rest.rows(), there.body().description.mesh.rest.rows()));
  const Flow& flow = there.state().flow;
  if ((!flow.plastic.empty() && !body.def.plastic) || (!flow.viscous.empty() && !body.def.creep))
    refuse("it has flowed there, and would spring back without its `plastic` or `creep`");
  if (!flow.empty() && (flow.plastic.empty() != !body.def.plastic || flow.viscous.empty() != !body.def.creep))
    refuse("it flows in another way here: `plastic` and `creep` neither come nor go");
  for (const HandleDef& handle : body.def.handles) {
    const bool known =
        std::ranges::find(there.body().def.handles, handle.name, &HandleDef::name) != there.body().def.handles.end();
    if (!known && !handle.grabs)
      refuse(
          fmt::format("handle '{}', which it had not there, would pull it back to its place at rest; a handle with "
                      "`from` takes hold where the body is",
                      handle.name));
  }
}

// Returns those names that are not in `among`.
std::vector<std::string> missing(const std::vector<std::string>& names, const std::vector<std::string>& among) {
  std::vector<std::string> result;
  for (const std::string& name : names)
    if (std::ranges::find(among, name) == among.end()) result.push_back(name);
  return result;
}

// Refuses a clock that is not that of the run. The program fills it in, but a scene may say anything.
void check_clock(const EarlierFrame& from, double of_run, double of_film) {
  constexpr double round_off = 1e-6;  // [s]
  if (std::abs(of_run - of_film) < round_off) return;
  throw InputError({{from.place, fmt::format("clock: frame {} of {} ended at {:.9g} s, and not at {:.9g} s", from.frame,
                                             from.run.string(), of_run, of_film)}});
}

// Hands the states of the run's bodies over to the film's. Returns notes about bodies that only one of the two has.
std::vector<std::string> take_over(const World& earlier, const EarlierFrame& from, World& world) {
  const std::vector<std::string> there = names_of(earlier.bodies()), here = names_of(world.bodies());
  const std::vector<std::string> added = missing(here, there), gone = missing(there, here);
  if (added.size() == here.size())
    throw InputError(
        {{from.place, fmt::format("{} has no body of this film: it has {}", from.run.string(), word_list(there))}});
  for (std::size_t b = 0; b < here.size(); ++b) {
    const auto place = std::ranges::find(there, here[b]);
    if (place == there.end()) continue;
    const auto other = static_cast<std::size_t>(place - there.begin());
    check_fits(world.bodies()[b], earlier.body(other), from);
    EarlierState state = state_of(earlier.body(other));
    if (!is_same_model(earlier, other, world, b)) state.memory.reset();
    if (here != there || !have_same_colliders(earlier, world)) state.bounces.begun.clear();
    world.begin_from(b, std::move(state));
  }
  std::vector<std::string> notes;
  if (!added.empty()) notes.push_back(fmt::format("not in {}, and new here: {}", from.run.string(), word_list(added)));
  if (!gone.empty()) notes.push_back(fmt::format("in {}, and not here: {}", from.run.string(), word_list(gone)));
  return notes;
}

// Returns the cuts of a run whose steps ended by budgets of time; none where they did not.
std::vector<CutsByFrame> cuts_of(const RunRecord& run, const World& world, int frames) {
  std::vector<CutsByFrame> played = repeated_cuts(world.script().session(), names_of(world.bodies()));
  if (!played.empty()) return played;
  const bool budgets =
      std::ranges::any_of(world.scene().bodies, [](const BodyDef& body) { return body.solver.settings.budget_ms > 0; });
  return budgets ? repeated_cuts(run.folder, names_of(world.bodies()), frames) : std::vector<CutsByFrame>();
}

}  // namespace

void check_earlier_run(const SceneDef& scene) {
  if (scene.from) run_with_frame(*scene.from);
}

std::vector<std::string> go_on_from_run(const FilmPlan& plan, const Solvers& solvers, World& world) {
  const std::optional<EarlierFrame> from = world.script().scene().from;
  if (!from) return {};
  const Zone zone("earlier run");
  const Stopwatch watch;
  if (plan.preview || plan.rough > 0)
    throw InputError({{from->place, "a preview has other meshes than the run, and cannot go on from it"}});
  const RunRecord run = run_with_frame(*from);
  LoadedFilm film = film_of_run(run, *from, plan, solvers);
  World& earlier = film.world;
  Threads threads(film.info.threads);
  earlier.start(solvers, &threads);
  const int frames = from->frame + 1;
  if (const auto state = checkpoint_of(run, film, frames)) earlier.restore(*state);
  const int first = earlier.frames();
  play_until(earlier, frames, cuts_of(run, earlier, frames));
  check_clock(*from, earlier.scene().time_after(from->frame), world.scene().time_at_start());
  std::vector<std::string> notes = take_over(earlier, *from, world);
  const std::string again = first == frames ? "its checkpoint is used"
                                            : fmt::format("frames {} to {} were made again, in {:.1f} s", first,
                                                          from->frame, watch.elapsed_ms() / 1000);
  notes.insert(notes.begin(), fmt::format("goes on after frame {} of {}: {}", from->frame, from->run.string(), again));
  if (from->frame < std::ssize(run.rows) && run.rows[std::size_t(from->frame)].state_hash != earlier.hash())
    notes.push_back(
        fmt::format("frame {} of {} is not the same to the last bit as it was: another program or another "
                    "machine made the run",
                    from->frame, from->run.string()));
  return notes;
}

}  // namespace supple
