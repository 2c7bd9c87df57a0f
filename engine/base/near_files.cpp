#include "base/near_files.h"

#include <fmt/core.h>

#include <algorithm>
#include <system_error>

#include "base/text.h"

namespace supple {

std::filesystem::path near_file(const std::filesystem::path& missing,
                                const std::function<bool(const std::filesystem::path&)>& fits,
                                const std::vector<std::string>& names) {
  constexpr std::size_t most_entries = 10000;  // number of a folder's entries that are looked at
  const std::filesystem::path path =
      (missing / "").lexically_normal().parent_path();  // the path without a slash at its end
  const std::filesystem::path folder = path.parent_path();
  std::vector<std::filesystem::path> shown(names.begin(), names.end());
  std::error_code error;
  std::size_t seen = 0;
  for (std::filesystem::directory_iterator entry(folder.empty() ? "." : folder, error), end;
       !error && entry != end && seen < most_entries; entry.increment(error), ++seen) {
    if (fits(entry->path())) shown.push_back(folder / entry->path().filename());
  }
  const auto files = shown.begin() + std::ptrdiff_t(names.size());
  std::sort(files, shown.end());
  // A path with a folder is more likely to mean a file in that folder than one of the names, so its files come first.
  if (!folder.empty()) std::rotate(shown.begin(), files, shown.end());
  std::vector<std::string> words;
  for (const std::filesystem::path& one : shown) words.push_back(one.stem().string());
  const std::string nearest = nearest_word(path.stem().string(), words);
  if (nearest.empty()) return {};
  return shown[static_cast<std::size_t>(std::ranges::find(words, nearest) - words.begin())];
}

std::string meant_file(const std::filesystem::path& file) {
  return file.empty() ? "" : fmt::format("; did you mean '{}'?", file.string());
}

}  // namespace supple
