#include "live/live_pictures.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "base/signals.h"
#include "base/timing.h"
#include "base/trace.h"
#include "output/files/jpeg.h"
#include "render/renderer.h"

namespace supple {
namespace {

constexpr int jpeg_quality = 88;  // of the JPEG: no blocks that one sees at the size of the page

// Adds to a list what an older one, which was never drawn, has changed of the stage for good.
void take_changes(DrawList older, DrawList& list) {
  const auto add = [](auto& before, auto& now) {
    for (auto& one : before) {
      const auto same = [&one](const auto& other) { return other.first == one.first; };
      if (std::ranges::none_of(now, same)) now.push_back(std::move(one));
    }
  };
  add(older.renewed, list.renewed);
  add(older.captions, list.captions);
  if (!list.colors) list.colors = std::move(older.colors);
}

}  // namespace

LivePictures::LivePictures(GlChoice gl, std::filesystem::path shaders) : gl_(gl), shaders_(std::move(shaders)) {
  const BlockedSignals meanwhile;  // the thread that makes the frames takes signals
  thread_ = std::thread([this] {
    name_thread("render");
    try {
      draw_all();
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex_);
      error_ = error.what();
    }
  });
}

LivePictures::~LivePictures() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    wanted_.notify_one();
  }
  thread_.join();
}

void LivePictures::begin(const Stage& stage) {
  const std::lock_guard lock(mutex_);
  waiting_.stage = stage;
  waiting_.list.reset();
}

bool LivePictures::put(int frame, DrawList list) {
  const std::lock_guard lock(mutex_);
  if (waiting_.list) take_changes(std::move(*waiting_.list), list);
  waiting_.list = std::move(list);
  waiting_.frame = frame;
  waiting_.input = list_input_;
  wanted_.notify_one();
  return error_.empty();
}

void LivePictures::note_input(std::uint64_t number) {
  const std::lock_guard lock(mutex_);
  list_input_ = number;
}

void LivePictures::change_view(const std::function<void(LiveView&)>& change, std::uint64_t input) {
  const std::lock_guard lock(mutex_);
  change(view_);
  view_input_ = input;
  view_changed_ = true;
  wanted_.notify_one();
}

Camera LivePictures::seen() const {
  const std::lock_guard lock(mutex_);
  return view_.seen();
}

bool LivePictures::has_own_view() const {
  const std::lock_guard lock(mutex_);
  return view_.is_own();
}

std::shared_ptr<const LivePicture> LivePictures::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

void LivePictures::on_picture(std::function<void()> wake) {
  const std::lock_guard lock(wake_mutex_);
  wake_ = std::move(wake);
}

std::string LivePictures::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

// Waits for a list or another view. Returns nothing at the end.
std::optional<LivePictures::Order> LivePictures::next_order() {
  std::unique_lock lock(mutex_);
  wanted_.wait(lock, [this] { return closed_ || waiting_.list || view_changed_; });
  if (closed_) return std::nullopt;
  view_changed_ = false;
  return std::exchange(waiting_, {});
}

void LivePictures::draw_all() {
  std::unique_ptr<Renderer> renderer;
  Vec3 background = Vec3::Zero();
  Order drawn;  // the last list, which another view shows again
  while (std::optional<Order> order = next_order()) {
    if (order->stage) {
      renderer.reset();  // before the next one: both would hold the context
      renderer = std::make_unique<Renderer>(*order->stage, gl_, shaders_);
      background = backdrop_of(*order->stage);
      drawn = {};
    }
    if (order->list) drawn = std::move(*order);
    if (!renderer || !drawn.list) continue;
    const Stopwatch watch;
    const Zone zone("render", {}, drawn.frame);
    DrawList& list = *drawn.list;
    const Camera of_scene = list.camera;
    std::uint64_t view_input = 0;
    {
      const std::lock_guard lock(mutex_);
      list.camera = view_.see(list);
      view_input = view_input_;
    }
    const Image image = renderer->draw(list);
    list.camera = of_scene;  // for another picture of the same list, which has taken effect on the stage
    list.renewed.clear();
    list.captions.clear();
    list.colors.reset();
    std::vector<std::uint8_t> jpeg =
        jpeg_bytes(image.width, image.height, image.alpha.empty() ? image.rgb : over(image, background), jpeg_quality);
    picture_ms_ = watch.elapsed_ms();
    publish(drawn.frame, std::max(drawn.input, view_input), std::move(jpeg));
  }
}

void LivePictures::publish(int frame, std::uint64_t input, std::vector<std::uint8_t> jpeg) {
  {
    const std::lock_guard lock(mutex_);
    const std::uint64_t number = newest_ ? newest_->number + 1 : 1;
    newest_ = std::make_shared<const LivePicture>(LivePicture{number, frame, input, std::move(jpeg)});
  }
  const std::lock_guard lock(wake_mutex_);
  if (wake_) wake_();
}

}  // namespace supple
