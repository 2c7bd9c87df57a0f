#include "film/pictures.h"

#include <exception>
#include <utility>

#include "base/signals.h"
#include "base/timing.h"
#include "base/trace.h"
#include "output/png_file.h"

namespace supple {
namespace {

constexpr std::size_t frames_in_flight = 3;  // between two stages

}  // namespace

Pictures::Pictures(const Stage& stage, GlChoice gl, const std::filesystem::path& shaders, const RunFolder& folder)
    : folder_(folder), lists_(frames_in_flight), images_(frames_in_flight) {
  const BlockedSignals meanwhile;  // the thread that makes the frames takes signals
  drawing_ = std::thread([this, stage, gl, shaders] { guarded([&] { draw_all(stage, gl, shaders); }); });
  compressing_ = std::thread([this] { guarded([this] { compress_all(); }); });
}

void Pictures::finish() {
  lists_.close();
  if (drawing_.joinable()) drawing_.join();
  images_.close();
  if (compressing_.joinable()) compressing_.join();
}

std::vector<Pictures::Written> Pictures::take_written() {
  const std::lock_guard lock(mutex_);
  return std::exchange(written_, {});
}

std::string Pictures::error() {
  const std::lock_guard lock(mutex_);
  return error_;
}

// Runs a stage. One that fails closes the queues, and its error waits to be collected.
template <class Work>
void Pictures::guarded(const Work& work) {
  try {
    work();
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    if (error_.empty()) error_ = error.what();
  }
  lists_.close();
  images_.close();
}

void Pictures::draw_all(const Stage& stage, GlChoice gl, const std::filesystem::path& shaders) {
  name_thread("render");
  Zone start("start renderer");
  Renderer renderer_object(stage, gl, shaders);
  backend = renderer_object.backend();
  renderer = renderer_object.name();
  version = renderer_object.version();
  start.finish();
  while (auto item = lists_.pop()) {
    Zone zone("render", {}, item->first);
    const Stopwatch watch;
    Image image = renderer_object.draw(item->second);
    const double ms = watch.elapsed_ms();
    zone.next("wait for encode");
    if (!images_.push({item->first, ms, std::move(image)})) return;
  }
}

void Pictures::compress_all() {
  name_thread("encode");
  while (auto drawn = images_.pop()) {
    const Zone zone("encode", {}, drawn->frame);
    const Stopwatch watch;
    write_png(folder_.frame(drawn->frame), drawn->image.width, drawn->image.height, drawn->image.rgb);
    const std::lock_guard lock(mutex_);
    written_.push_back({drawn->frame, drawn->render_ms, watch.elapsed_ms()});
  }
}

}  // namespace supple
