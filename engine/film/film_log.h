// The rows of a film's frames, and its checkpoints, which reach the disk only after all that belongs to the frames
// before them. So a film can be resumed from a checkpoint that is there, whenever it was killed.
#pragma once

#include <deque>
#include <memory>

#include "film/checkpoint.h"
#include "film/pictures.h"
#include "output/profile.h"
#include "output/run_folder.h"

namespace supple {

// Reads the rows of a run's first frames from the file in which it noted them, and counts their bytes there. Throws
// InputError where there are fewer.
struct NotedRows {
  std::vector<FrameRow> rows;
  std::int64_t bytes = 0;
};
NotedRows noted_rows(const std::filesystem::path& file, int frames);

class FilmLog {
 public:
  // every: frames between checkpoints; 0: none. kept: frames of an earlier run, after which this one resumes the film.
  // record: a file outside of the folder that checkpoints rest on too; empty: none.
  FilmLog(const RunFolder& folder, int every, std::string identity, int kept, std::filesystem::path record);

  const std::vector<FrameRow>& rows() const { return rows_; }
  bool keeps_checkpoints() const { return every_ > 0; }
  bool wants_checkpoint(int frames) const { return every_ > 0 && frames % every_ == 0; }

  // Adds a frame whose steps are done. A frame that is not drawn is whole once those before it are.
  void add(FrameRow row) { rows_.push_back(std::move(row)); }
  // Adds a checkpoint, which waits in memory until the frames before it are whole. One of as many frames that waits
  // already is kept instead.
  void add(const Checkpoint& checkpoint);

  // Takes note of what has reached the disk; null: there are no pictures. Throws RunError when the disk refuses.
  void settle(Pictures* pictures);

  // The number of frames that are whole, whatever happens from now on.
  int whole() const { return whole_; }
  // Forgets the others, at the end of a film whose pictures failed.
  void drop_others() { rows_.resize(whole_); }

 private:
  void note_rows(Pictures* pictures);
  void note_row();

  const RunFolder& folder_;
  int every_;
  std::string identity_;
  std::filesystem::path record_;
  std::filesystem::file_time_type synced_ = std::filesystem::file_time_type::min();  // older files are on the disk
  std::vector<FrameRow> rows_;
  int whole_ = 0;
  bool broken_ = false;  // the disk has refused a row
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> notes_;          // rows so far, a line each; only with checkpoints
  std::deque<std::pair<int, std::string>> waiting_;  // checkpoints by frames
};

}  // namespace supple
