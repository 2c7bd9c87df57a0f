// Writes the replay of a live session on a thread of its own: as a text for those who ask for it, and into a file that
// is whole at any time.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
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
  // Takes the files of a replay, on the keeper's thread; or why there are none.
  using TakesFiles = std::function<void(const ReplayFiles& files, const std::string& error)>;

  // source, settings: those of the script that is played. file: where the replay is kept; empty: nowhere. Throws
  // InputError where this file, or the one beside it that its scene may need, is there already.
  ReplayKeeper(SceneSource source, std::vector<std::string> settings, std::filesystem::path file);
  ~ReplayKeeper() { finish(); }

  // Tells whether notes are wanted for the file.
  bool wants_notes() const;
  // Takes what the file shall have.
  void keep(ReplayNotes notes);
  // Does the same, where the film has gone back: what the file had until now is kept beside it.
  void keep_apart(ReplayNotes notes);
  // Makes the files of a replay that is to be read anywhere. Those who ask while another one is being made share the
  // next. Returns false where too many ask.
  bool write(ReplayNotes notes, TakesFiles take);

  // Writes what is left, and ends. Returns why the file is not as it should be; empty where it is.
  std::string finish();
  // Returns why the file could not be written last; empty while all is well.
  std::string error() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Kept {
    ReplayNotes notes;
    bool apart = false;  // whether what the file has is kept beside it
  };

  void work();
  void answer(const ReplayNotes& notes, const std::vector<TakesFiles>& takers);
  void write_kept(std::vector<Kept> kept);
  void write_pair(const ReplayNotes& notes, const std::filesystem::path& file);
  void put_aside();
  ReplayFiles files_for(const ReplayNotes& notes, const std::filesystem::path& file);

  std::filesystem::path file_;
  Script script_;                       // of the keeper's thread
  std::optional<ReplayNotes> written_;  // what the file has; of the keeper's thread
  mutable std::mutex mutex_;            // guards all below
  std::condition_variable wanted_;
  std::optional<ReplayNotes> asked_;  // for those who ask
  std::vector<TakesFiles> takers_;
  std::vector<Kept> waiting_;  // for the file, in their order
  std::vector<Kept> late_;     // those before them that could not be written
  bool closed_ = false;
  Clock::time_point next_write_;  // before which no notes are wanted
  std::string error_;
  std::thread thread_;
};

}  // namespace supple
