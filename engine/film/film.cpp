#include "film/film.h"

#include <fmt/core.h>

#include <exception>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/timing.h"
#include "film/film_guide.h"
#include "film/frame_loop.h"
#include "film/pictures/film_stills.h"
#include "film/pictures/picture_words.h"
#include "film/pictures/reference_run.h"
#include "film/plan/film_coding.h"
#include "film/plan/film_solvers.h"
#include "film/plan/shipped_files.h"
#include "film/progress.h"
#include "film/record/film_checks.h"
#include "film/record/film_identity.h"
#include "film/record/unsolved_words.h"
#include "output/files/child_program.h"
#include "output/files/json_text.h"
#include "output/files/whole_file.h"
#include "output/run/chrome_trace.h"
#include "output/run/run_record.h"
#include "output/run/verdict.h"
#include "output/video/video.h"
#include "scene/building/warnings.h"

namespace supple {

namespace {

// Checks that the folder holds all that the film needs of the frames of an earlier run.
void check_folder(const FilmPlan& plan, const LoadedFilm& film, const FilmStart& start) {
  const SceneDef& scene = film.world.script().scene();
  check_save_states(plan.save_states, scene, start.place.path, start.kept_frames());
  check_rows_and_motion(start.place.path, film.world.bodies(), scene, start.kept_frames());
  if (plan.pictures != FilmPictures::all || plan.film_only) return;
  check_pictures(start.place.path / "frames", start.kept_frames());
  check_kept_passes(start.place.path / "passes", scene, start.kept_frames());
}

void check_records(const FilmPlan& plan, const FilmStart& start) {
  if (plan.record.empty()) return;
  check_record(plan.record, start.place.path, start.record_head, start.kept_frames());
  std::error_code ignored;
  const bool same = !plan.verify.empty() &&
                    (plan.record == plan.verify || std::filesystem::equivalent(plan.record, plan.verify, ignored));
  if (same) throw InputError("--record " + plan.record, "is the file to --verify with, which would be overwritten");
}

std::filesystem::path asked_folder(const FilmPlan& plan, const SceneDef& scene) {
  if (!plan.out.empty()) return plan.out;
  return std::filesystem::path("out") / (scene.name + (plan.preview ? "-preview" : ""));
}

// Refuses pictures of values that are known only after the film has been made, and ways to film that contradict each
// other.
void check_pictures_asked(const FilmPlan& plan, const LoadedFilm& film) {
  const SceneDef& scene = film.world.script().scene();
  if (plan.pictures != FilmPictures::none) check_references(scene, film.world.bodies(), 0, scene.frames - 1);
  std::vector<Problem> later = known_after_film(scene);
  if (!later.empty() && plan.pictures != FilmPictures::none) throw InputError(std::move(later));
  if (plan.wants_video()) coding_for(plan.coding, scene);
  if (plan.pictures != FilmPictures::none) {
    check_passes(scene);
    (void)text_font(scene.text);  // refuses a family that is not installed
  }
  if (plan.film_only && plan.coding.format == FilmFormat::png)
    throw InputError("--film-only", "leaves a film, and --format png makes none");
  if (plan.film_only && !run_program({"ffmpeg", "-version"}))
    throw InputError("--film-only", "needs ffmpeg, which is not installed (Debian: ffmpeg)");
}

}  // namespace

FilmStart check_film(const FilmPlan& plan, const LoadedFilm& film) {
  const Zone zone("begin folder");
  const SceneDef& scene = film.world.script().scene();
  FilmStart start;
  start.place = place_of_run(asked_folder(plan, scene), plan, film.info);
  start.identity = identity_of(film.info, film.world.script(), film.world.bodies(), plan);
  start.checkpoint_every = plan.film_only || plan.preview ? 0 : plan.checkpoint_every;
  start.record_head = record_head(film.info, film.world.bodies());
  check_pictures_asked(plan, film);
  std::error_code ignored;
  if (!plan.folder_is_locked && std::filesystem::is_directory(start.place.path, ignored))
    start.lock = std::make_unique<FolderLock>(start.place.path);
  if (plan.resume) start.checkpoint = checkpoint_in(start.place.path, start.identity, scene.frames, film.info);
  check_folder(plan, film, start);
  if (plan.pictures != FilmPictures::none) note_other_graphs(scene, start.place.path, start.kept_frames());
  check_records(plan, start);
  if (!plan.verify.empty()) start.verifier.emplace(plan.verify, start.record_head, plan.tolerance, start.kept_frames());
  start.repeated = repeated_cuts(film.world.script().session(), names_of(film.world.bodies()));
  if (!plan.repeat.empty()) start.repeated = repeated_cuts(plan.repeat, names_of(film.world.bodies()), scene.frames);
  // A folder that does not exist yet is locked only now, so that a film that is refused leaves no trace.
  if (!plan.folder_is_locked && !start.lock) start.lock = std::make_unique<FolderLock>(start.place.path);
  return start;
}

namespace {

// Returns the frames after which the film in a folder was resumed before.
std::vector<int> resumed_before(const std::filesystem::path& run) {
  const auto info = parsed_json<nlohmann::ordered_json>(read_run(run).info_json);
  return info.contains("resumed_at") ? info["resumed_at"].get<std::vector<int>>() : std::vector<int>();
}

}  // namespace

RunFolder open_folder(FilmStart& start, LoadedFilm& film) {
  const Zone zone("begin folder");
  RunFolder folder(start.place.path, start.kept_frames());
  film.info.ended = "running";
  if (start.checkpoint) {
    film.info.resumed = resumed_before(start.place.path);
    film.info.resumed.push_back(start.kept_frames());
  }
  folder.write_info(film.info);
  return folder;
}

namespace {

// Makes the frames and records errors in the result. Returns false when the film could not even be begun.
bool make_frames(const FilmPlan& plan, LoadedFilm& film, FilmStart& start, const RunFolder& folder,
                 const FilmSolvers& solvers, VideoEncoder* video, FilmResult& result) {
  const Stopwatch setup;
  Stopwatch loop;
  Progress progress(film.world.script().scene().frames, start.kept_frames(), plan.quiet);
  std::optional<FilmLog> log;
  std::optional<FrameLoop> frames;
  std::optional<Pictures> pictures;
  std::optional<FilmGuide> guide;
  const auto guarded = [&result](const auto& work) {
    try {
      work();
    } catch (const std::exception& error) {
      result.end = FilmEnd::failed;
      if (result.message.empty()) result.message = error.what();
    }
  };
  guarded([&] {
    Zone prepare("prepare film");
    log.emplace(folder, start.checkpoint_every, start.identity, start.kept_frames(), plan.record);
    frames.emplace(plan, film, start, &folder, solvers, log->whole_rows());
    if (const Stage* stage = frames->stage()) {
      const std::vector<PicturePass>& passes = film.world.script().scene().output.passes;
      const PictureTargets targets{folder.frames(),     !plan.film_only, video,
                                   start.kept_frames(), folder.passes(), passes};
      frames->draw_on(pictures.emplace(*stage, plan.gl, shaders_folder(), targets));
      // The passes of the last picture that is kept were made without the next picture.
      if (start.kept_frames() > 0 && pictures->want_next())
        pictures->put_earlier(start.kept_frames() - 1, frames->present_list());
    }
    guide.emplace(film.world, *log, pictures ? &*pictures : nullptr, progress);
    result.setup_ms = setup.elapsed_ms();
    loop.lap_ms();
    prepare.finish();
    result.end = frames->run(*guide, result.message);
  });
  if (guide) guarded([&] { guide->finish(result); });
  if (log) {
    result.rows = log->whole_rows();
    guarded([&] { result.rows.each([&result](const FrameRow& row) { result.tally.add(row); }); });
  }
  progress.end();
  result.wall_ms = loop.elapsed_ms();
  return guide.has_value();
}

void begin_video(const FilmPlan& plan, const SceneDef& scene, const RunFolder& folder,
                 std::optional<VideoEncoder>& video) {
  const FilmCoding coding = coding_for(plan.coding, scene);
  video.emplace(folder.path() / film_file(coding.chosen()), scene.output.width, scene.output.height,
                scene.fps.over(plan.pictures_every()), coding);
}

// Returns how many pictures the whole frames have.
int pictures_of(const FilmPlan& plan, const FilmResult& result) {
  const int every = plan.pictures_every();
  return (result.rows.size() + every - 1) / every;
}

// Makes the poster and the sheet from the files of the frames.
void make_stills(const FilmPlan& plan, const SceneDef& scene, const RunFolder& folder, FilmResult& result) {
  const Zone zone("stills");
  std::vector<double> times;
  for (int picture = 0; picture < pictures_of(plan, result); ++picture)
    times.push_back(scene.time_after(picture * plan.pictures_every()));
  try {
    result.stills = write_stills(folder.path(), scene.title, times);
  } catch (const std::exception& error) {
    result.stills_message = fmt::format("no poster and sheet: {}", error.what());
  }
}

// Ends the video, so that it has exactly the frames that are whole.
void finish_video(const FilmPlan& plan, const SceneDef& scene, const RunFolder& folder,
                  std::optional<VideoEncoder>& video, FilmResult& result) {
  const Zone zone("video");
  const int frames = pictures_of(plan, result);
  // A frame may have reached the disk although its row did not.
  if (video->frames() > frames && !plan.film_only) {
    begin_video(plan, scene, folder, video);
    video->add_files(folder.frames(), frames);
  }
  const VideoResult end = video->finish();
  result.video_written = end.outcome == VideoOutcome::written;
  if (result.video_written) result.video = folder.path() / film_file(coding_for(plan.coding, scene).chosen());
  result.video_failed = end.outcome == VideoOutcome::failed || (plan.film_only && !result.video_written);
  result.encode_ms = end.cpu_ms / frames;
  if (result.video_written) return;
  result.video_message = fmt::format("no film: {}{}{}", end.reason, plan.film_only ? "" : "; the frames are whole",
                                     end.told.empty() ? "" : ". " + end.told);
}

}  // namespace

FilmResult make_film(const FilmPlan& plan, LoadedFilm& film, FilmStart& start, const RunFolder& folder,
                     const FilmSolvers& solvers) {
  FilmResult result;
  result.kept_frames = start.kept_frames();
  result.tally.set_unsolved_words(unsolved_words(film.world.script()));
  const SceneDef scene = film.world.script().scene();
  std::optional<VideoEncoder> video;
  if (plan.wants_video()) begin_video(plan, scene, folder, video);
  const bool begun = make_frames(plan, film, start, folder, solvers, video ? &*video : nullptr, result);
  if (video && begun && !result.rows.empty()) finish_video(plan, scene, folder, video, result);
  const bool has_files = plan.pictures == FilmPictures::all && !plan.film_only && !result.rows.empty();
  if (plan.stills && begun && has_files) make_stills(plan, scene, folder, result);
  if (plan.pictures != FilmPictures::none) {
    if (const auto letters = letters_warning(film.world.script(), text_font(scene.text)))
      result.tally.remark(letters->text());
  }
  return result;
}

std::string verdict_on(const FilmResult& result) { return verdict(result.tally.work(result.encode_ms)); }

std::string write_records(const FilmResult& result, LoadedFilm& film, const RunFolder& folder,
                          const std::vector<ThreadTrace>* trace) {
  RunInfo& info = film.info;
  info.gl_backend = result.gl_backend;
  info.gl_renderer = result.gl_renderer;
  info.gl_version = result.gl_version;
  info.frames = result.rows.size();
  info.ended = text_of(result.end);
  if (result.end == FilmEnd::failed) info.ended += ": " + result.message;
  info.video = result.video_written ? result.video.filename().string() : result.video_message;
  try {
    folder.write_info(info);
    folder.write_profile(result.rows, result.tally, verdict_on(result));
    if (trace != nullptr) write_whole_file(folder.trace(), chrome_trace(*trace));
  } catch (const RunError& error) {
    return error.what();
  }
  return "";
}

}  // namespace supple
