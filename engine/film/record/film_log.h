// Notes the rows of a film's frames in a file, and keeps its checkpoints. Both reach the disk only after all that
// belongs to the frames before them, so a film can be resumed from any checkpoint on the disk, whenever the run was
// killed. Rows are in memory only while their pictures are being made.
#pragma once

#include <deque>
#include <memory>

#include "film/record/checkpoint.h"
#include "output/run/frame_rows.h"
#include "output/run/run_folder.h"

namespace supple {

// Describes the rows of a run's first frames in the run's file of rows: the last of these rows, and how many bytes of
// the file they take. noted_rows() throws InputError where there are fewer rows.
struct NotedRows {
  FrameRow last;
  std::int64_t bytes = 0;
};
NotedRows noted_rows(const std::filesystem::path& file, int frames);

class FilmLog {
 public:
  // every: frames between checkpoints; 0: none, and the file of rows of a film that is not resumed is then removed
  // while it is still open, so that none is left behind. kept: frames of an earlier run, after which this one resumes
  // the film. record: a file outside of the folder that checkpoints rest on too; empty: none.
  FilmLog(const RunFolder& folder, int every, std::string identity, int kept, std::filesystem::path record);

  int frames() const { return whole_ + waiting_rows(); }
  int waiting_rows() const { return int(rows_.size()); }    // rows in memory
  const FrameRow& last_kept() const { return last_kept_; }  // last row of the earlier run
  bool keeps_checkpoints() const { return every_ > 0; }
  bool wants_checkpoint(int frames) const { return every_ > 0 && frames % every_ == 0; }

  // Adds a frame whose steps are done. A frame that is not drawn is whole once the frames before it are.
  void add(FrameRow row) { rows_.push_back(std::move(row)); }
  // Adds a checkpoint, which waits in memory until the frames before it are whole. If the last waiting checkpoint has
  // as many frames or more, that one is kept instead.
  void add(const WorldState& checkpoint);

  // Takes note of what has reached the disk. written: the frames whose pictures reached it since the last call, in
  // their order. Throws RunError when a file cannot be written.
  void settle(const std::vector<PictureTimes>& written);

  // Returns the number of frames that are whole, whatever happens from now on.
  int whole() const { return whole_; }
  // Returns the rows of these frames. They can be read while nothing is added, and after this object is gone.
  FrameRows whole_rows() const;

 private:
  void note_rows(const std::vector<PictureTimes>& written);
  void note_row();

  const RunFolder& folder_;
  int every_;
  std::string identity_;
  std::filesystem::path record_;
  std::filesystem::file_time_type synced_ = std::filesystem::file_time_type::min();  // older files are on the disk
  FrameRow last_kept_;
  std::deque<FrameRow> rows_;  // rows after those of the whole frames
  int whole_ = 0;
  bool broken_ = false;                              // the disk has refused a row
  std::shared_ptr<std::FILE> notes_;                 // the whole rows, a line each
  std::deque<std::pair<int, std::string>> waiting_;  // checkpoints that wait, with their numbers of frames
};

}  // namespace supple
