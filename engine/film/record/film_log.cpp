#include "film/record/film_log.h"

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>

#include "base/error.h"
#include "base/trace.h"
#include "output/files/durable.h"
#include "output/files/whole_file.h"

namespace supple {

NotedRows noted_rows(const std::filesystem::path& file, int frames) {
  NotedRows noted;
  std::ifstream stream(file);
  int count = 0;
  for (std::string line; count < frames && std::getline(stream, line); noted.bytes += std::int64_t(line.size()) + 1) {
    noted.last = row_of_line(line, file.string());
    ++count;
  }
  if (stream.bad()) throw InputError(file.string(), "cannot be read");
  if (count < frames) throw InputError(file.string(), fmt::format("does not have the {} frames to go on from", frames));
  return noted;
}

FilmLog::FilmLog(const RunFolder& folder, int every, std::string identity, int kept, std::filesystem::path record)
    : folder_(folder), every_(every), identity_(std::move(identity)), record_(std::move(record)), whole_(kept) {
  const std::string source = folder.rows().string();
  NotedRows noted = noted_rows(folder.rows(), kept);
  last_kept_ = std::move(noted.last);
  notes_.reset(std::fopen(source.c_str(), kept > 0 ? "r+" : "w+"), [](std::FILE* file) {
    if (file != nullptr) std::fclose(file);
  });
  if (!notes_ || ftruncate(fileno(notes_.get()), off_t(noted.bytes)) != 0 || std::fseek(notes_.get(), 0, SEEK_END) != 0)
    throw RunError(fmt::format("{}: cannot be written: {}", source, std::strerror(errno)));
  std::error_code ignored;
  if (every_ == 0 && kept == 0) std::filesystem::remove(folder.rows(), ignored);  // it stays open without a name
}

FrameRows FilmLog::whole_rows() const { return {notes_, folder_.rows(), whole_}; }

void FilmLog::add(const WorldState& checkpoint) {
  if (!waiting_.empty() && waiting_.back().first >= checkpoint.frames) return;
  waiting_.emplace_back(checkpoint.frames, checkpoint_bytes(checkpoint, identity_));
}

// Counts the next row as whole, after it has been written to the notes.
void FilmLog::note_row() {
  const std::string line = row_line(rows_.front()) + '\n';
  if (std::fwrite(line.data(), 1, line.size(), notes_.get()) != line.size() || std::fflush(notes_.get()) != 0) {
    broken_ = true;
    throw RunError(fmt::format("{}: cannot be written: {}", folder_.rows().string(), std::strerror(errno)));
  }
  rows_.pop_front();
  ++whole_;
}

void FilmLog::settle(const std::vector<PictureTimes>& written) {
  const Zone zone("run's log");
  if (!broken_) note_rows(written);
  for (; !waiting_.empty() && waiting_.front().first <= whole_; waiting_.pop_front()) {
    // Frames, motion, rows and the record reach the disk before the checkpoint that rests on them.
    const auto now = std::filesystem::file_time_type::clock::now();
    sync_tree(folder_.path(), synced_);
    if (!record_.empty()) sync_to_disk(record_);
    write_durable_file(folder_.checkpoint(), waiting_.front().second);
    synced_ = now - std::chrono::seconds(2);  // clocks of file systems are coarse
  }
}

void FilmLog::note_rows(const std::vector<PictureTimes>& written) {
  const auto settle_undrawn = [this] {
    while (!rows_.empty() && !rows_.front().draw_ms) note_row();
  };
  settle_undrawn();
  for (const PictureTimes& frame : written) {
    if (rows_.empty()) break;  // the frame was drawn, but its row never came
    rows_.front().render_ms = frame.render_ms;
    rows_.front().compress_ms = frame.compress_ms;
    note_row();
    settle_undrawn();
  }
}

}  // namespace supple
