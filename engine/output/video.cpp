#include "output/video.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <optional>
#include <vector>

extern char** environ;

namespace supple {
namespace {

struct Finished {
  int status;          // of waitpid
  std::string output;  // standard output and errors, the last 4 kB
};

// Runs a program without a shell; empty when it is not installed.
std::optional<Finished> run(const std::vector<std::string>& words) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return std::nullopt;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 2);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  // Ctrl-C on the terminal is ours to handle: the encoder finishes what it has, so it stands in a process group of its
  // own.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  ::close(ends[1]);
  if (error != 0) {
    ::close(ends[0]);
    return std::nullopt;
  }
  Finished finished{0, ""};
  char buffer[4096];
  for (;;) {
    const ssize_t count = ::read(ends[0], buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    finished.output.append(buffer, std::size_t(count));
    if (finished.output.size() > 4096) finished.output.erase(0, finished.output.size() - 4096);
  }
  ::close(ends[0]);
  while (::waitpid(child, &finished.status, 0) < 0 && errno == EINTR) {
  }
  return finished;
}

}  // namespace

long count_video_frames(const std::filesystem::path& video) {
  const auto probe = run({"ffprobe", "-v", "error", "-count_packets", "-select_streams", "v:0", "-show_entries",
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
  const auto encoded = run({"ffmpeg",
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
  if (!encoded || (WIFEXITED(encoded->status) && WEXITSTATUS(encoded->status) == 127)) {
    return {VideoOutcome::no_ffmpeg, "no film: ffmpeg is not installed (Debian: ffmpeg); the frames are whole"};
  }
  if (encoded->status != 0) {
    std::filesystem::remove(part, ignored);
    const std::string how = WIFSIGNALED(encoded->status)
                                ? fmt::format("was ended by signal {}", WTERMSIG(encoded->status))
                                : fmt::format("ended with status {}", WEXITSTATUS(encoded->status));
    return {VideoOutcome::failed, fmt::format("no film: ffmpeg {}; the frames are whole. {}", how, encoded->output)};
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
