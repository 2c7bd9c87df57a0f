#include "film/pictures/pictures.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "base/error.h"
#include "base/signals.h"
#include "base/timing.h"
#include "base/trace.h"
#include "output/files/exr_file.h"
#include "output/files/png_file.h"
#include "output/files/whole_file.h"
#include "output/run/run_folder.h"

namespace supple {
namespace {

constexpr std::size_t frames_in_flight = 3;  // frames that may wait between two stages

// Frames are independent, so a second thread halves the time where compression is the slowest stage; elsewhere it
// sleeps.
constexpr int compressing_threads = 2;

}  // namespace

Pictures::Pictures(const Stage& stage, GlChoice gl, const std::filesystem::path& shaders, const PictureTargets& targets)
    : targets_(targets), lists_(frames_in_flight), drawn_(frames_in_flight), pictures_(frames_in_flight) {
  const BlockedSignals meanwhile;  // the thread that makes the frames takes signals
  drawing_ = std::thread([this, stage, gl, shaders] { guarded([&] { draw_all(stage, gl, shaders); }); });
  for (int number = 1; targets_.files && number <= compressing_threads; ++number)
    compressing_.emplace_back([this, number] { guarded([&] { compress_all(number); }); });
  writing_ = std::thread([this] { guarded([this] { write_all(); }); });
}

void Pictures::finish() {
  lists_.close();
  if (drawing_.joinable()) drawing_.join();
  drawn_.close();
  pictures_.close();
  for (std::thread& thread : compressing_) {
    if (thread.joinable()) thread.join();
  }
  if (writing_.joinable()) writing_.join();
}

bool Pictures::want_next() const {
  return std::ranges::find(targets_.passes, PicturePass::motion) != targets_.passes.end();
}

std::vector<PictureTimes> Pictures::take_written() {
  const std::lock_guard lock(mutex_);
  return std::exchange(written_, {});
}

std::string Pictures::error() {
  const std::lock_guard lock(mutex_);
  return error_;
}

// Runs a stage. A stage that fails closes the queues, and its error is kept for error().
template <class Work>
void Pictures::guarded(const Work& work) {
  try {
    work();
    return;
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    if (error_.empty()) error_ = error.what();
  }
  lists_.close();
  drawn_.close();
  pictures_.close();
}

void Pictures::draw_all(const Stage& stage, GlChoice gl, const std::filesystem::path& shaders) {
  name_thread("render");
  Zone start("start renderer");
  Renderer renderer_object(stage, gl, shaders);
  backend = renderer_object.backend();
  renderer = renderer_object.name();
  version = renderer_object.version();
  start.finish();
  std::optional<Listed> waiting;  // for the next list
  while (auto item = lists_.pop()) {
    if (!want_next()) {
      if (!draw_one(renderer_object, *item, nullptr)) return;
      continue;
    }
    if (waiting && !draw_one(renderer_object, *waiting, &item->list)) return;
    waiting = std::move(item);
  }
  if (waiting) draw_one(renderer_object, *waiting, nullptr);
}

// Draws a picture and hands it on. next: the list of the next one; null where there is none, or nobody asks for it.
// Returns false when another stage has failed.
bool Pictures::draw_one(Renderer& drawing, const Listed& listed, const DrawList* next) {
  if (listed.use == ListUse::none) return true;
  Zone zone("render", {}, listed.frame);
  const Stopwatch watch;
  Picture picture{listed.frame, listed.use == ListUse::picture, 0, drawing.draw(listed.list)};
  if (!targets_.passes.empty()) {
    zone.next("passes");
    picture.passes = drawing.passes(listed.list, next, targets_.passes);
  }
  picture.render_ms = watch.elapsed_ms();
  zone.next("wait for output");
  return pass_on(std::move(picture));
}

// Hands a picture to the other stages. Returns false when one has failed.
bool Pictures::pass_on(Picture picture) {
  const bool files = targets_.files;
  std::packaged_task<Picture()> task([this, picture = std::move(picture)]() mutable {
    compress(picture);
    return std::move(picture);
  });
  std::future<Picture> result = task.get_future();
  if (!files) task();
  return (!files || drawn_.push(std::move(task))) && pictures_.push(std::move(result));
}

void Pictures::compress(Picture& picture) const {
  const bool png = targets_.files && picture.is_new;
  if (!png && picture.passes.empty()) return;
  const Zone zone("compress", {}, picture.frame);
  const Stopwatch watch;
  const Image& image = picture.image;
  if (png)
    picture.png = image.alpha.empty() ? png_bytes(image.width, image.height, image.rgb)
                                      : png_bytes(image.width, image.height, image.rgb, image.alpha);
  for (PassImage& pass : picture.passes)
    picture.pass_files.push_back(exr_bytes(image.width, image.height, std::exchange(pass.values, {})));
  picture.compress_ms = watch.elapsed_ms();
}

void Pictures::compress_all(int number) {
  name_thread("compress", number);
  while (auto task = drawn_.pop()) (*task)();  // the future passes an error on to the thread that writes
}

// Adds a frame to the film. When the encoder fails, the files stay valid. Without files the frame would be lost, so the
// pictures fail.
void Pictures::add_to_film(const Image& image) {
  if (targets_.film == nullptr) return;
  if (targets_.film->add(image.rgb, image.alpha) || targets_.files) return;
  throw RunError("the film's encoder takes no more frames, and there are no files of them");
}

// Writes the passes before the picture, so that a picture that is there has its passes.
void Pictures::write_files(const Picture& picture) const {
  for (std::size_t i = 0; i < picture.passes.size(); ++i) {
    const PassImage& pass = picture.passes[i];
    const std::filesystem::path file = pass_file(targets_.passes_folder, pass.pass, pass.mesh, picture.frame);
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    write_whole_file(file, picture.pass_files[i]);
  }
  if (targets_.files && picture.is_new) write_whole_file(picture_file(targets_.frames, picture.frame), picture.png);
}

void Pictures::write_all() {
  name_thread("output");
  if (targets_.film != nullptr) targets_.film->add_files(targets_.frames, targets_.kept_frames);
  while (auto result = pictures_.pop()) {
    Picture picture = result->get();
    Zone zone("write", {}, picture.frame);
    const Stopwatch watch;
    write_files(picture);
    if (!picture.is_new) continue;
    const double write_ms = watch.elapsed_ms();
    zone.next("wait for film");
    add_to_film(picture.image);
    const std::lock_guard lock(mutex_);
    written_.push_back({picture.frame, picture.render_ms,
                        targets_.files ? std::optional(picture.compress_ms + write_ms) : std::nullopt});
  }
}

}  // namespace supple
