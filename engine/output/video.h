// Makes a film from numbered frames with the ffmpeg program, when it is installed.
#pragma once

#include <filesystem>
#include <string>

namespace supple {

enum class VideoOutcome { written, no_ffmpeg, failed };

struct VideoResult {
  VideoOutcome outcome;
  std::string message;  // tells the user why there is no film
};

// Encodes frames/000000.png and the following ones into an H.264 file of exactly `count` frames. They are counted
// afterwards, because ffmpeg accepts a truncated sequence. The file appears only when it is whole.
VideoResult encode_video(const std::filesystem::path& frames, int count, double fps,
                         const std::filesystem::path& video);

// Counts the frames in a film with ffprobe; returns -1 when it cannot tell.
long count_video_frames(const std::filesystem::path& video);

}  // namespace supple
