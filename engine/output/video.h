// Makes a film with the ffmpeg program, which runs beside this one and gets each frame once it is drawn.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "output/child_program.h"

namespace supple {

enum class VideoOutcome { written, no_ffmpeg, failed };

struct VideoResult {
  VideoOutcome outcome;
  std::string reason;  // why there is no film, for people
  std::string told;    // ffmpeg's own last words on that
  double cpu_ms = 0;   // processor time of ffmpeg for all frames
};

// A film in progress: H.264 in BT.709 colours, and the file says so. Equal frames give equal bytes.
class VideoEncoder {
 public:
  // The file is written under another name, which nothing is left of unless the film becomes whole. The encoder must be
  // used and end in the thread that makes it, but for add(), which may be called by one other thread meanwhile.
  VideoEncoder(std::filesystem::path video, int width, int height, double fps);
  ~VideoEncoder();

  // Adds a frame: 8-bit sRGB, rows from the top. Waits while ffmpeg is busy. Returns false once ffmpeg takes no more.
  bool add(std::span<const std::uint8_t> rgb);

  // Adds frames 000000.png and the following ones of a folder, until `count` frames are there in all. Where one cannot
  // be read, there will be no film.
  void add_files(const std::filesystem::path& frames, int count);

  // The number of frames that were added, whether or not ffmpeg took them.
  int frames() const { return frames_; }

  // Ends the film, counts the frames in it, and gives the file its name. Frames can no longer be added.
  VideoResult finish();

 private:
  VideoResult failure(std::string reason, std::string told = "") const;

  std::filesystem::path video_, part_;
  int width_, height_;
  std::vector<std::uint8_t> planes_;  // scratch
  int frames_ = 0;
  bool taken_ = true;   // all frames so far
  std::string unread_;  // why a file could not be added
  double cpu_ms_ = 0;   // of ffmpeg
  std::optional<FedProgram> ffmpeg_;
};

// Counts the frames in a film with ffprobe; returns -1 when it cannot tell.
long count_video_frames(const std::filesystem::path& video);

}  // namespace supple
