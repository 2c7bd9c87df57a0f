#include "live/replay_keeper.h"

#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "base/error.h"
#include "base/signals.h"
#include "base/trace.h"
#include "film/plan/shipped_files.h"
#include "output/files/whole_file.h"

namespace supple {
namespace {

constexpr std::chrono::seconds between_writes{1};

}  // namespace

ReplayKeeper::ReplayKeeper(SceneSource source, std::vector<std::string> settings, std::filesystem::path file)
    : file_(std::move(file)), script_(Script::load(source, assets_folder(), settings)) {
  std::error_code error;
  if (!file_.empty() && std::filesystem::exists(file_, error))
    throw InputError("--record-replay " + file_.string(), "is there already, and would be written over");
  if (!file_.empty() && file_.has_parent_path() && !std::filesystem::is_directory(file_.parent_path(), error))
    throw InputError("--record-replay " + file_.string(), "no such folder");
  const BlockedSignals meanwhile;  // the thread that makes the frames takes signals
  thread_ = std::thread([this] {
    name_thread("replay");
    work();
  });
}

ReplayKeeper::~ReplayKeeper() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    wanted_.notify_one();
  }
  thread_.join();
}

bool ReplayKeeper::wants_notes() const {
  if (file_.empty()) return false;
  const std::lock_guard lock(mutex_);
  return waiting_.empty() && Clock::now() - kept_at_ > between_writes;
}

void ReplayKeeper::take(ReplayNotes notes, bool begins_anew) {
  if (file_.empty()) return;
  const std::lock_guard lock(mutex_);
  if (waiting_.empty() || begins_anew) waiting_.emplace_back().begins_anew = begins_anew;
  waiting_.back().notes = std::move(notes);
  wanted_.notify_one();
}

void ReplayKeeper::write(ReplayNotes notes, std::function<void(const ReplayFiles&, const std::string&)> take) {
  const std::lock_guard lock(mutex_);
  orders_.push_back({std::move(notes), std::move(take)});
  wanted_.notify_one();
}

std::string ReplayKeeper::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

void ReplayKeeper::work() {
  for (;;) {
    std::vector<Order> orders;
    std::vector<Kept> kept;
    {
      std::unique_lock lock(mutex_);
      wanted_.wait(lock, [this] { return closed_ || !orders_.empty() || !waiting_.empty(); });
      orders = std::exchange(orders_, {});
      kept = std::exchange(waiting_, {});
      if (closed_ && orders.empty() && kept.empty()) return;
    }
    for (const Order& order : orders) {
      try {
        order.take(files_for(order.notes, std::filesystem::path("/") / (script_.scene().name + "-live.toml")), "");
      } catch (const std::exception& error) {
        order.take({}, error.what());
      }
    }
    if (kept.empty()) continue;
    std::string error;
    try {
      keep(kept);
    } catch (const std::exception& failed) {
      error = failed.what();
    }
    const std::lock_guard lock(mutex_);
    error_ = error;
    kept_at_ = Clock::now();
  }
}

ReplayFiles ReplayKeeper::files_for(const ReplayNotes& notes, const std::filesystem::path& file) {
  script_.set_edits(notes.edits);
  return script_.replay_files(file, std::max(notes.frames, 1), notes.session);
}

void ReplayKeeper::keep(const std::vector<Kept>& all) {
  for (const Kept& kept : all) {
    if (kept.begins_anew) put_aside();
    if (kept.notes.frames == 0) continue;
    const ReplayFiles files = files_for(kept.notes, file_);
    if (!files.scene.empty()) write_whole_file(files.scene, files.scene_text);
    write_whole_file(file_, files.replay_text);
  }
}

// Gives what the file has a name with the first number that is free.
void ReplayKeeper::put_aside() {
  std::error_code error;
  if (!std::filesystem::exists(file_, error)) return;
  for (int number = 1;; ++number) {
    std::filesystem::path aside = file_;
    aside.replace_filename(fmt::format("{}-{}{}", file_.stem().string(), number, file_.extension().string()));
    if (std::filesystem::exists(aside, error)) continue;
    std::filesystem::rename(file_, aside);
    return;
  }
}

}  // namespace supple
