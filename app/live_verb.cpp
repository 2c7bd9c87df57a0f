#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>

#include "app/film_run.h"
#include "app/solvers.h"
#include "base/console.h"
#include "base/error.h"
#include "base/interrupts.h"
#include "base/text.h"
#include "base/trace.h"
#include "film/pictures/camera.h"
#include "film/plan/preview.h"
#include "film/plan/shipped_files.h"
#include "film/rough_motion.h"
#include "live/gate.h"
#include "live/server.h"

namespace supple {
namespace {

struct LiveCommand {
  FilmPlan plan;
  LiveAddress address;
  std::string record;  // file of the replay; empty: none
  bool paused = false;
};

// Returns the settings of the pictures' size where the command asks for none. Pictures of a page are smaller than those
// of films, so that they are drawn in time.
std::vector<std::string> size_settings(const LiveCommand& command, const OutputDef& output) {
  if (!command.plan.size.empty()) return {};
  constexpr int most_pixels = 960;
  const double smaller = std::min(1.0, double(most_pixels) / std::max(output.width, output.height));
  const int width = 2 * static_cast<int>(0.5 * smaller * output.width + 0.5);
  const int height = 2 * static_cast<int>(0.5 * smaller * output.height + 0.5);
  return picture_settings(output, width, height);
}

// Loads the scene with the size of the page's pictures, which its replay does not have.
LoadedFilm load(const LiveCommand& command, const std::vector<std::string>& words) {
  FilmPlan plan = command.plan;
  const Script script = Script::load(source_of(plan), assets_folder(), plan.settings);
  for (const std::string& setting : size_settings(command, script.scene().output)) plan.settings.push_back(setting);
  return load_film(plan, words);
}

void say_address(const LiveServer& server, const LiveCommand& command) {
  const bool is_loopback = reach_of(command.address.address) == Reach::loopback;
  say(stdout, fmt::format("Open {} in a browser on this machine; Ctrl-C here ends it\n", server.url()));
  std::fflush(stdout);
  if (command.plan.quiet) return;
  if (!is_loopback) {
    say(stderr, "warning: whoever can reach this address and knows it can watch, and steer: it is not encrypted\n");
  } else if (std::getenv("SSH_CONNECTION") != nullptr) {
    const std::string port = server.url().substr(server.url().rfind(':') + 1);
    const std::string number = port.substr(0, port.find('/'));
    say(stderr, fmt::format("from where you are: ssh -L {}:127.0.0.1:{} to this machine, then this address there\n",
                            number, number));
  }
}

// Returns the number of threads for the solver where none is asked for: one core is left to the pictures. Steps whose
// threads wait for each other suffer most where there are more threads than cores.
int usual_threads() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency()) - 1); }

int run(LiveCommand command, const std::vector<std::string>& words) {
  name_thread("main");
  if (command.plan.threads == 0) command.plan.threads = usual_threads();
  const FilmPlan& plan = command.plan;
  LoadedFilm film = load(command, words);
  catch_interrupts();
  go_on(plan, film);
  if (!plan.quiet) say_remarks(plan, film);
  build_models(plan, film);
  FilmStart start;
  start.repeated = repeated_cuts(film.world.script().session(), names_of(film.world.bodies()));
  // People on the page move the bodies. So the motion is found beforehand only where the camera asks for it.
  if (wants_motion(film.world.scene())) (void)find_framing(plan, start, all_solvers(), film);
  LiveDesk desk(plan.gl, shaders_folder());
  LiveServer server(desk, command.address, assets_folder() / "live");
  ReplayKeeper keeper(source_of(plan), plan.settings, command.record);
  FrameLoop loop(plan, film, start, nullptr, all_solvers(), FrameRows());
  loop.draw_on(desk.pictures);
  LiveSession session(desk, film.world, loop, keeper, command.paused);
  session.tell_scene(command.record);
  say_address(server, command);
  const std::string undrawn = session.play();
  const std::string unkept = keeper.finish();
  if (!plan.quiet) say(stderr, fmt::format("{} played\n", count_text(session.frames(), "frame")));
  if (!unkept.empty()) throw RunError(unkept);
  if (!command.record.empty() && session.frames() > 0 && !plan.quiet)
    say(stderr, fmt::format("  replay   {}: supple replay films it\n", command.record));
  if (command.record.empty() && session.has_unsaved_edits())
    say(stderr, "warning: what was done was not saved; --record-replay FILE keeps it as it grows\n");
  if (!undrawn.empty()) throw RunError(undrawn);
  return 0;
}

}  // namespace

void add_live(CommandLine& line) {
  auto command = std::make_shared<LiveCommand>();
  const std::vector<std::string> words = line.words();
  Verb verb = line.verb("live", "Play a scene on a page in the browser, and keep what was done as a replay.");
  verb.footer(
      "Example: supple live bunny, then open the address that it prints\n"
      "The page changes values, grabs, pauses, goes back and looks around: docs/live.md. Save gives a replay, of "
      "which\n"
      "supple replay FILE makes a film with the same bits.");
  FilmPlan& plan = command->plan;
  verb.option(
          "SCENE|REPLAY|MODEL", plan.scene,
          "scene, replay or model file, the name of one that ships (supple list), or - for a scene on standard input")
      .required();
  verb.option("--record-replay", command->record,
              "file for the replay, which is kept as it grows; none is written over");
  verb.option("--port", command->address.port, "of the page [one that is free]").between(1, 65535);
  verb.option("--listen", command->address.address,
              "address to listen to, over 127.0.0.1: others can then see the page who know its whole address");
  add_size_option(verb, plan.size, "the scene's, at most 960 pixels");
  verb.flag("--paused", command->paused, "wait before the first frame");
  verb.option("--threads", plan.threads, "threads of the solver [all cores but one]; results do not depend on it")
      .between(1, 256);
  verb.option("--set", plan.settings, "path=value over the scene's, such as solver.iterations=20; may be repeated")
      .repeatable();
  add_gl_option(verb, plan.gl);
  add_cache_option(verb, plan.cache);
  verb.flag("--quiet", plan.quiet, "say the address, and nothing but errors and warnings of what was not saved");
  verb.runs([command, words] {
    if (command->plan.scene == "-") take_scene(command->plan);
    return run(*command, words);
  });
}

}  // namespace supple
