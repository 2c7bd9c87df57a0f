#include "output/video/video.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "base/trace.h"
#include "output/files/png_file.h"
#include "output/run/run_folder.h"
#include "output/video/film_colors.h"
#include "output/video/film_coverage.h"

namespace supple {
namespace {

// Returns how many frames there are for each one that the film has. A GIF counts the time of a frame in hundredths of a
// second, and browsers show a frame of a single hundredth for ten. Where frames last two hundredths or more, ffmpeg
// rounds their times so that the film keeps its speed.
int frames_for_one(FilmFormat format, double fps) {
  constexpr double fastest_gif = 50;
  return format == FilmFormat::gif ? std::max(1, static_cast<int>(std::ceil(fps / fastest_gif - 1e-9))) : 1;
}

std::filesystem::path part_of(const std::filesystem::path& video) {
  return video.parent_path() / (video.stem().string() + ".part" + video.extension().string());
}

// Returns the number of the encoder's threads. It depends on the size of the film alone, because another number gives
// other bytes. One thread encodes 80 frames of 1280 x 720 per second, more than are drawn; more threads would only take
// cores away from the solver.
int encoder_threads(int width, int height) { return std::clamp(width * height / (1280 * 720), 1, 8); }

// Preset medium, x264's default, at quality 17 took 38 ms of processor time for a frame of 1280 x 720 of `squirrel`
// (SSIM 26.6 dB, 333 kB for 60 frames). Superfast at 18 takes 12.5 ms and comes as close to the frames (26.8 dB), but
// needs 642 kB, which is little compared with the files of the frames. Veryfast at 14 gave 18.5 ms, 26.7 dB and 463 kB.
// In each of these times, 4 ms are the conversion and the start of ffmpeg.
constexpr const char* preset = "superfast";

// Files of WebM have random numbers that name them; equal films are to have equal bytes.
constexpr const char* without_random_numbers = "-fflags +bitexact";

// Returns the encoder's words for a film in the film's own colours. The numbers of a quality are constant rate factors,
// and for ProRes scales of the quantiser. They mean another loss for each codec.
std::string codec_words(const FilmCoding& coding, int threads) {
  const auto of_quality = [&coding](int draft, int good, int best) {
    return coding.quality == FilmQuality::draft ? draft : coding.quality == FilmQuality::good ? good : best;
  };
  switch (coding.chosen()) {
    case FilmFormat::mp4_h265:
      return fmt::format(
          "-c:v libx265 -preset fast -crf {} -x265-params log-level=error:pools={}:frame-threads=1 "
          "-tag:v hvc1 -movflags +faststart",
          of_quality(30, 22, 15), threads);
    case FilmFormat::webm:
      return fmt::format("-c:v libvpx-vp9 -deadline good -cpu-used 4 -b:v 0 -crf {} -threads {} {}",
                         of_quality(42, 31, 20), threads, without_random_numbers);
    case FilmFormat::webm_av1:
      return fmt::format("-c:v libsvtav1 -preset 8 -crf {} -svtav1-params lp={} {}", of_quality(45, 32, 20), threads,
                         without_random_numbers);
    case FilmFormat::mov:
      return fmt::format("-c:v prores_ks -profile:v 4444 -vendor apl0 -alpha_bits {} -qscale:v {} -threads {}",
                         coding.coverage ? 8 : 0, of_quality(9, 3, 1), threads);
    default: break;
  }
  return fmt::format("-c:v libx264 -preset {} -crf {} -threads {} -movflags +faststart",
                     coding.quality == FilmQuality::best ? "medium" : preset, of_quality(28, 18, 12), threads);
}

// Returns the words for a GIF. The palette follows from all pixels of all frames, so that a legend, which stands still,
// has its colours too; an ordered dither keeps still parts still from frame to frame, which also makes the file small.
std::string gif_words(const FilmCoding& coding) {
  const int colors = coding.quality == FilmQuality::draft ? 64 : 256;
  return fmt::format(
      "-filter_complex split[a][b];[a]palettegen=max_colors={}:stats_mode=full[p];[b][p]paletteuse="
      "dither=bayer:bayer_scale={}{} -loop 0",
      colors, coding.quality == FilmQuality::best ? 3 : 5, coding.coverage ? "" : ":diff_mode=rectangle");
}

// Returns what ffmpeg calls the pixels that it is given.
const char* pixel_format(const FilmCoding& coding) {
  switch (coding.chosen()) {
    case FilmFormat::gif: return coding.coverage ? "rgba" : "rgb24";
    case FilmFormat::mov: return coding.coverage ? "yuva444p10le" : "yuv444p10le";
    default: return coding.coverage ? "yuva420p" : "yuv420p";
  }
}

// Returns the words that name the film's colours. The transfer function is that of the frames, sRGB, except in ProRes,
// which has no name for it: there the name is that of BT.709, as programs for cutting assume. The encoder of ProRes
// takes the names from the frames.
const char* color_words(FilmFormat format) {
  if (format == FilmFormat::mov)
    return "-vf setparams=range=tv:color_primaries=bt709:color_trc=bt709:colorspace=bt709 -color_range tv "
           "-colorspace bt709 -color_primaries bt709 -color_trc bt709";
  return "-color_range tv -colorspace bt709 -color_primaries bt709 -color_trc iec61966-2-1";
}

// Keeps ffmpeg to files and pipes, whatever a name looks like. ffmpeg must be told so for its input and for its output.
constexpr const char* local_alone = "-protocol_whitelist file,pipe";

std::vector<std::string> ffmpeg_words(const std::filesystem::path& part, int width, int height, const FrameRate& fps,
                                      const FilmCoding& coding) {
  const bool gif = coding.chosen() == FilmFormat::gif;
  const std::string words =
      // Frames come in the film's own colours (film_colors.h): ffmpeg took 4 ms for the same conversion.
      fmt::format(
          "ffmpeg -nostdin -y -loglevel error {} -f rawvideo -pixel_format {} -video_size {}x{} -framerate {} "
          "-i pipe:0 {} ",
          local_alone, pixel_format(coding), width, height, fps.text(), local_alone) +
      (gif ? gif_words(coding)
           : fmt::format("-pix_fmt {} {} ", pixel_format(coding), color_words(coding.chosen())) +
                 codec_words(coding, encoder_threads(width, height)));
  std::vector<std::string> list;
  std::istringstream stream(words);
  for (std::string word; stream >> word;) list.push_back(word);
  list.push_back(file_word(part));
  return list;
}

}  // namespace

bool holds_coverage(FilmFormat format) {
  switch (format) {
    case FilmFormat::webm:
    case FilmFormat::mov:
    case FilmFormat::gif:
    case FilmFormat::png: return true;
    case FilmFormat::mp4:
    case FilmFormat::mp4_h265:
    case FilmFormat::webm_av1: break;
  }
  return false;
}

std::vector<std::string> coding_warnings(const FilmCoding& coding, const FrameRate& fps) {
  std::vector<std::string> list;
  if (const int every = frames_for_one(coding.chosen(), fps); every > 1)
    list.push_back(
        fmt::format("a GIF shows no more than 50 pictures a second: of {}, it has one in {}, and its speed is "
                    "that of the film",
                    fps.text(), every));
  return list;
}

std::string film_file(FilmFormat format) {
  switch (format) {
    case FilmFormat::mp4:
    case FilmFormat::mp4_h265: return "video.mp4";
    case FilmFormat::webm:
    case FilmFormat::webm_av1: return "video.webm";
    case FilmFormat::mov: return "video.mov";
    case FilmFormat::gif: return "video.gif";
    case FilmFormat::png: break;
  }
  return "";
}

VideoEncoder::VideoEncoder(std::filesystem::path video, int width, int height, const FrameRate& fps,
                           const FilmCoding& coding)
    : video_(std::move(video)), part_(part_of(video_)), width_(width), height_(height), coding_(coding) {
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);  // of a run that was killed
  SUPPLE_CHECK(!coding.coverage || holds_coverage(coding.chosen()), ==, true);
  every_ = frames_for_one(coding_.chosen(), fps);
  ffmpeg_.emplace(ffmpeg_words(part_, width, height, fps.over(every_), coding_));
}

VideoEncoder::~VideoEncoder() {
  if (!ffmpeg_) return;
  ffmpeg_.reset();
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

// Sets planes_ to a frame as ffmpeg is given it.
void VideoEncoder::set_planes(std::span<const std::uint8_t> rgb, std::span<const std::uint8_t> alpha) {
  const FilmFormat format = coding_.chosen();
  std::vector<std::uint8_t> filled;
  if (coding_.coverage && format != FilmFormat::gif) {
    filled = filled_colors(width_, height_, rgb, alpha);
    rgb = filled;
  }
  if (format == FilmFormat::gif) {
    planes_ = dithered_coverage(width_, rgb, alpha);
  } else if (format == FilmFormat::mov) {
    fine_film_planes(rgb, alpha, planes_);
  } else {
    film_planes(width_, height_, rgb, planes_);
    planes_.insert(planes_.end(), alpha.begin(), alpha.end());
  }
}

bool VideoEncoder::add(std::span<const std::uint8_t> rgb, std::span<const std::uint8_t> alpha) {
  SUPPLE_CHECK(alpha.size(), ==, coding_.coverage ? std::size_t(width_) * height_ : 0);
  const int number = frames_++;
  if (!taken_) return false;
  if (number % every_ != 0) return true;
  if (coding_.chosen() == FilmFormat::gif && !coding_.coverage) {
    taken_ = ffmpeg_->write(rgb);
  } else {
    set_planes(rgb, alpha);
    taken_ = ffmpeg_->write(planes_);
  }
  return taken_;
}

void VideoEncoder::add_files(const std::filesystem::path& frames, int count) {
  try {
    while (taken_ && unread_.empty() && frames_ < count) {
      const std::filesystem::path file = picture_file(frames, frames_);
      const Zone zone("read frame", {}, frames_);
      const PngImage image = coding_.coverage ? read_png_with_coverage(file) : read_png(file);
      if (image.width != width_ || image.height != height_)
        throw InputError(file.string(), "is not of the film's size");
      add(image.rgb, image.alpha);
    }
  } catch (const InputError& error) {
    unread_ = error.what();
    taken_ = false;
  }
}

VideoResult VideoEncoder::failure(std::string reason, std::string told) const {
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
  return {VideoOutcome::failed, std::move(reason), std::move(told), cpu_ms_};
}

VideoResult VideoEncoder::finish() {
  const std::optional<ProgramEnd> end = ffmpeg_->finish();
  ffmpeg_.reset();
  if (!end) return {VideoOutcome::no_ffmpeg, "ffmpeg is not installed (Debian: ffmpeg)", ""};
  cpu_ms_ = end->cpu_ms;
  if (!unread_.empty()) return failure(unread_);
  if (end->status != 0) return failure("ffmpeg " + how_it_ended(*end), end->output);
  if (!taken_) return failure("ffmpeg ended before it had all frames", end->output);
  const long found = count_video_frames(part_);
  const int wanted = (frames_ + every_ - 1) / every_;
  if (found >= 0 && found != wanted) return failure(fmt::format("ffmpeg wrote {} of {} frames", found, wanted));
  std::error_code error;
  std::filesystem::rename(part_, video_, error);
  if (error) return failure(fmt::format("{} cannot be renamed into place: {}", part_.string(), error.message()));
  return {VideoOutcome::written, "", "", cpu_ms_};
}

long count_video_frames(const std::filesystem::path& video) {
  const auto probe =
      run_program({"ffprobe", "-v", "error", "-protocol_whitelist", "file", "-count_packets", "-select_streams", "v:0",
                   "-show_entries", "stream=nb_read_packets", "-of", "csv=p=0", file_word(video)});
  if (!probe || probe->status != 0) return -1;
  char* end = nullptr;
  const long count = std::strtol(probe->output.c_str(), &end, 10);
  return end == probe->output.c_str() ? -1 : count;
}

}  // namespace supple
