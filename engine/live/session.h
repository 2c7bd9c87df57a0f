// Plays a scene for a page: guides the loop over frames (film/frame_loop.h) by the clock and by the page's commands,
// and tells pages what becomes of them. Everything that is done goes through World::change, grab and release, so that
// the replay of it has the same bits.
//
// Not here: how commands come in and pictures go out (server.h).
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "film/frame_loop.h"
#include "live/event_log.h"
#include "live/grabbed_way.h"
#include "live/live_pictures.h"
#include "live/mailbox.h"
#include "live/page_events.h"
#include "live/pick.h"
#include "live/replay_keeper.h"
#include "live/timeline.h"
#include "output/run/row_tally.h"

namespace supple {

// Holds what the session and the server of its page share. All of it may be used by both at any time.
struct LiveDesk {
  LiveDesk(GlChoice gl, std::filesystem::path shaders) : pictures(gl, std::move(shaders)) {}
  std::atomic<std::uint64_t> inputs = 0;  // number of the last command
  std::atomic<bool> is_followed = false;  // whether a page has been opened; frames wait for the first one
  Mailbox mailbox;
  EventLog events;
  LivePictures pictures;
};

class LiveSession : public FrameGuide {
 public:
  // The loop must be of this world. All that is passed must outlive this object. starts_paused: frames wait for a
  // command.
  LiveSession(LiveDesk& desk, World& world, FrameLoop& loop, ReplayKeeper& keeper, bool starts_paused);
  ~LiveSession() override;

  // Plays until the program is interrupted, or pictures can no longer be drawn. Returns why they cannot; empty where
  // they can.
  std::string play();

  std::optional<FilmEnd> ends() override;
  void take(FrameRow row) override;

  // Tells pages what is played. record: the file of the replay; empty: none.
  void tell_scene(const std::string& record) { events_.tell_scene(record); }
  // Tells whether something was done that the last replay that was asked for does not have.
  bool has_unsaved_edits() const;

  int frames() const { return timeline_.frames(); }

 private:
  using Clock = std::chrono::steady_clock;
  using Json = nlohmann::ordered_json;
  struct Grabbed;
  struct Pin {
    std::string name;  // of the grab
    int frames;        // that there were before it was pinned
  };

  void serve_commands();
  void serve(const PostedCommand& posted);
  void save(const PostedCommand& posted);
  Json carry_out(const Command& command);
  void change(const std::string& path, const std::string& value, double over);
  Json grab(const Command& command);
  void drag(const Command& command);
  void move_to_pointer();
  void drop(bool stays);
  void release(const std::string& body, const std::string& name);
  void release_dropped();
  void go(int frames);
  void show(const Command& command);
  void keep_view();
  void keep_rate(bool on);
  void set_budgets(double ms);
  void adjust_budget();

  void note(TimedEdit edit);
  void recover(const std::string& message);
  void draw_on_new_stage();
  ReplayNotes notes() const;
  double period_ms() const { return 1000 / (world_.scene().fps * state_.speed); }
  double measured_rate() const;
  std::string name_for_grab(const Body& body) const;
  std::vector<LiveGrab> holding() const;
  bool is_pending(const LiveGrab& grab) const;
  bool is_pinned(const LiveGrab& grab) const;
  void tell_state();
  void tell_words();

  LiveDesk& desk_;
  World& world_;
  FrameLoop& loop_;
  ReplayKeeper& keeper_;
  PageEvents events_;
  Timeline timeline_;
  RowTally tally_;  // of the frames since the film last went back

  std::unique_ptr<Grabbed> grabbed_;  // what the pointer holds; null: nothing
  std::vector<Release> pending_;      // grabs that were dropped before they took hold
  std::vector<Pin> pins_;             // grabs that hold without a pointer, or did

  PageState state_;  // tell_state() fills in what it can find out itself
  bool steps_once_ = false;
  Clock::time_point due_;                // when the next frame may begin
  Clock::time_point begun_;              // when the last frame began
  std::deque<Clock::time_point> ended_;  // when the last frames ended, since the film last began to run
  std::deque<double> frame_ms_;          // times of the last frames, without waiting [ms]

  double budget_ms_ = 0;                                             // the budget of a step that keeps the rate [ms]
  std::vector<std::pair<std::string, std::string>> budgets_before_;  // by path: budgets before keep_rate()

  std::shared_ptr<std::atomic<std::size_t>> saved_;  // number of edits in the last replay that was asked for
  bool controls_changed_ = false;
  std::string failure_;     // of the step that failed last, until the next frame is made
  std::string told_error_;  // of the keeper
};

}  // namespace supple
