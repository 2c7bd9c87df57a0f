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
#include <vector>

#include "film/frame_loop.h"
#include "live/event_log.h"
#include "live/grabbed_way.h"
#include "live/live_pictures.h"
#include "live/mailbox.h"
#include "live/pick.h"
#include "live/replay_keeper.h"
#include "live/timeline.h"
#include "output/run/row_tally.h"

namespace supple {

// Holds what the session and the server of its page share. All of it may be used by both at any time.
struct LiveDesk {
  LiveDesk(GlChoice gl, std::filesystem::path shaders) : pictures(gl, std::move(shaders)) {}
  std::atomic<std::uint64_t> inputs = 0;  // number of the last command
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

  // Plays until the program is interrupted. Returns why that was not the end: pictures can no longer be drawn.
  std::string play();

  std::optional<FilmEnd> ends() override;
  void take(FrameRow row) override;

  // Tells pages what is played. record: the file of the replay; empty: none.
  void tell_scene(const std::string& record);
  // Tells whether something was done that no replay has that was asked for since.
  bool has_unsaved_edits() const;

  const std::vector<FrameRow>& rows() const { return timeline_.rows(); }

 private:
  using Clock = std::chrono::steady_clock;
  using Json = nlohmann::ordered_json;
  struct Grabbed;

  void take_letters();
  void serve(const Letter& letter);
  Json carry_out(const Command& command);
  void set(const Command& command);
  void change(const std::string& path, const std::string& value, double over);
  Json grab(const Command& command);
  void drag(const Command& command);
  void move_to_pointer();
  void drop(bool stays);
  void release(const std::string& body, const std::string& name);
  void go(int frames);
  void show(const Command& command);
  void keep_view();
  void keep_rate(bool on);
  void adjust_budget();
  double period_ms() const { return 1000 / (world_.scene().fps * speed_); }
  void go_on_with_pictures();

  void release_dropped();
  void recover(const std::string& message);
  ReplayNotes notes() const;
  double measured_rate();
  std::string name_for_grab(const Body& body) const;
  std::string value_of(const std::string& path) const;
  std::vector<LiveGrab> holding() const;
  void tell_state();
  void tell_controls();
  void tell_words();
  void tell_frame(const FrameRow& row);
  void say(const std::string& text);

  LiveDesk& desk_;
  World& world_;
  FrameLoop& loop_;
  ReplayKeeper& keeper_;
  Timeline timeline_;
  RowTally tally_;                    // of the timeline's rows
  std::unique_ptr<Grabbed> grabbed_;  // what the pointer holds; null: nothing
  bool paused_, steps_once_ = false, keeps_rate_ = false;
  double speed_ = 1;
  Clock::time_point begun_;              // when the last frame began
  std::deque<double> frame_ms_;          // times of the last frames, without waiting [ms]
  Clock::time_point due_;                // when the next frame may begin
  std::deque<Clock::time_point> ended_;  // when the last frames ended, since the film last began to run
  std::string budget_before_ = "0";      // solver.budget_ms before keep_rate
  double budget_ms_ = 0;                 // that keep_rate has set
  std::string field_ = "none";
  bool wireframe_ = false, marks_ = false;
  std::vector<std::string> dress_;   // the settings of the pictures
  std::vector<Release> pending_;     // grabs that were dropped before they took hold
  std::vector<std::string> pinned_;  // names of grabs that hold without a pointer
  bool told_own_view_ = false;
  std::size_t saved_ = 0;  // number of deeds that the last replay has that was asked for
  std::string told_words_;
  std::vector<LiveKey> told_controls_;
};

}  // namespace supple
