#include "geometry/files/surface_file.h"

#include <cstring>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>

#include "base/companion_program.h"
#include "base/error.h"
#include "geometry/files/announced_counts.h"
#include "geometry/files/reader_process.h"
#include "geometry/files/surface_stream.h"
#include "geometry/solids/closed_surface.h"

namespace supple {
namespace {

constexpr std::uintmax_t largest_file = 1u << 30;

// Throws InputError where the path names no plain file, and where the file cannot be opened, is empty or is too large.
void check_plain_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::string name = path.string();
  if (!std::filesystem::exists(path, error)) throw InputError(name, "no such file");
  if (std::filesystem::is_directory(path, error)) throw InputError(name, "is a directory");
  if (!std::filesystem::is_regular_file(path, error)) throw InputError(name, "is not a file");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw InputError(name, "cannot be read");
  if (size == 0) throw InputError(name, "is empty");
  if (size > largest_file) throw InputError(name, "is larger than 1 GiB");
  if (!std::ifstream(path, std::ios::binary)) throw InputError(name, "cannot be opened");
}

void check_file(const std::filesystem::path& path) {
  check_plain_file(path);
  std::ifstream file(path, std::ios::binary);
  std::string begin(most_header_bytes, '\0');
  file.read(begin.data(), std::streamsize(begin.size()));
  begin.resize(std::size_t(file.gcount()));
  std::error_code error;
  const std::string wrong = announced_too_much(begin, std::filesystem::file_size(path, error));
  if (!wrong.empty()) throw InputError(path.string(), wrong);
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
  std::string text(std::int64_t count) {
    std::string result(std::size_t(count), '\0');
    take(result.data(), result.size());
    return result;
  }
  std::string_view rest() const { return rest_; }
  [[noreturn]] void refuse() const { throw InputError(name_, "is broken: its reader wrote half a surface"); }

 private:
  std::string_view rest_;
  std::string name_;
};

std::shared_ptr<const std::vector<Texture>> textures_from(Stream& in, std::int64_t count) {
  namespace stream = surface_stream;
  if (count == 0) return nullptr;
  std::vector<Texture> textures(static_cast<std::size_t>(count));
  std::int64_t pixels = 0;
  for (Texture& texture : textures) {
    stream::TextureHead head;
    in.take(&head, 1);
    const auto is_wrap = [](std::int32_t rule) { return rule >= 0 && rule <= std::int32_t(Wrap::mirror); };
    pixels += std::int64_t(head.width) * head.height;
    if (head.width <= 0 || head.height <= 0 || pixels > stream::most_pixels || head.name < 0 || !is_wrap(head.wrap_u) ||
        !is_wrap(head.wrap_v))
      in.refuse();
    texture.width = head.width;
    texture.height = head.height;
    texture.wrap_u = Wrap(head.wrap_u);
    texture.wrap_v = Wrap(head.wrap_v);
    texture.name = in.text(head.name);
    texture.rgb.resize(3 * std::size_t(head.width) * std::size_t(head.height));
    in.take(texture.rgb.data(), texture.rgb.size());
  }
  return std::make_shared<const std::vector<Texture>>(std::move(textures));
}

// Returns the names of the parts, and checks the part of each vertex.
SurfaceParts parts_from(const std::string& text, std::vector<std::int32_t> of, const Stream& in) {
  SurfaceParts parts;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::vector<std::string>& names = parts.names.emplace_back();
    for (std::string name; std::getline(words, name, '\t');) names.push_back(name);
  }
  for (const std::int32_t part : of)
    if (part < 0 || part >= std::ssize(parts.names)) in.refuse();
  parts.of = std::move(of);
  return parts;
}

ColoredSurface decode(const std::string& bytes, const std::string& name) {
  namespace stream = surface_stream;
  Stream in(bytes, name);
  char head[8];
  in.take(head, sizeof head);
  if (std::memcmp(head, stream::refused, sizeof head) == 0) {
    stream::Place place;
    in.take(&place, 1);
    if (place.line > 0) throw InputError({Problem{{name, place.line, place.column}, std::string(in.rest())}});
    throw InputError(name, fmt::format("cannot be read: {}", in.rest()));
  }
  stream::Counts counts;
  in.take(&counts, 1);
  const auto within = [](std::int64_t count, std::int64_t most) { return count >= 0 && count <= most; };
  if (std::memcmp(head, stream::accepted, sizeof head) != 0 || !within(counts.vertices, stream::most_vertices) ||
      !within(counts.triangles, stream::most_triangles) || (counts.colors != 0 && counts.colors != counts.vertices) ||
      !within(counts.textures, stream::most_textures) || !within(counts.remarks, stream::most_text) ||
      !within(counts.found, stream::most_text) || (counts.places != 0 && counts.places != counts.vertices) ||
      (counts.part_of != 0 && counts.part_of != counts.vertices) || !within(counts.names, stream::most_names))
    in.refuse();
  ColoredSurface surface;
  surface.mesh = {Positions(counts.vertices, 3), Triangles(counts.triangles, 3)};
  in.take(surface.mesh.points.data(), std::size_t(surface.mesh.points.size()));
  in.take(surface.mesh.triangles.data(), std::size_t(surface.mesh.triangles.size()));
  surface.colors.resize(std::size_t(counts.colors));
  in.take(surface.colors.data(), surface.colors.size());
  for (const SurfaceColor& color : surface.colors)
    if (color.texture < -1 || color.texture >= counts.textures) in.refuse();
  surface.textures = textures_from(in, counts.textures);
  surface.places.resize(std::size_t(counts.places));
  in.take(surface.places.data(), surface.places.size());
  std::vector<std::int32_t> part_of(std::size_t(counts.part_of));
  in.take(part_of.data(), part_of.size());
  std::istringstream remarks(in.text(counts.remarks));
  for (std::string line; std::getline(remarks, line);) surface.remarks.push_back(line);
  surface.found = in.text(counts.found);
  surface.parts = parts_from(in.text(counts.names), std::move(part_of), in);
  return surface;
}

}  // namespace

std::filesystem::path surface_reader_program() {
  if (const auto beside = companion_program("supple-read-surface")) return *beside;
  std::error_code error;
  const std::filesystem::path built = SUPPLE_SURFACE_READER;  // for tests, which lie elsewhere in the build's folder
  if (std::filesystem::is_regular_file(built, error)) return built;
  return SUPPLE_INSTALLED_READER;  // for a program elsewhere that uses the library
}

ColoredSurface read_colored_surface(const std::filesystem::path& path) {
  check_file(path);
  return decode(run_reader(surface_reader_program(), path), path.string());
}

Texture read_picture(const std::filesystem::path& path) {
  check_plain_file(path);
  const std::string name = path.string();
  const ColoredSurface read =
      decode(run_reader(surface_reader_program(), path, {}, surface_stream::picture_mode), name);
  if (!read.textures || read.textures->size() != 1) throw InputError(name, "is broken: its reader wrote no picture");
  return read.textures->front();
}

TriMesh read_closed_surface(const std::filesystem::path& path, std::vector<std::string>* notes) {
  return closed_surface(read_colored_surface(path).mesh, path.string(), notes);
}

SolidSurface read_solid_surface(const std::filesystem::path& path, const SurfaceOptions& options,
                                std::vector<std::string>* notes) {
  return solid_surface(set_up(read_colored_surface(path).mesh, options), options, path.string(), notes);
}

}  // namespace supple
