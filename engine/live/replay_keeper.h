// Writes the replay of a live session on a thread of its own: as a text for who asks, and into a file that is whole at
// any time.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "scene/replay/script.h"

namespace supple {

// Holds all that a replay says beyond its scene.
struct ReplayNotes {
  int frames = 0;
  LiveEdits edits;
  PlayedSession session;
};

class ReplayKeeper {
 public:
  // source, settings: those of the script that is played. file: where the replay is kept; empty: nowhere. It is written
  // when there is a frame, and no other file is written over: throws InputError where one is there.
  ReplayKeeper(SceneSource source, std::vector<std::string> settings, std::filesystem::path file);
  ~ReplayKeeper();  // after the last notes have been written

  // Tells whether notes are wanted for the file, which is renewed about once a second.
  bool wants_notes() const;
  // Takes what the file shall have. begins_anew: what the file has is a past that was left, and is kept beside it.
  void take(ReplayNotes notes, bool begins_anew = false);
  // Makes the files of a replay that is to be read anywhere, and passes them to `take` on the keeper's thread: or why
  // there are none.
  void write(ReplayNotes notes, std::function<void(const ReplayFiles& files, const std::string& error)> take);

  // Returns why the file could not be written; empty while all is well.
  std::string error() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Order {
    ReplayNotes notes;
    std::function<void(const ReplayFiles&, const std::string&)> take;
  };
  struct Kept {
    ReplayNotes notes;
    bool begins_anew = false;
  };

  void work();
  ReplayFiles files_for(const ReplayNotes& notes, const std::filesystem::path& file);
  void keep(const std::vector<Kept>& all);
  void put_aside();

  std::filesystem::path file_;
  Script script_;  // of the keeper's thread
  mutable std::mutex mutex_;
  std::condition_variable wanted_;
  std::vector<Order> orders_;
  std::vector<Kept> waiting_;  // for the file, in their order
  bool closed_ = false;
  Clock::time_point kept_at_;
  std::string error_;
  std::thread thread_;
};

}  // namespace supple
