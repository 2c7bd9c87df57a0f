#include "app/split_draw.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/console.h"
#include "base/error.h"
#include "base/interrupts.h"
#include "base/text.h"
#include "base/timing.h"
#include "film/places.h"
#include "film/progress.h"
#include "output/json_text.h"
#include "output/png_file.h"
#include "output/run_folder.h"
#include "output/run_record.h"

namespace supple {
namespace {

// Returns the name of a run: the last folder of its path, and the method of its only body.
std::string name_of_run(const std::filesystem::path& run, const SceneDef& scene) {
  const std::filesystem::path path = std::filesystem::absolute(run / "").lexically_normal().parent_path();
  std::string name = path.filename().string();
  if (scene.bodies.size() == 1) name += fmt::format(" ({})", name_of(scene.bodies.front().solver.method));
  return name;
}

// Returns the plan of one run: its pictures share the width or the height of the whole.
DrawPlan plan_of_panel(const SplitCommand& command, const std::string& run, int columns) {
  DrawPlan plan = command.plan;
  plan.run = run;
  const LoadedDrawing whole = load_drawing(plan);
  const OutputDef& output = whole.film.script.scene().output;
  const auto share = [columns](int size) { return std::max(16, size / columns / 2 * 2); };
  plan.settings.push_back(fmt::format("output.width={}", share(output.width)));
  // Panels in a row are narrow, so that they keep more of the height than of the width.
  plan.settings.push_back(
      fmt::format("output.height={}", columns > 2 ? share(output.height) * 3 / 4 * 2 : share(output.height)));
  return plan;
}

// Holds what has been drawn of all runs.
struct Drawn {
  std::vector<Panel> panels;
  std::vector<int> frames;  // of the runs, by picture: as many as all of them have
  double rate = 0;
  DrawResult result;
};

void draw_panel(const SplitCommand& command, const std::string& run, int columns, Drawn& drawn) {
  const DrawPlan plan = plan_of_panel(command, run, columns);
  LoadedDrawing drawing = load_drawing(plan);
  const std::filesystem::path folder = command.folder / fmt::format("panel-{}", drawn.panels.size() + 1);
  open_drawing(folder, drawing, false);
  const auto count = static_cast<int>(drawing.frames.size());
  Progress progress(count, 0, command.quiet);
  drawn.result = draw_pictures(plan, drawing, folder, {0, count}, nullptr, [&progress](int done) {
    if (done > 0) progress.show(done);
  });
  progress.end();
  if (drawn.panels.empty()) drawn.rate = drawing.rate;
  if (drawn.panels.empty() || drawing.frames.size() < drawn.frames.size()) drawn.frames = drawing.frames;
  drawn.panels.push_back({folder / "frames", name_of_run(run, drawing.film.script.scene()), read_run(run).rows});
}

int make_film_of(const SplitCommand& command, const Drawn& drawn, int columns) {
  const std::string font = caption_font(), file = film_file(command.coding.format);
  std::optional<VideoEncoder> video;
  for (std::size_t picture = 0; picture < drawn.frames.size() && !interrupted(); ++picture) {
    const auto number = static_cast<int>(picture);
    const Image image = split_picture(drawn.panels, columns, font, number, drawn.frames[picture]);
    write_png(picture_file(command.folder / "frames", number), image.width, image.height, image.rgb);
    if (!video && !file.empty())
      video.emplace(command.folder / file, image.width, image.height, drawn.rate, command.coding);
    if (video) video->add(image.rgb);
  }
  if (interrupted()) return 130;
  if (video) {
    const VideoResult end = video->finish();
    if (end.outcome == VideoOutcome::failed)
      throw RunError(fmt::format("no film: {}; the pictures are whole. {}", end.reason, end.told));
    if (!command.quiet)
      say(stdout, end.outcome == VideoOutcome::written
                      ? fmt::format("  film     {}\n", (command.folder / file).string())
                      : fmt::format("  no film: {}\n", end.reason));
  }
  return 0;
}

// Takes the folder over, as a single drawing does; draw.json tells which runs it holds.
void open_split(const SplitCommand& command) {
  DrawPlan first = command.plan;
  first.run = command.runs.front();
  LoadedDrawing drawing = load_drawing(first);
  nlohmann::ordered_json identity = {{"runs", nlohmann::ordered_json::array()}, {"layout", name_of(command.layout)}};
  for (const std::string& run : command.runs)
    identity["runs"].push_back(std::filesystem::absolute(run).lexically_normal().string());
  drawing.identity = json_text(identity, 1) + "\n";
  open_drawing(command.folder, drawing, false);
}

}  // namespace

int draw_split(const SplitCommand& command) {
  const Stopwatch watch;
  open_split(command);
  catch_interrupts();
  const int columns = columns_of(command.layout, static_cast<int>(command.runs.size()));
  Drawn drawn;
  for (const std::string& run : command.runs) {
    draw_panel(command, run, columns, drawn);
    if (drawn.result.end == FilmEnd::failed) throw RunError(drawn.result.message);
    if (drawn.result.end == FilmEnd::interrupted) {
      say(stderr, fmt::format("supple: interrupted\n  kept: the pictures so far in {}\n", command.folder.string()));
      return 130;
    }
  }
  const int status = make_film_of(command, drawn, columns);
  if (status == 0 && !command.quiet)
    say(stdout, fmt::format("  {} pictures of {} runs in {}\n", drawn.frames.size(), drawn.panels.size(),
                            duration_text(watch.elapsed_ms() / 1000)));
  return status;
}

}  // namespace supple
