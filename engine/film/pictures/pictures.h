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
  std::filesystem::path passes_folder = {};
  std::vector<PicturePass> passes = {};  // that are written beside the pictures
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
  bool put(int frame, DrawList list) override { return lists_.push({frame, std::move(list), ListUse::picture}); }

  // Tells whether a picture has to know the list of the next one, because motion is among the passes. It is then drawn
  // only once that list has come, or when there are no more lists.
  bool want_next() const;
  // Queues the frame before the first one that is put, whose picture and passes an earlier run has left. Its passes are
  // written again, now that there is a next picture.
  bool put_earlier(int frame, DrawList list) { return lists_.push({frame, std::move(list), ListUse::passes}); }
  // Queues the list of the frame after the last one that is put, which is not drawn.
  bool put_next(int frame, DrawList list) { return lists_.push({frame, std::move(list), ListUse::none}); }

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
  enum class ListUse { picture, passes, none };  // what is made of a frame
  struct Listed {
    int frame;
    DrawList list;
    ListUse use;
  };
  struct Picture {
    int frame;
    bool is_new;  // false where its passes alone are written
    double render_ms;
    Image image;
    std::vector<PassImage> passes = {};
    double compress_ms = 0;
    std::vector<std::uint8_t> png = {};                      // empty without files
    std::vector<std::vector<std::uint8_t>> pass_files = {};  // of `passes`, whose values are then gone
  };

  template <class Work>
  void guarded(const Work& work);
  void draw_all(const Stage& stage, GlChoice gl, const std::filesystem::path& shaders);
  bool draw_one(Renderer& drawing, const Listed& listed, const DrawList* next);
  bool pass_on(Picture picture);
  void compress(Picture& picture) const;
  void compress_all(int number);
  void write_all();
  void write_files(const Picture& picture) const;
  void add_to_film(const Image& image);

  const PictureTargets targets_;
  BoundedQueue<Listed> lists_;
  BoundedQueue<std::packaged_task<Picture()>> drawn_;  // to be compressed
  BoundedQueue<std::future<Picture>> pictures_;        // all pictures, in the order in which they are written
  std::thread drawing_, writing_;
  std::vector<std::thread> compressing_;
  std::mutex mutex_;
  std::string error_;                  // mutex_ guards this and the next member
  std::vector<PictureTimes> written_;  // frames that take_written() has not returned yet
};

}  // namespace supple
