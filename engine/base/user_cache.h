// A user cache keeps what takes long to make, such as meshes, in files from run to run. An entry is found by a name
// that says all that its content depends on; the running program is always part of the name, so that a build finds only
// what it has made itself. Nothing but time depends on the cache: an entry that is missing or damaged, or cannot be
// written, is made again by the caller. Several programs may use one folder at the same time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace supple {

class UserCache {
 public:
  UserCache() = default;  // keeps nothing and finds nothing
  // The folder is made when the first entry is kept. Where the entries together take more than most_bytes, those that
  // have not been used for longest are removed. An entry that is larger than half of most_bytes is not kept.
  UserCache(std::filesystem::path folder, std::uintmax_t most_bytes);

  // Returns the user's cache in $XDG_CACHE_HOME/supple, or ~/.cache/supple (XDG Base Directory Specification 0.8), with
  // half a gigabyte. Without these variables, it keeps nothing.
  static UserCache of_user();

  const std::filesystem::path& folder() const { return folder_; }  // empty: nothing is kept
  std::uintmax_t most_bytes() const { return most_bytes_; }

  // Returns the content that was kept under this name, and marks it as used; nothing where there is none.
  std::optional<std::string> find(std::string_view name) const;

  // Keeps a content under a name, in the place of an earlier one. Other programs see either the earlier or the new
  // content, and never a part.
  void keep(std::string_view name, std::string_view content) const;

  // Returns the space that all entries take now [bytes].
  std::uintmax_t used_bytes() const;

 private:
  std::filesystem::path file_of(std::string_view full_name) const;
  void make_room() const;

  std::filesystem::path folder_;
  std::uintmax_t most_bytes_ = 0;
};

}  // namespace supple
