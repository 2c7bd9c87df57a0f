// Draws and compresses frames, each on a thread of its own that is fed through a bounded queue: a slow disk slows the
// film and loses nothing.
#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/queue.h"
#include "output/run_folder.h"
#include "render/renderer.h"

namespace supple {

class Pictures {
 public:
  // The folder must outlive it.
  Pictures(const Stage& stage, GlChoice gl, const std::filesystem::path& shaders, const RunFolder& folder);
  ~Pictures() { finish(); }

  // Queues a frame for drawing. Returns false when a stage has failed.
  bool put(int frame, DrawList list) { return lists_.push({frame, std::move(list)}); }

  // Waits until every frame that was put is on the disk.
  void finish();

  // The frames that reached the disk since this was called last, in their order, and their times.
  struct Written {
    int frame;
    double render_ms, encode_ms;
  };
  std::vector<Written> take_written();

  // Why a stage gave up; empty while none has.
  std::string error();
  // Valid after finish().
  std::string backend, renderer, version;

 private:
  struct Drawn {
    int frame;
    double render_ms;
    Image image;
  };

  template <class Work>
  void guarded(const Work& work);
  void draw_all(const Stage& stage, GlChoice gl, const std::filesystem::path& shaders);
  void compress_all();

  const RunFolder& folder_;
  BoundedQueue<std::pair<int, DrawList>> lists_;
  BoundedQueue<Drawn> images_;
  std::thread drawing_, compressing_;
  std::mutex mutex_;
  std::string error_;             // guarded, as what follows
  std::vector<Written> written_;  // and not yet taken
};

}  // namespace supple
