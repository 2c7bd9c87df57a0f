#include "geometry/surface_file.h"

#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>

#include "base/error.h"
#include "geometry/announced_counts.h"
#include "geometry/reader_process.h"
#include "geometry/surface_stream.h"

namespace supple {
namespace {

constexpr std::uintmax_t largest_file = 1u << 30;

void check_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::string name = path.string();
  if (!std::filesystem::exists(path, error)) throw InputError(name, "no such file");
  if (std::filesystem::is_directory(path, error)) throw InputError(name, "is a directory");
  if (!std::filesystem::is_regular_file(path, error)) throw InputError(name, "is not a file");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw InputError(name, "cannot be read");
  if (size == 0) throw InputError(name, "is empty");
  if (size > largest_file) throw InputError(name, "is larger than 1 GiB");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(name, "cannot be opened");
  std::string begin(most_header_bytes, '\0');
  file.read(begin.data(), std::streamsize(begin.size()));
  begin.resize(std::size_t(file.gcount()));
  const std::string wrong = announced_too_much(begin, size);
  if (!wrong.empty()) throw InputError(name, wrong);
}

// Reads values one by one from the front of the reader's bytes.
class Stream {
 public:
  Stream(std::string_view bytes, std::string name) : rest_(bytes), name_(std::move(name)) {}

  template <class T>
  void take(T* values, std::size_t count) {
    if (count > rest_.size() / sizeof(T)) refuse();
    if (count == 0) return;  // an empty array has no address to copy to
    std::memcpy(values, rest_.data(), count * sizeof(T));
    rest_.remove_prefix(count * sizeof(T));
  }
  std::string_view rest() const { return rest_; }
  [[noreturn]] void refuse() const { throw InputError(name_, "is broken: its reader wrote half a surface"); }

 private:
  std::string_view rest_;
  std::string name_;
};

TriMesh decode(const std::string& bytes, const std::string& name) {
  namespace stream = surface_stream;
  Stream in(bytes, name);
  char head[8];
  in.take(head, sizeof head);
  if (std::memcmp(head, stream::refused, sizeof head) == 0)
    throw InputError(name, fmt::format("cannot be read: {}", in.rest()));
  std::int64_t counts[2];
  in.take(counts, 2);
  if (std::memcmp(head, stream::accepted, sizeof head) != 0 || counts[0] < 0 || counts[1] < 0 ||
      counts[0] > stream::most_vertices || counts[1] > stream::most_triangles)
    in.refuse();
  TriMesh mesh{Positions(counts[0], 3), Triangles(counts[1], 3)};
  in.take(mesh.points.data(), std::size_t(mesh.points.size()));
  in.take(mesh.triangles.data(), std::size_t(mesh.triangles.size()));
  return mesh;
}

}  // namespace

std::filesystem::path surface_reader_program() {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  for (const std::filesystem::path& place :
       {folder / "supple-read-surface", folder / SUPPLE_LIBEXEC_FROM_BIN / "supple-read-surface",
        std::filesystem::path(SUPPLE_SURFACE_READER)})
    if (std::filesystem::is_regular_file(place, error)) return place;
  return SUPPLE_INSTALLED_READER;  // of a program elsewhere that uses the library
}

namespace {

TriMesh read_triangles(const std::filesystem::path& path) {
  check_file(path);
  return decode(run_reader(surface_reader_program(), path), path.string());
}

}  // namespace

TriMesh read_closed_surface(const std::filesystem::path& path, std::vector<std::string>* notes) {
  return closed_surface(read_triangles(path), path.string(), notes);
}

SolidSurface read_solid_surface(const std::filesystem::path& path, const SurfaceOptions& options,
                                std::vector<std::string>* notes) {
  return solid_surface(set_up(read_triangles(path), options), options, path.string(), notes);
}

}  // namespace supple
