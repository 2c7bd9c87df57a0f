// A film from numbered frames, by the ffmpeg program when it is installed.
#pragma once

#include <filesystem>
#include <string>

namespace supple {

enum class VideoOutcome { written, no_ffmpeg, failed };

struct VideoResult {
  VideoOutcome outcome;
  std::string message;  // what to tell the user when there is no film
};

// frames/000000.png ... to an H.264 file of exactly `count` frames, which are counted afterwards: ffmpeg is content
// with a truncated sequence. The file appears only when it is whole.
VideoResult encode_video(const std::filesystem::path& frames, int count, double fps,
                         const std::filesystem::path& video);

// Frames in a film, by ffprobe; -1 when that cannot be told.
long count_video_frames(const std::filesystem::path& video);

}  // namespace supple
