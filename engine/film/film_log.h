// Keeps the rows of a film's frames, and its checkpoints. Both reach the disk only after all that belongs to the frames
// before them, so a film can be resumed from any checkpoint on the disk, whenever the run was killed.
#pragma once

#include <deque>
#include <memory>

#include "film/checkpoint.h"
#include "film/pictures.h"
#include "output/profile.h"
#include "output/run_folder.h"

namespace supple {

// Holds the rows of a run's first frames, read from the file in which the run noted them, and the number of their bytes
// there. noted_rows() throws InputError where there are fewer rows.
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

  // Adds a frame whose steps are done. A frame that is not drawn is whole once the frames before it are.
  void add(FrameRow row) { rows_.push_back(std::move(row)); }
  // Adds a checkpoint, which waits in memory until the frames before it are whole. If the last one that waits has as
  // many frames or more, it is kept instead.
  void add(const Checkpoint& checkpoint);

  // Takes note of what has reached the disk. pictures: null when there are none. Throws RunError when a file cannot be
  // written.
  void settle(Pictures* pictures);

  // Returns the number of frames that are whole, whatever happens from now on.
  int whole() const { return whole_; }
  // Drops the rows of all other frames, at the end of a film whose pictures failed.
  void drop_others() { rows_.resize(whole_); }
  // Gives the rows away, once the film is over.
  std::vector<FrameRow> take_rows() { return std::move(rows_); }

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
