// A library for LD_PRELOAD that makes the n-th call of one kind fail, among those on files below one folder. It tells
// how many there were. By the environment:
//   FAILING_FOLDER   only paths below it count
//   FAILING_CALL     open, read, write, fsync or rename; stdio's calls count as those that they make
//   FAILING_AT       n, from 1; 0: none fails
//   FAILING_PLUG     1: instead of failing, that call pulls the plug: what was not synced is dropped, and the program
//   ends FAILING_COUNT    a file that gets the number of such calls when the program ends
// Programs that the tested one starts inherit the environment; only FAILING_PROGRAM counts.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/types.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>

namespace {

struct Plan {
  std::string folder, call, count_file;
  long at = 0;
  bool pulls_plug = false;
  std::atomic<long> calls{0};

  // A disk would keep the size that each file had when it was synced last, and the names in synced folders.
  std::mutex guard;
  std::map<std::string, off_t> synced;
  std::set<std::string> names;

  Plan() {
    const auto value = [](const char* name) {
      const char* text = std::getenv(name);
      return std::string(text != nullptr ? text : "");
    };
    char self[PATH_MAX] = "";
    if (::readlink("/proc/self/exe", self, sizeof self - 1) < 0 || value("FAILING_PROGRAM") != self) return;
    folder = value("FAILING_FOLDER");
    call = value("FAILING_CALL");
    count_file = value("FAILING_COUNT");
    at = std::atol(value("FAILING_AT").c_str());
    pulls_plug = value("FAILING_PLUG") == "1";
  }
  ~Plan() {
    if (count_file.empty()) return;
    const std::string text = std::to_string(calls) + "\n";
    const std::string name = std::exchange(count_file, "");
    folder.clear();  // nothing fails any more
    if (std::FILE* file = std::fopen(name.c_str(), "w")) {
      std::fputs(text.c_str(), file);
      std::fclose(file);
    }
  }

  bool fails(const char* kind, const std::string& path) {
    if (folder.empty() || call != kind || path.rfind(folder + "/", 0) != 0) return false;
    if (++calls != at) return false;
    if (pulls_plug) pull_plug();
    errno = std::strcmp(kind, "write") == 0 ? ENOSPC : EIO;
    return true;
  }

  bool follows(const std::string& path) const { return pulls_plug && path.rfind(folder + "/", 0) == 0; }

  void note_sync(const std::string& path) {
    if (!follows(path)) return;
    const std::lock_guard<std::mutex> lock(guard);
    std::error_code error;
    if (!std::filesystem::is_directory(path, error)) {
      synced[path] = static_cast<off_t>(std::filesystem::file_size(path, error));
      return;
    }
    names.insert(path);
    for (const auto& entry : std::filesystem::directory_iterator(path, error)) names.insert(entry.path().string());
  }
  // The content moves with the file; the name is on the disk once its folder is synced.
  void note_rename(const std::string& from, const std::string& to) {
    if (!follows(to)) return;
    const std::lock_guard<std::mutex> lock(guard);
    const auto known = synced.find(from);
    synced[to] = known != synced.end() ? known->second : 0;
    synced.erase(from);
  }
  [[noreturn]] void pull_plug() {
    const std::lock_guard<std::mutex> lock(guard);
    std::error_code error;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, error)) {
      const std::string path = entry.path().string();
      if (!entry.is_regular_file(error)) continue;
      if (names.count(path) == 0) {
        ::unlink(path.c_str());
      } else if (const auto size = synced.find(path);
                 size == synced.end() || size->second < off_t(entry.file_size(error))) {
        (void)!::truncate(path.c_str(), size == synced.end() ? 0 : size->second);
      }
    }
    ::_exit(99);
  }
};

Plan& plan() {
  static Plan one;
  return one;
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

std::string path_of(int file) {
  char name[64], path[PATH_MAX];
  std::snprintf(name, sizeof name, "/proc/self/fd/%d", file);
  const ssize_t length = ::readlink(name, path, sizeof path);
  return length > 0 ? std::string(path, static_cast<std::size_t>(length)) : "";
}

// The path as the system sees it; relative ones start at the working folder.
std::string absolute(const char* path) {
  if (path[0] == '/') return path;
  char folder[PATH_MAX];
  return ::getcwd(folder, sizeof folder) != nullptr ? std::string(folder) + "/" + path : path;
}

mode_t mode_of(int flags, va_list more) { return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0; }

}  // namespace

#define FAILING_OPEN(name)                                                 \
  extern "C" int name(const char* path, int flags, ...) {                  \
    va_list more;                                                          \
    va_start(more, flags);                                                 \
    const mode_t mode = mode_of(flags, more);                              \
    va_end(more);                                                          \
    if (plan().fails("open", absolute(path))) return -1;                   \
    return next<int (*)(const char*, int, ...)>(#name)(path, flags, mode); \
  }
FAILING_OPEN(open)
FAILING_OPEN(open64)

#define FAILING_FOPEN(name)                                                   \
  extern "C" std::FILE* name(const char* path, const char* mode) {            \
    if (plan().fails("open", absolute(path))) return nullptr;                 \
    return next<std::FILE* (*)(const char*, const char*)>(#name)(path, mode); \
  }
FAILING_FOPEN(fopen)
FAILING_FOPEN(fopen64)

extern "C" ssize_t read(int file, void* bytes, std::size_t count) {
  if (plan().fails("read", path_of(file))) return -1;
  return next<ssize_t (*)(int, void*, std::size_t)>("read")(file, bytes, count);
}

extern "C" ssize_t write(int file, const void* bytes, std::size_t count) {
  if (plan().fails("write", path_of(file))) return -1;
  return next<ssize_t (*)(int, const void*, std::size_t)>("write")(file, bytes, count);
}

extern "C" std::size_t fread(void* bytes, std::size_t size, std::size_t count, std::FILE* file) {
  if (plan().fails("read", path_of(::fileno(file)))) return 0;
  return next<std::size_t (*)(void*, std::size_t, std::size_t, std::FILE*)>("fread")(bytes, size, count, file);
}

// A full disk shows when the buffer is handed over.
extern "C" int fflush(std::FILE* file) {
  if (file != nullptr && plan().fails("write", path_of(::fileno(file)))) return EOF;
  return next<int (*)(std::FILE*)>("fflush")(file);
}

extern "C" int fsync(int file) {
  if (plan().fails("fsync", path_of(file))) return -1;
  const int result = next<int (*)(int)>("fsync")(file);
  if (result == 0) plan().note_sync(path_of(file));
  return result;
}

extern "C" int rename(const char* from, const char* to) {
  if (plan().fails("rename", absolute(from))) return -1;
  const int result = next<int (*)(const char*, const char*)>("rename")(from, to);
  if (result == 0) plan().note_rename(absolute(from), absolute(to));
  return result;
}
