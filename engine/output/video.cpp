#include "output/video.h"

#include <fmt/core.h>

#include <cstdlib>

#include "output/child_program.h"

namespace supple {
long count_video_frames(const std::filesystem::path& video) {
  const auto probe = run_program({"ffprobe", "-v", "error", "-count_packets", "-select_streams", "v:0", "-show_entries",
                                  "stream=nb_read_packets", "-of", "csv=p=0", video.string()});
  if (!probe || probe->status != 0) return -1;
  char* end = nullptr;
  const long count = std::strtol(probe->output.c_str(), &end, 10);
  return end == probe->output.c_str() ? -1 : count;
}

VideoResult encode_video(const std::filesystem::path& frames, int count, double fps,
                         const std::filesystem::path& video) {
  const std::filesystem::path part =
      video.parent_path() / (video.stem().string() + ".part" + video.extension().string());
  const auto encoded = run_program({"ffmpeg",
                                    "-nostdin",
                                    "-y",
                                    "-loglevel",
                                    "error",
                                    "-framerate",
                                    fmt::format("{}", fps),
                                    "-start_number",
                                    "0",
                                    "-i",
                                    (frames / "%06d.png").string(),
                                    "-frames:v",
                                    fmt::format("{}", count),
                                    "-c:v",
                                    "libx264",
                                    "-preset",
                                    "medium",
                                    "-crf",
                                    "17",
                                    "-pix_fmt",
                                    "yuv420p",
                                    "-movflags",
                                    "+faststart",
                                    part.string()});
  std::error_code ignored;
  if (!encoded)
    return {VideoOutcome::no_ffmpeg, "no film: ffmpeg is not installed (Debian: ffmpeg); the frames are whole"};
  if (encoded->status != 0) {
    std::filesystem::remove(part, ignored);
    return {VideoOutcome::failed,
            fmt::format("no film: ffmpeg {}; the frames are whole. {}", how_it_ended(*encoded), encoded->output)};
  }
  const long found = count_video_frames(part);
  if (found >= 0 && found != count) {
    std::filesystem::remove(part, ignored);
    return {VideoOutcome::failed,
            fmt::format("no film: ffmpeg wrote {} of {} frames; the frames are whole", found, count)};
  }
  std::filesystem::rename(part, video, ignored);
  if (ignored)
    return {VideoOutcome::failed,
            fmt::format("no film: {} cannot be renamed into place: {}", part.string(), ignored.message())};
  return {VideoOutcome::written, ""};
}

}  // namespace supple
