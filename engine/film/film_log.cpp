#include "film/film_log.h"

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>

#include "base/error.h"
#include "base/trace.h"
#include "output/durable.h"
#include "output/whole_file.h"

namespace supple {

NotedRows noted_rows(const std::filesystem::path& file, int frames) {
  NotedRows noted;
  std::ifstream stream(file);
  for (std::string line; int(noted.rows.size()) < frames && std::getline(stream, line);
       noted.bytes += std::int64_t(line.size()) + 1)
    noted.rows.push_back(row_of_line(line, file.string()));
  if (stream.bad()) throw InputError(file.string(), "cannot be read");
  if (int(noted.rows.size()) < frames)
    throw InputError(file.string(), fmt::format("does not have the {} frames to go on from", frames));
  return noted;
}

FilmLog::FilmLog(const RunFolder& folder, int every, std::string identity, int kept, std::filesystem::path record)
    : folder_(folder), every_(every), identity_(std::move(identity)), record_(std::move(record)), whole_(kept) {
  const std::string source = folder.rows().string();
  NotedRows noted = noted_rows(folder.rows(), kept);
  rows_ = std::move(noted.rows);
  if (every_ == 0) return;
  notes_.reset(std::fopen(source.c_str(), kept > 0 ? "r+" : "w"));
  if (!notes_ || ftruncate(fileno(notes_.get()), off_t(noted.bytes)) != 0 || std::fseek(notes_.get(), 0, SEEK_END) != 0)
    throw RunError(fmt::format("{}: cannot be written: {}", source, std::strerror(errno)));
}

void FilmLog::add(const Checkpoint& checkpoint) {
  if (!waiting_.empty() && waiting_.back().first >= checkpoint.frames) return;
  waiting_.emplace_back(checkpoint.frames, checkpoint_bytes(checkpoint, identity_));
}

// Counts the next row as whole, after it has been written to the notes.
void FilmLog::note_row() {
  if (notes_) {
    const std::string line = row_line(rows_[whole_]) + '\n';
    if (std::fwrite(line.data(), 1, line.size(), notes_.get()) != line.size() || std::fflush(notes_.get()) != 0) {
      broken_ = true;
      throw RunError(fmt::format("{}: cannot be written: {}", folder_.rows().string(), std::strerror(errno)));
    }
  }
  ++whole_;
}

void FilmLog::settle(Pictures* pictures) {
  const Zone zone("run's log");
  if (!broken_) note_rows(pictures);
  for (; !waiting_.empty() && waiting_.front().first <= whole_; waiting_.pop_front()) {
    // Frames, motion, rows and the record reach the disk before the checkpoint that rests on them.
    const auto now = std::filesystem::file_time_type::clock::now();
    sync_tree(folder_.path(), synced_);
    if (!record_.empty()) sync_to_disk(record_);
    write_durable_file(folder_.checkpoint(), waiting_.front().second);
    synced_ = now - std::chrono::seconds(2);  // clocks of file systems are coarse
  }
}

void FilmLog::note_rows(Pictures* pictures) {
  const auto settle_undrawn = [this] {
    while (whole_ < int(rows_.size()) && !rows_[whole_].draw_ms) note_row();
  };
  settle_undrawn();
  const auto written = pictures != nullptr ? pictures->take_written() : std::vector<Pictures::Written>();
  for (const Pictures::Written& frame : written) {
    if (whole_ == int(rows_.size())) break;  // drawn, but its row never came
    rows_[whole_].render_ms = frame.render_ms;
    rows_[whole_].compress_ms = frame.compress_ms;
    note_row();
    settle_undrawn();
  }
}

}  // namespace supple
