#include "live/replay_keeper.h"

#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "base/error.h"
#include "base/signals.h"
#include "base/trace.h"
#include "film/plan/loaded_film.h"
#include "output/files/whole_file.h"

namespace supple {
namespace {

constexpr std::chrono::seconds between_writes{1};
constexpr int rest = 10;                // for so many times as long as a write took, there is no other
constexpr std::size_t most_takers = 8;  // of one text

// Returns the file beside a replay for a scene that no other file has (Script::replay_files).
std::filesystem::path scene_beside(const std::filesystem::path& file) {
  return file.parent_path() / (file.stem().string() + "-scene.toml");
}

void refuse_existing(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::exists(file, error))
    throw InputError("--record-replay", fmt::format("{} is there already, and would be written over", file.string()));
}

}  // namespace

ReplayKeeper::ReplayKeeper(SceneSource source, std::vector<std::string> settings, std::filesystem::path file)
    : file_(std::move(file)), script_(load_script(source, settings)) {
  std::error_code error;
  if (!file_.empty()) {
    refuse_existing(file_);
    refuse_existing(scene_beside(file_));
    if (file_.has_parent_path() && !std::filesystem::is_directory(file_.parent_path(), error))
      throw InputError("--record-replay", fmt::format("{}: no such folder", file_.parent_path().string()));
  }
  const BlockedSignals meanwhile;  // the thread that makes the frames takes signals
  thread_ = std::thread([this] {
    name_thread("replay");
    work();
  });
}

std::string ReplayKeeper::finish() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    wanted_.notify_one();
  }
  if (thread_.joinable()) thread_.join();
  return error();
}

bool ReplayKeeper::wants_notes() const {
  if (file_.empty()) return false;
  const std::lock_guard lock(mutex_);
  return waiting_.empty() && Clock::now() > next_write_;
}

void ReplayKeeper::keep(ReplayNotes notes) {
  if (file_.empty()) return;
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) waiting_.emplace_back();
  waiting_.back().notes = std::move(notes);
  wanted_.notify_one();
}

void ReplayKeeper::keep_apart(ReplayNotes notes) {
  if (file_.empty()) return;
  const std::lock_guard lock(mutex_);
  waiting_.push_back({std::move(notes), true});
  wanted_.notify_one();
}

bool ReplayKeeper::write(ReplayNotes notes, TakesFiles take) {
  const std::lock_guard lock(mutex_);
  if (takers_.size() >= most_takers) return false;
  asked_ = std::move(notes);
  takers_.push_back(std::move(take));
  wanted_.notify_one();
  return true;
}

std::string ReplayKeeper::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

void ReplayKeeper::work() {
  for (;;) {
    std::optional<ReplayNotes> asked;
    std::vector<TakesFiles> takers;
    std::vector<Kept> kept;
    {
      std::unique_lock lock(mutex_);
      wanted_.wait(lock, [this] { return closed_ || asked_ || !waiting_.empty(); });
      asked = std::exchange(asked_, std::nullopt);
      takers = std::exchange(takers_, {});
      kept = std::exchange(waiting_, {});
      if (!kept.empty())
        kept.insert(kept.begin(), std::make_move_iterator(late_.begin()), std::make_move_iterator(late_.end()));
      if (!kept.empty()) late_.clear();
      if (closed_ && !asked && kept.empty()) return;
    }
    if (asked) answer(*asked, takers);
    if (!kept.empty()) write_kept(std::move(kept));
  }
}

void ReplayKeeper::answer(const ReplayNotes& notes, const std::vector<TakesFiles>& takers) {
  ReplayFiles files;
  std::string error;
  try {
    files = files_for(notes, std::filesystem::path("/") / (script_.scene().name + "-live.toml"));
  } catch (const std::exception& failed) {
    error = failed.what();
  }
  for (const TakesFiles& take : takers) take(files, error);
}

// Writes all that was to be kept.
void ReplayKeeper::write_kept(std::vector<Kept> kept) {
  const Clock::time_point begin = Clock::now();
  std::string error;
  auto next = kept.begin();
  try {
    for (; next != kept.end(); ++next) {
      if (next->apart) put_aside();
      next->apart = false;
      if (next->notes.frames > 0) write_pair(next->notes, file_);
      if (next->notes.frames > 0) written_ = std::move(next->notes);
    }
  } catch (const std::exception& failed) {
    error = fmt::format("the replay is not kept: {}", failed.what());
  }
  const std::lock_guard lock(mutex_);
  error_ = error;
  const Clock::time_point now = Clock::now();
  next_write_ = now + std::max<Clock::duration>(between_writes, rest * (now - begin));
  // What is to stay apart from the past is tried again before anything newer; all else is replaced by newer notes.
  const bool is_needed = std::any_of(next, kept.end(), [](const Kept& one) { return one.apart; });
  if (is_needed) late_.insert(late_.end(), std::make_move_iterator(next), std::make_move_iterator(kept.end()));
}

void ReplayKeeper::write_pair(const ReplayNotes& notes, const std::filesystem::path& file) {
  const ReplayFiles files = files_for(notes, file);
  if (!files.scene.empty()) write_whole_file(files.scene, files.scene_text);
  write_whole_file(file, files.replay_text);
}

ReplayFiles ReplayKeeper::files_for(const ReplayNotes& notes, const std::filesystem::path& file) {
  script_.set_edits(notes.edits);
  return script_.replay_files(file, std::max(notes.frames, 1), notes.session);
}

// Writes what the file has into one with the first number that is free, so that the file can have another film.
void ReplayKeeper::put_aside() {
  if (!written_) return;
  std::error_code error;
  for (int number = 1;; ++number) {
    std::filesystem::path aside = file_;
    aside.replace_filename(fmt::format("{}-{}{}", file_.stem().string(), number, file_.extension().string()));
    if (std::filesystem::exists(aside, error) || std::filesystem::exists(scene_beside(aside), error)) continue;
    write_pair(*written_, aside);
    std::filesystem::remove(file_, error);
    std::filesystem::remove(scene_beside(file_), error);
    written_.reset();
    return;
  }
}

}  // namespace supple
