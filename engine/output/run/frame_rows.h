// Gives the rows of a run one after the other, from memory or from the file in which a film notes them, so that those
// of a long film need not be in memory.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "output/run/profile.h"

namespace supple {

class FrameRows {
 public:
  FrameRows() = default;
  // Refers to rows in memory, which must outlive this object.
  explicit FrameRows(const std::vector<FrameRow>& rows) : rows_(&rows), size_(int(rows.size())) {}
  // Takes the first `size` rows of an open file that has one row a line (row_line). name: the name of the file, for
  // messages.
  FrameRows(std::shared_ptr<std::FILE> file, std::filesystem::path name, int size)
      : file_(std::move(file)), name_(std::move(name)), size_(size) {}

  int size() const { return size_; }
  bool empty() const { return size_ == 0; }

  // Passes all rows on in order. Throws RunError where the file cannot be read or does not have them.
  void each(const std::function<void(const FrameRow&)>& take) const;

 private:
  const std::vector<FrameRow>* rows_ = nullptr;
  std::shared_ptr<std::FILE> file_;
  std::filesystem::path name_;
  int size_ = 0;
};

}  // namespace supple
