#include "base/user_cache.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <vector>

#include "base/hash.h"

namespace supple {
namespace {

namespace fs = std::filesystem;

// An entry's file has the signature, then the name and the content, each with its length before it, and then the XXH64
// of all this.
constexpr std::string_view signature = "supple cache 1\n";
constexpr const char* suffix = ".entry";
constexpr const char* unfinished_suffix = ".part";

std::string full_name(std::string_view name) { return fmt::format("{} {}", hash_text_form(program_identity()), name); }

void add_number(std::string& bytes, std::uint64_t number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

// Returns the bytes of an entry that precede its content.
std::string head_of(std::string_view name, std::size_t length) {
  std::string bytes(signature);
  add_number(bytes, name.size());
  bytes += name;
  add_number(bytes, length);
  return bytes;
}

std::string file_bytes(std::string_view name, std::string_view content) {
  std::string bytes = head_of(name, content.size());
  bytes += content;
  add_number(bytes, hash_text(bytes));
  return bytes;
}

std::optional<std::string> read_whole(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) return std::nullopt;
  std::string bytes(size, '\0');
  if (!file.read(bytes.data(), static_cast<std::streamsize>(size))) return std::nullopt;
  return bytes;
}

// Returns the content of an entry's file; nothing where the file is damaged or has another name.
std::optional<std::string> content_of(std::string bytes, std::string_view name) {
  constexpr std::size_t number = sizeof(std::uint64_t);
  const std::size_t before = signature.size() + 2 * number + name.size();
  if (bytes.size() < before + number) return std::nullopt;
  const std::size_t length = bytes.size() - before - number;
  const std::string head = head_of(name, length);
  std::uint64_t hash = 0;
  std::memcpy(&hash, bytes.data() + before + length, number);
  if (!bytes.starts_with(head) || hash_bytes(bytes.data(), before + length) != hash) return std::nullopt;
  return bytes.erase(before + length).erase(0, before);
}

bool write_whole(const fs::path& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  return static_cast<bool>(file);
}

struct Entry {
  fs::path path;
  fs::file_time_type used;
  std::uintmax_t bytes;
};

// Lists all files of a cache, those of writers that were killed included.
std::vector<Entry> entries_in(const fs::path& folder) {
  std::vector<Entry> entries;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const fs::path extension = at->path().extension();
    if (extension != suffix && extension != unfinished_suffix) continue;
    std::error_code gone;  // another program may remove it meanwhile
    const Entry entry{at->path(), at->last_write_time(gone), at->file_size(gone)};
    if (!gone) entries.push_back(entry);
  }
  return entries;
}

// Returns the folder that a variable names. A relative path does not count, as the specification wants it.
fs::path folder_in(const char* variable) {
  const char* value = std::getenv(variable);
  const fs::path path = value == nullptr ? "" : value;
  return path.is_absolute() ? path : fs::path();
}

}  // namespace

UserCache::UserCache(fs::path folder, std::uintmax_t most_bytes)
    : folder_(std::move(folder)), most_bytes_(most_bytes) {}

UserCache UserCache::of_user() {
  constexpr std::uintmax_t most_bytes = 512u << 20;
  fs::path caches = folder_in("XDG_CACHE_HOME");
  const fs::path home = folder_in("HOME");
  if (caches.empty() && !home.empty()) caches = home / ".cache";
  return caches.empty() ? UserCache() : UserCache(caches / "supple", most_bytes);
}

fs::path UserCache::file_of(std::string_view full_name) const {
  const std::uint64_t first = hash_text(full_name), second = hash_bytes(full_name.data(), full_name.size(), first);
  return folder_ / (hash_text_form(first) + hash_text_form(second) + suffix);
}

std::optional<std::string> UserCache::find(std::string_view name) const {
  if (folder_.empty()) return std::nullopt;
  const std::string full = full_name(name);
  const fs::path path = file_of(full);
  std::optional<std::string> bytes = read_whole(path);
  if (!bytes) return std::nullopt;
  std::optional<std::string> content = content_of(std::move(*bytes), full);
  std::error_code ignored;
  if (content) fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);
  return content;
}

void UserCache::keep(std::string_view name, std::string_view content) const {
  static std::atomic<int> count{0};  // so that threads of this program use different files, too
  if (folder_.empty() || content.size() > most_bytes_ / 2) return;
  std::error_code error;
  const bool made = fs::create_directories(folder_, error);
  if (made) fs::permissions(folder_, fs::perms::owner_all, error);
  const std::string full = full_name(name);
  const fs::path path = file_of(full);
  const fs::path part = path.string() + fmt::format(".{}-{}{}", ::getpid(), count++, unfinished_suffix);
  bool whole = write_whole(part, file_bytes(full, content));
  if (whole) {
    fs::rename(part, path, error);
    whole = !error;
  }
  if (!whole) fs::remove(part, error);
  make_room();
}

void UserCache::make_room() const {
  std::vector<Entry> entries = entries_in(folder_);
  std::ranges::sort(entries, [](const Entry& a, const Entry& b) { return a.used < b.used; });
  std::uintmax_t all = 0;
  for (const Entry& entry : entries) all += entry.bytes;
  const auto now = fs::file_time_type::clock::now();
  for (const Entry& entry : entries) {
    const bool abandoned = entry.path.extension() == unfinished_suffix && now - entry.used > std::chrono::hours(1);
    const bool too_much = entry.path.extension() == suffix && all > most_bytes_;
    if (!abandoned && !too_much) continue;
    std::error_code ignored;
    fs::remove(entry.path, ignored);
    all -= entry.bytes;
  }
}

std::uintmax_t UserCache::used_bytes() const {
  std::uintmax_t all = 0;
  for (const Entry& entry : entries_in(folder_)) all += entry.bytes;
  return all;
}

}  // namespace supple
