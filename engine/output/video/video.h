// Makes a film with the ffmpeg program, which runs at the same time as this one and receives each frame once it is
// drawn.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/frame_rate.h"
#include "base/names.h"
#include "output/files/child_program.h"

namespace supple {

enum class FilmFormat {
  mp4,       // H.264, which every player has
  mp4_h265,  // smaller, slower to make
  webm,      // VP9, for pages
  webm_av1,  // smaller, slower to make
  mov,       // ProRes 4444, for programs that cut films
  gif,       // loops; 256 colours that are chosen from the whole film, so that it is held in memory meanwhile
  png,       // no film: the frames are files, with their coverage where the background is transparent
};
template <>
struct Names<FilmFormat> {
  static constexpr std::array table = {Name{FilmFormat::mp4, "mp4"},   Name{FilmFormat::mp4_h265, "mp4-h265"},
                                       Name{FilmFormat::webm, "webm"}, Name{FilmFormat::webm_av1, "webm-av1"},
                                       Name{FilmFormat::mov, "mov"},   Name{FilmFormat::gif, "gif"},
                                       Name{FilmFormat::png, "png"}};
};
enum class FilmQuality { draft, good, best };
template <>
struct Names<FilmQuality> {
  static constexpr std::array table = {Name{FilmQuality::draft, "draft"}, Name{FilmQuality::good, "good"},
                                       Name{FilmQuality::best, "best"}};
};

// Describes how a film is encoded.
struct FilmCoding {
  std::optional<FilmFormat> format = {};  // nothing: the usual one
  FilmQuality quality = FilmQuality::good;
  bool coverage = false;  // the film is transparent where its pictures are

  FilmFormat chosen() const { return format.value_or(coverage ? FilmFormat::webm : FilmFormat::mp4); }
};

// Tells whether films of a format can be transparent.
bool holds_coverage(FilmFormat format);

// Returns sentences for people about what is lost where pictures at this rate become a film.
std::vector<std::string> coding_warnings(const FilmCoding& coding, const FrameRate& fps);

// Returns the name of the film's file in its folder, "video.mp4"; empty where there is no film.
std::string film_file(FilmFormat format);

enum class VideoOutcome { written, no_ffmpeg, failed };

struct VideoResult {
  VideoOutcome outcome;
  std::string reason;  // why there is no film, for people
  std::string told;    // ffmpeg's own last words on that
  double cpu_ms = 0;   // processor time of ffmpeg for all frames
};

// Encodes a film, with BT.709 colours, which the file declares (a GIF has sRGB). Equal frames give equal bytes.
class VideoEncoder {
 public:
  // The file is written under a temporary name, and nothing of it remains unless the film becomes complete. The encoder
  // must be used and destroyed in the thread that creates it, except for add(), which one other thread may call
  // meanwhile.
  VideoEncoder(std::filesystem::path video, int width, int height, const FrameRate& fps, const FilmCoding& coding = {});
  ~VideoEncoder();

  // Adds a frame: 8-bit sRGB, rows from the top, and for a film with coverage that of each pixel, by which the colours
  // are not multiplied. Waits while ffmpeg is busy. Returns false once ffmpeg takes no more frames. A GIF leaves out
  // those for which it is too slow.
  bool add(std::span<const std::uint8_t> rgb, std::span<const std::uint8_t> alpha = {});

  // Adds the frames of a folder (000000.png, 000001.png, ...) that have not been added yet, until `count` frames have
  // been added in all. If one of them cannot be read, no film is made.
  void add_files(const std::filesystem::path& frames, int count);

  // Returns the number of frames that were added, whether or not ffmpeg took them.
  int frames() const { return frames_; }

  // Ends the film, counts the frames in it, and gives the file its name. Frames can no longer be added.
  VideoResult finish();

 private:
  void set_planes(std::span<const std::uint8_t> rgb, std::span<const std::uint8_t> alpha);
  VideoResult failure(std::string reason, std::string told = "") const;

  std::filesystem::path video_, part_;
  int width_, height_;
  FilmCoding coding_;
  std::vector<std::uint8_t> planes_;  // scratch
  int frames_ = 0;
  int every_ = 1;       // of the frames, the film has one in so many
  bool taken_ = true;   // whether ffmpeg took all frames so far
  std::string unread_;  // why a file could not be added
  double cpu_ms_ = 0;   // of ffmpeg
  std::optional<FedProgram> ffmpeg_;
};

// Counts the frames in a film with ffprobe; returns -1 when it cannot tell.
long count_video_frames(const std::filesystem::path& video);

}  // namespace supple
