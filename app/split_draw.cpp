#include "app/split_draw.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/console.h"
#include "base/error.h"
#include "base/interrupts.h"
#include "base/text.h"
#include "base/timing.h"
#include "film/plan/shipped_files.h"
#include "film/progress.h"
#include "output/files/folder_lock.h"
#include "output/files/json_text.h"
#include "output/files/png_file.h"
#include "output/run/run_folder.h"
#include "output/run/run_record.h"

namespace supple {
namespace {

// Returns the name of a run: the last folder of its path, followed by the method of its only body where the folder is
// not called so.
std::string name_of_run(const std::filesystem::path& run, const SceneDef& scene) {
  const std::filesystem::path path = std::filesystem::absolute(run / "").lexically_normal().parent_path();
  std::string name = path.filename().string();
  if (scene.bodies.size() != 1) return name;
  const std::string method(name_of(scene.bodies.front().solver.method));
  return name == method ? name : fmt::format("{} ({})", name, method);
}

// Returns the plan of one run: its pictures share the width or the height of the whole.
DrawPlan plan_of_panel(const SplitCommand& command, const std::string& run, int columns) {
  DrawPlan plan = command.plan;
  plan.run = run;
  plan.legend_apart = true;
  const LoadedDrawing whole = load_drawing(plan);
  const OutputDef& output = whole.film.world.script().scene().output;
  const auto share = [columns](int size) { return std::max(16, size / columns / 2 * 2); };
  plan.settings.push_back(fmt::format("output.width={}", share(output.width)));
  // Panels in a row are narrow, so that they keep more of the height than of the width.
  plan.settings.push_back(
      fmt::format("output.height={}", columns > 2 ? share(output.height) * 3 / 4 * 2 : share(output.height)));
  return plan;
}

// Holds what has been drawn of all runs.
struct Drawn {
  SplitScreen screen;
  std::vector<int> frames;  // the runs' frame by picture, for as many pictures as all of them have
  FrameRate rate = 30;
  DrawResult result;
};

void draw_panel(const SplitCommand& command, const std::string& run, int columns, Drawn& drawn) {
  const DrawPlan plan = plan_of_panel(command, run, columns);
  LoadedDrawing drawing = load_drawing(plan);
  const std::filesystem::path folder = command.folder / fmt::format("panel-{}", drawn.screen.panels.size() + 1);
  open_drawing(folder, drawing, false);
  const auto count = static_cast<int>(drawing.frames.size());
  Progress progress(count, 0, command.quiet);
  drawn.result = draw_pictures(plan, drawing, folder, {0, count}, nullptr, [&progress](int done) {
    if (done > 0) progress.show(done);
  });
  progress.end();
  drawn.screen.legend = drawn.result.legend;
  if (drawn.screen.panels.empty()) drawn.rate = drawing.rate;
  if (drawn.screen.panels.empty() || drawing.frames.size() < drawn.frames.size()) drawn.frames = drawing.frames;
  drawn.screen.panels.push_back(
      {folder / "frames", name_of_run(run, drawing.film.world.script().scene()), read_run(run).rows});
}

int make_film_of(const SplitCommand& command, const Drawn& drawn) {
  const std::string file = film_file(command.coding.chosen());
  std::optional<VideoEncoder> video;
  for (std::size_t picture = 0; picture < drawn.frames.size() && !interrupted(); ++picture) {
    const auto number = static_cast<int>(picture);
    const Image image = split_picture(drawn.screen, number, drawn.frames[picture]);
    write_png(picture_file(command.folder / "frames", number), image.width, image.height, image.rgb);
    if (!video && !file.empty()) {
      for (const std::string& warning : coding_warnings(command.coding, drawn.rate))
        say(stderr, fmt::format("warning: {}\n", warning));
      video.emplace(command.folder / file, image.width, image.height, drawn.rate, command.coding);
    }
    if (video) video->add(image.rgb);
  }
  if (interrupted()) return 130;
  if (video) {
    const VideoResult end = video->finish();
    if (end.outcome == VideoOutcome::failed)
      throw RunError(fmt::format("no film: {}; the pictures are whole. {}", end.reason, end.told));
    if (end.outcome != VideoOutcome::written) {
      say(stderr, fmt::format("warning: no film: {}; the pictures are whole\n", end.reason));
    } else if (!command.quiet) {
      say(stdout, fmt::format("  film     {}\n", (command.folder / file).string()));
    }
  }
  return 0;
}

// Refuses a run whose pictures have another size than those of the first one.
void require_same_size(const SplitCommand& command, const std::string& run, const OutputDef& output,
                       const OutputDef& first) {
  if (output.width == first.width && output.height == first.height) return;
  throw InputError(run, fmt::format("has pictures of {} x {} pixels, and {} has pictures of {} x {}: --size gives all "
                                    "runs one size",
                                    output.width, output.height, command.runs.front(), first.width, first.height));
}

// Gives the fields of all panels one range, the widest of theirs, so that equal colours mean equal values. Throws
// InputError where the runs' pictures have different sizes.
SplitCommand with_one_range(SplitCommand command) {
  std::optional<Eigen::Vector2d> all;
  std::optional<OutputDef> first;
  bool needs_range = true;
  for (const std::string& run : command.runs) {
    DrawPlan plan = command.plan;
    plan.run = run;
    LoadedDrawing drawing = load_drawing(plan);
    const SceneDef scene = drawing.film.world.script().scene();
    if (!first) first = scene.output;
    require_same_size(command, run, scene.output, *first);
    needs_range = needs_range && scene.field.quantity != FieldQuantity::none && !scene.field.range;
    if (!needs_range) continue;
    const Eigen::Vector2d range = field_range(drawing);
    all = all ? Eigen::Vector2d(std::min(all->x(), range.x()), std::max(all->y(), range.y())) : range;
  }
  if (needs_range && all) command.plan.settings.push_back(fmt::format("field.range=[{}, {}]", all->x(), all->y()));
  return command;
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

int draw_split(const SplitCommand& asked) {
  const Stopwatch watch;
  const FolderLock lock(asked.folder);
  const SplitCommand command = with_one_range(asked);
  open_split(command);
  catch_interrupts();
  const int columns = columns_of(command.layout, static_cast<int>(command.runs.size()));
  Drawn drawn;
  drawn.screen.columns = columns;
  drawn.screen.font = text_font();
  for (const std::string& run : command.runs) {
    draw_panel(command, run, columns, drawn);
    if (drawn.result.end == FilmEnd::failed) throw RunError(drawn.result.message);
    if (drawn.result.end == FilmEnd::interrupted) {
      say(stderr, fmt::format("supple: interrupted\n  kept: the pictures so far in {}\n", command.folder.string()));
      return 130;
    }
  }
  const int status = make_film_of(command, drawn);
  if (status == 0 && !command.quiet)
    say(stdout, fmt::format("  {} of {} runs in {}\n", count_text(long(drawn.frames.size()), "picture"),
                            drawn.screen.panels.size(), duration_text(watch.elapsed_ms() / 1000)));
  return status;
}

}  // namespace supple
