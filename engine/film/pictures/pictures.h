// Draws frames, compresses them and hands them to the film's encoder. These stages have threads of their own and are
// connected by bounded queues, so a slow stage slows the film and loses nothing. Frames leave in the order in which
// they were put.
#pragma once

#include <filesystem>
#include <future>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/queue.h"
#include "output/run/profile.h"
#include "output/video/video.h"
#include "render/renderer.h"

namespace supple {

// Describes where frames go. All that it points to must outlive the pictures.
struct PictureTargets {
  std::filesystem::path frames;  // the folder of the files
  bool files = true;             // frames become PNG files
  VideoEncoder* film = nullptr;  // null: there is no film
  int kept_frames = 0;           // frames of an earlier run, with whose files the film begins
};

// Takes the draw lists of frames, in their order.
class DrawListTarget {
 public:
  virtual ~DrawListTarget() = default;
  // Returns false when no more lists can be drawn.
  virtual bool put(int frame, DrawList list) = 0;
};

class Pictures : public DrawListTarget {
 public:
  Pictures(const Stage& stage, GlChoice gl, const std::filesystem::path& shaders, const PictureTargets& targets);
  ~Pictures() override { finish(); }

  // Queues a frame for drawing. Returns false when a stage has failed.
  bool put(int frame, DrawList list) override { return lists_.push({frame, std::move(list)}); }

  // Waits until every frame that was put has reached its destination.
  void finish();

  // Returns the frames that have been written since the last call, in their order, with their times. Without files, a
  // frame counts as written once it is in the film.
  std::vector<PictureTimes> take_written();

  // Returns why a stage failed; empty while none has.
  std::string error();
  // These values are valid after finish().
  std::string backend, renderer, version;

 private:
  struct Picture {
    int frame;
    double render_ms;
    Image image;
    double compress_ms = 0;
    std::vector<std::uint8_t> png;  // empty without files
  };

  template <class Work>
  void guarded(const Work& work);
  void draw_all(const Stage& stage, GlChoice gl, const std::filesystem::path& shaders);
  bool pass_on(Picture picture);
  void compress_all(int number);
  void write_all();
  void add_to_film(const Image& image);

  const PictureTargets targets_;
  const Vec3 background_;  // sRGB
  BoundedQueue<std::pair<int, DrawList>> lists_;
  BoundedQueue<std::packaged_task<Picture()>> drawn_;  // to be compressed
  BoundedQueue<std::future<Picture>> pictures_;        // all pictures, in the order in which they are written
  std::thread drawing_, writing_;
  std::vector<std::thread> compressing_;
  std::mutex mutex_;
  std::string error_;                  // mutex_ guards this and the next member
  std::vector<PictureTimes> written_;  // frames that take_written() has not returned yet
};

}  // namespace supple
