#include <fmt/core.h>
#include <stdlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include "app/film_run.h"
#include "app/jobs.h"
#include "app/split_draw.h"
#include "app/verbs.h"
#include "base/console.h"
#include "base/error.h"
#include "base/interrupts.h"
#include "base/read_file.h"
#include "base/text.h"
#include "base/timing.h"
#include "film/pictures/film_stills.h"
#include "film/pictures/picture_words.h"
#include "film/plan/film_coding.h"
#include "film/plan/shipped_files.h"
#include "film/progress.h"
#include "film/redraw/redraw.h"
#include "film/redraw/skin_files.h"
#include "output/files/folder_lock.h"
#include "output/files/png_file.h"
#include "output/files/whole_file.h"
#include "output/run/run_folder.h"

namespace supple {
namespace {

// Describes a drawing as the command line asks for it.
struct DrawCommand {
  DrawPlan plan;
  std::vector<std::string> runs;
  std::string run, scene, out, still;
  std::string size, field, range, reference;  // short forms of settings, as are the passes
  std::vector<std::string> passes;
  std::optional<std::size_t> frame, index;
  int of = 1, jobs = 1;
  bool merge = false, skins = false, sheet = false, quiet = false;
  FilmCoding coding;
  Layout layout = Layout::row;

  std::filesystem::path folder() const {
    if (!out.empty()) return out;
    std::string path = std::filesystem::path(run).lexically_normal().string();
    if (path.ends_with('/')) path.pop_back();
    return path + (skins ? "-skins" : "-drawn");
  }
};

// Reads --rate. A film of slow motion may have few pictures a second, and no player shows a thousand.
FrameRate rate_asked_for(const std::string& text) {
  constexpr double lowest = 0.01, highest = 1000;
  const std::optional<FrameRate> rate = FrameRate::parse(text);
  if (rate && *rate >= lowest && *rate <= highest) return *rate;
  throw InputError("--rate " + text, fmt::format("must be a number such as 25 or 23.976, or a fraction of two whole "
                                                 "numbers such as 30000/1001, from {:g} to {:g}",
                                                 lowest, highest));
}

int say_end(const DrawResult& result, const std::filesystem::path& folder) {
  if (result.end == FilmEnd::done) return 0;
  const bool interrupted = result.end == FilmEnd::interrupted;
  say(stderr, fmt::format("supple: {}\n  kept: {} whole pictures in {}\n", interrupted ? "interrupted" : result.message,
                          result.pictures, folder.string()));
  return interrupted ? 130 : 1;
}

void make_sheet(const DrawCommand& command, const LoadedDrawing& drawing) {
  const SceneDef& scene = drawing.film.world.script().scene();
  std::vector<double> times;
  for (int picture = 0; picture < picture_count(drawing); ++picture) {
    const Moment moment = moment_of(drawing, picture);
    times.push_back(scene.time_after(moment.frame) + moment.share / scene.fps);
  }
  const std::filesystem::path file = write_sheet(command.folder(), scene.title, times);
  if (!command.quiet) say(stdout, fmt::format("  sheet    {}\n", file.string()));
}

FilmCoding coding_of(const DrawCommand& command, const LoadedDrawing& drawing) {
  return coding_for(command.coding, drawing.film.world.script().scene());
}

// Ends the film and prints the result. Returns the exit status.
int finish_film(const DrawCommand& command, const LoadedDrawing& drawing, std::optional<VideoEncoder>& video,
                int pictures, double seconds) {
  if (command.sheet) make_sheet(command, drawing);
  if (!video) {
    if (!command.quiet)
      say(stdout, fmt::format("  {} in {}\n", count_text(pictures, "picture"), duration_text(seconds)));
    return 0;
  }
  const VideoResult end = video->finish();
  if (end.outcome == VideoOutcome::failed)
    throw RunError(
        fmt::format("no film: {}; the pictures are whole{}", end.reason, end.told.empty() ? "" : ". " + end.told));
  const bool written = end.outcome == VideoOutcome::written;
  if (!written) say(stderr, fmt::format("warning: no film: {}; the pictures are whole\n", end.reason));
  if (command.quiet) return 0;
  say(stdout, fmt::format("  {} in {}\n", count_text(pictures, "picture"), duration_text(seconds)));
  if (written)
    say(stdout,
        fmt::format("  film     {}\n", (command.folder() / film_file(coding_of(command, drawing).chosen())).string()));
  return 0;
}

// Starts the film, unless the pictures are all that is asked for.
void begin_film(const DrawCommand& command, const LoadedDrawing& drawing, std::optional<VideoEncoder>& video) {
  const SceneDef& scene = drawing.film.world.script().scene();
  const FilmCoding coding = coding_of(command, drawing);
  const std::string file = film_file(coding.chosen());
  if (file.empty()) return;
  for (const std::string& warning : coding_warnings(coding, drawing.rate))
    say(stderr, fmt::format("warning: {}\n", warning));
  video.emplace(command.folder() / file, scene.output.width, scene.output.height, drawing.rate, coding);
}

// Makes the film from pictures that other processes have drawn. watch: started with the work.
int film_of_parts(const DrawCommand& command, const LoadedDrawing& drawing, const Stopwatch& watch) {
  const int count = picture_count(drawing);
  std::optional<VideoEncoder> video;
  begin_film(command, drawing, video);
  if (video) video->add_files(command.folder() / "frames", count);
  return finish_film(command, drawing, video, count, watch.elapsed_ms() / 1000);
}

int merge_parts(const DrawCommand& command, const LoadedDrawing& drawing) {
  const Stopwatch watch;
  const std::vector<int> missing = missing_pictures(drawing, command.folder());
  if (!missing.empty()) {
    throw RunError(fmt::format("{}: {} of {} pictures are not drawn yet, the first of them {:06}",
                               command.folder().string(), missing.size(), picture_count(drawing), missing.front()));
  }
  return film_of_parts(command, drawing, watch);
}

int draw_range(const DrawCommand& command, LoadedDrawing& drawing, PictureRange range, VideoEncoder* video) {
  Progress progress(range.last - range.first, 0, command.quiet);
  const auto tell = [&progress](int done) {
    if (done > 0) progress.show(done);
  };
  const DrawResult result = draw_pictures(command.plan, drawing, command.folder(), range, video, tell);
  progress.end();
  return say_end(result, command.folder());
}

int draw_whole(const DrawCommand& command, LoadedDrawing& drawing) {
  const Stopwatch watch;
  const int count = picture_count(drawing);
  std::optional<VideoEncoder> video;
  begin_film(command, drawing, video);
  const int status = draw_range(command, drawing, {0, count}, video ? &*video : nullptr);
  return status == 0 ? finish_film(command, drawing, video, count, watch.elapsed_ms() / 1000) : status;
}

// Returns the command line that draws one part.
std::vector<std::string> words_of_part(const DrawCommand& command, std::size_t index) {
  const DrawPlan& plan = command.plan;
  std::vector<std::string> words = {
      "draw",    "--out=" + command.folder().string(), "--index", std::to_string(index),
      "--of",    std::to_string(command.jobs),         "--first", std::to_string(plan.first),
      "--every", std::to_string(plan.every),           "--gl",    std::string(name_of(plan.gl)),
      "--quiet"};
  if (plan.last >= 0) words.insert(words.end(), {"--last", std::to_string(plan.last)});
  if (plan.smooth > 1) words.insert(words.end(), {"--smooth", std::to_string(plan.smooth)});
  if (plan.rate) words.insert(words.end(), {"--rate", plan.rate->text()});
  if (!plan.cache) words.emplace_back("--no-cache");
  if (!command.scene.empty()) words.push_back("--scene=" + command.scene);
  for (const std::string& setting : plan.settings) words.insert(words.end(), {"--set", setting});
  words.insert(words.end(), {"--", command.run});
  return words;
}

// Draws the parts in processes of their own, all at the same time, and makes the film.
int draw_in_parts(const DrawCommand& command, const LoadedDrawing& drawing) {
  const Stopwatch watch;
  std::vector<JobEnd> ends(command.jobs);
  run_jobs({"part", ends.size(), command.jobs, [&](std::size_t part) { return Job{words_of_part(command, part)}; },
            [&](const JobEnd& end) { ends[end.job] = end; }});
  if (interrupted()) {
    const int drawn = picture_count(drawing) - static_cast<int>(missing_pictures(drawing, command.folder()).size());
    return say_end({FilmEnd::interrupted, "", drawn}, command.folder());
  }
  for (const JobEnd& end : ends) {
    if (end.status != 0) throw RunError("a part " + end.how + (end.output.empty() ? "" : ": " + end.output));
  }
  return film_of_parts(command, drawing, watch);
}

// Writes one frame as a picture.
int draw_one(const DrawCommand& command, LoadedDrawing& drawing) {
  const int frame = static_cast<int>(command.frame.value_or(drawing.frames.front()));
  const int frames = drawing.motion.front().frames();
  if (frame >= frames)
    throw InputError(fmt::format("--frame {}", frame), fmt::format("the run's last frame is {}", frames - 1));
  const std::string file = command.still.empty() ? fmt::format("frame-{:06}.png", frame) : command.still;
  const Image image = draw_still(command.plan, drawing, frame);
  write_whole_file(file, image.alpha.empty() ? png_bytes(image.width, image.height, image.rgb)
                                             : png_bytes(image.width, image.height, image.rgb, image.alpha));
  if (!command.quiet) say(stdout, fmt::format("  {}\n", file));
  return 0;
}

// Writes the skins of the chosen frames for other programs.
int write_skin_files(const DrawCommand& command, LoadedDrawing& drawing) {
  if (command.frame || !command.still.empty() || command.index || command.merge || command.jobs > 1)
    throw InputError("--skins", "writes all chosen frames (--first, --last, --every) at once, not one frame or parts");
  if (command.sheet || !command.field.empty())
    throw InputError("--skins", "writes shapes, and not pictures: leave out --sheet and --field");
  const auto count = static_cast<int>(drawing.frames.size());
  const FolderLock lock(command.folder());
  open_skins(command.folder(), drawing);
  catch_interrupts();
  Progress progress(count, 0, command.quiet);
  const int done = write_skins(drawing, command.folder(), [&progress](int frames) { progress.show(frames); });
  progress.end();
  const std::string where = (command.folder() / "motion").string();
  if (done < count) {
    say(stderr, fmt::format("supple: interrupted\n  kept: {} of {} frames in {}\n", done, count, where));
    return 130;
  }
  if (!command.quiet)
    say(stdout, fmt::format("  {} of {} in {}\n", count_text(count, "frame"),
                            count_text(int(drawing.film.world.bodies().size()), "skin"), where));
  return 0;
}

// Turns short forms into settings. They stand before those of --set, which override them.
void add_short_forms(DrawCommand& command) {
  std::vector<std::string> settings;
  const auto quoted = [](const std::string& text) { return "\"" + text + "\""; };
  if (!command.field.empty()) settings.push_back("field.quantity=" + quoted(command.field));
  // A field that is asked for here, with no range, has that of the whole film.
  const std::string range = command.range.empty() && !command.field.empty() ? "film" : command.range;
  const bool numbers = range.find(',') != std::string::npos;
  if (!range.empty()) settings.push_back("field.range=" + (numbers ? "[" + range + "]" : quoted(range)));
  if (!command.reference.empty()) settings.push_back("field.reference=" + quoted(command.reference));
  std::vector<std::string>& all = command.plan.settings;
  if (!command.size.empty()) settings.push_back(size_setting(command.size, all));
  all.insert(all.begin(), settings.begin(), settings.end());
  ask_for_passes(command.passes, all);
}

// Draws one frame of several runs side by side, in a folder beside the picture that is removed afterwards.
int draw_several_once(const DrawCommand& command) {
  const auto frame = static_cast<int>(*command.frame);
  const std::filesystem::path file = command.still.empty() ? fmt::format("frame-{:06}.png", frame) : command.still;
  std::string scratch = (file.parent_path() / "supple-still-XXXXXX").string();
  if (::mkdtemp(scratch.data()) == nullptr)
    throw RunError(fmt::format("{}: no folder can be made beside it: {}", file.string(), std::strerror(errno)));
  SplitCommand split{command.plan, command.runs, scratch, command.layout, {FilmFormat::png, FilmQuality::good}, true};
  split.plan.first = split.plan.last = frame;
  std::error_code ignored;
  int status = 1;
  try {
    status = draw_split(split);
    if (status == 0) write_whole_file(file, read_file(picture_file(split.folder / "frames", 0)));
  } catch (...) {
    std::filesystem::remove_all(scratch, ignored);
    throw;
  }
  std::filesystem::remove_all(scratch, ignored);
  if (status == 0 && !command.quiet) say(stdout, fmt::format("  {}\n", file.string()));
  return status;
}

// Draws several runs side by side.
int draw_several(const DrawCommand& command) {
  if (command.index || command.merge || command.jobs > 1 || command.sheet || command.skins)
    throw InputError("draw",
                     "several runs are drawn into one film as a whole: leave out --jobs, --index, --merge, --sheet and "
                     "--skins");
  if (command.frame) return draw_several_once(command);
  std::filesystem::path folder = command.out;
  if (folder.empty()) folder = std::filesystem::path(command.folder().string() + "-side-by-side");
  return draw_split({command.plan, command.runs, folder, command.layout, command.coding, command.quiet});
}

int draw(DrawCommand command) {
  add_short_forms(command);
  command.run = command.runs.front();
  command.plan.run = command.run;
  command.plan.scene = command.scene;
  command.plan.quiet = command.quiet;
  if (command.frame && !command.out.empty())
    throw InputError("--out", "is the folder of a film; the picture of one frame goes into the file of --still");
  if (!command.passes.empty() && (command.frame || command.skins))
    throw InputError("--passes", "stand beside the pictures of a film, not beside the picture of one frame or skins");
  if (command.plan.smooth > 1 && (command.frame || command.skins || command.runs.size() > 1))
    throw InputError("--smooth",
                     "is for a film of one run: leave out --frame and --skins, and draw several runs one by one");
  if (command.runs.size() > 1) return draw_several(command);
  if (command.index && *command.index >= static_cast<std::size_t>(command.of))
    throw InputError(fmt::format("--index {}", *command.index),
                     fmt::format("there are {} parts (--of): 0 to {}", command.of, command.of - 1));
  LoadedDrawing drawing = load_drawing(command.plan);
  const Script& script = drawing.film.world.script();
  if (const auto letters = letters_warning(script, text_font(script.scene().text)); letters && !command.skins)
    say(stderr, fmt::format("warning: {}\n", letters->text()));
  if (command.skins) return write_skin_files(command, drawing);
  if (command.frame || !command.still.empty()) return draw_one(command, drawing);
  coding_of(command, drawing);  // refuses a wrong one before the folder is changed
  const bool is_part = command.index || command.merge;
  FolderLock lock(command.folder(), is_part ? FolderUse::with_others : FolderUse::alone);
  open_drawing(command.folder(), drawing, is_part);
  if (command.jobs > 1) lock.share();
  catch_interrupts();
  if (command.merge) return merge_parts(command, drawing);
  if (command.index)
    return draw_range(command, drawing, part_of(drawing, static_cast<int>(*command.index), command.of), nullptr);
  return command.jobs > 1 ? draw_in_parts(command, drawing) : draw_whole(command, drawing);
}

void add_options(Verb& verb, DrawCommand& command) {
  DrawPlan& plan = command.plan;
  verb.option("RUN", command.runs, "folder that supple render left; several are drawn side by side").required();
  verb.option(
          "--layout", [&command](const std::string& word) { command.layout = *value_named<Layout>(word); },
          "of several runs [row]: " + word_list(all_names<Layout>()))
      .one_of(all_names<Layout>());
  verb.option("--out", command.out, "folder for the drawing [RUN-drawn], or for the skins [RUN-skins]");
  verb.option("--set", plan.settings,
              "path=value over the run's, of what is seen: camera, look, output, colours; may be repeated")
      .repeatable();
  add_size_option(verb, command.size, "the run's");
  verb.option("--field", command.field, "show this in colours: " + word_list(all_names<FieldQuantity>()))
      .one_of(all_names<FieldQuantity>());
  verb.option("--range", command.range, "LOW,HIGH of the colours, or usual, or film: that of the whole film [film]");
  verb.option("--reference", command.reference, "the run to which --field distance measures");
  verb.option("--scene", command.scene, "the run's scene file, where it has moved or a copy has another camera");
  verb.option("--first", plan.first, "first frame of the run").between(0, 1000000).shows_default();
  verb.option("--last", plan.last, "last frame [the run's]").between(0, 1000000);
  verb.option("--every", plan.every, "draw every Nth frame").between(1, 100000).shows_default();
  add_coding_options(verb, command.coding);
  add_passes_option(verb, command.passes);
  verb.flag("--sheet", command.sheet, "also sheet.png, on which a dozen of the pictures stand");
  verb.option("--smooth", plan.smooth, "pictures for each frame; those between frames are interpolated: slow motion")
      .between(1, 1000)
      .shows_default();
  verb.option(
      "--rate", [&plan](const std::string& text) { plan.rate = rate_asked_for(text); },
      "frames a second of the film, such as 25 or 30000/1001 [as fast as it happened]");
  const Option frame = verb.option("--frame", command.frame, "draw this frame alone, into the file of --still")
                           .between(std::size_t(0), std::size_t(1000000));
  verb.option("--still", command.still, "file for one picture [frame-NNNNNN.png]").needs(frame);
  verb.flag("--skins", command.skins, "write the skins and their motion for other programs, and no pictures");
  Options what = verb.at_most_one_of("Parts", "frames are independent, so that several processes can draw them");
  what.option("--jobs", command.jobs, "draw so many parts at a time, each in a process of its own").between(1, 1024);
  const Option index = what.option("--index", command.index, "draw this part alone, from 0; makes no film")
                           .between(std::size_t(0), std::size_t(100000));
  what.flag("--merge", command.merge, "make the film of what has been drawn");
  verb.option("--of", command.of, "the number of parts").needs(index).between(1, 100000);
  add_gl_option(verb, plan.gl);
  add_cache_option(verb, plan.cache);
  verb.flag("--quiet", command.quiet, "say nothing but errors");
}

}  // namespace

void add_draw(CommandLine& line) {
  auto command = std::make_shared<DrawCommand>();
  Verb verb = line.verb("draw", "Film a run again from its saved motion; nothing is simulated.");
  verb.footer(
      "Examples: supple draw out/squirrel --set camera.azimuth=40 --set output.width=1920 --set "
      "output.height=1080\n"
      "          supple draw out/squirrel --frame 120 --still poster.png\n"
      "          supple draw out/squirrel --index 3 --of 8    (one of eight machines; --merge makes the film)\n"
      "          supple draw out/squirrel --skins    (OBJ and PC2 of what is seen, for Blender)\n"
      "Leaves frames/, video.mp4 and draw.json. With the run's own settings the pictures are the run's to the byte.");
  add_options(verb, *command);
  verb.runs([command] { return draw(*command); });
}

}  // namespace supple
