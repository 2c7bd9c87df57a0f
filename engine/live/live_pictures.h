// Draws the pictures of a live session on a thread of its own, and keeps the newest as JPEG. Lists that come faster
// than they are drawn replace each other, so that nothing here makes a frame wait.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "film/pictures/pictures.h"
#include "live/live_view.h"
#include "render/gl_context.h"

namespace supple {

struct LivePicture {
  std::uint64_t number = 0;  // counts pictures
  int frame = 0;             // that it shows
  std::uint64_t input = 0;   // number of the last input that it shows
  std::vector<std::uint8_t> jpeg;
};

class LivePictures : public DrawListTarget {
 public:
  LivePictures(GlChoice gl, std::filesystem::path shaders);
  ~LivePictures() override;

  // Goes on with another stage; lists that were put before are dropped.
  void begin(const Stage& stage);
  bool put(int frame, DrawList list) override;
  // Tells the number of the last input that lists from now on show.
  void note_input(std::uint64_t number);

  // Changes the view. The next picture has it: that of the next list or, where none comes, a new one of the last list.
  // input: the number of the command that does this.
  void change_view(const std::function<void(LiveView&)>& change, std::uint64_t input);
  // Returns the camera that the last picture was seen through, and whether it is the page's own.
  Camera seen() const;
  bool has_own_view() const;

  // Returns the newest picture; null before the first one.
  std::shared_ptr<const LivePicture> newest() const;
  // Sets what is called after each picture, on the thread that draws.
  void on_picture(std::function<void()> wake);
  // Returns how long the last picture took to be drawn and compressed [ms].
  double picture_ms() const { return picture_ms_; }
  // Returns why nothing is drawn any more; empty while all is well.
  std::string error() const;

 private:
  struct Order {
    std::optional<Stage> stage;  // where a new one begins
    std::optional<DrawList> list;
    int frame = 0;
    std::uint64_t input = 0;
  };

  void draw_all();
  std::optional<Order> next_order();
  void publish(int frame, std::uint64_t input, std::vector<std::uint8_t> jpeg);

  GlChoice gl_;
  std::filesystem::path shaders_;
  mutable std::mutex mutex_;  // guards all up to error_
  std::condition_variable wanted_;
  Order waiting_;  // what came since the thread took its last order
  bool view_changed_ = false;
  bool closed_ = false;
  LiveView view_;
  std::uint64_t list_input_ = 0, view_input_ = 0;
  std::shared_ptr<const LivePicture> newest_;
  std::string error_;
  std::mutex wake_mutex_;  // held while wake_ runs, so that it is not replaced meanwhile
  std::function<void()> wake_;
  std::atomic<double> picture_ms_ = 0;
  std::thread thread_;  // last, because it uses all of these
};

}  // namespace supple
