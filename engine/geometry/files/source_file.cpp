#include "geometry/files/source_file.h"

#include "base/hash.h"

namespace supple {
namespace {

template <class Matrix>
std::uint64_t hash_of(const Matrix& rows, std::uint64_t seed) {
  return hash_bytes(rows.data(), sizeof(typename Matrix::Scalar) * static_cast<std::size_t>(rows.size()), seed);
}

}  // namespace

SourceFile source_of(const std::filesystem::path& path, const TetMesh& mesh) {
  const std::uint64_t hash = hash_of(mesh.tets, hash_of(mesh.rest, 0));
  return {path, hash_bytes(mesh.regions.data(), sizeof(int) * mesh.regions.size(), hash)};
}

SourceFile source_of(const std::filesystem::path& path, const TriMesh& mesh) {
  return {path, hash_of(mesh.triangles, hash_of(mesh.points, 0))};
}

SourceFile source_of(const std::filesystem::path& path, const SolidSurface& surface) {
  SourceFile source = source_of(path, surface.boundary);
  if (surface.drawn.triangles.rows() > 0)
    source.hash = hash_of(surface.drawn.triangles, hash_of(surface.drawn.points, source.hash));
  return source;
}

std::string content_name(const std::vector<SourceFile>& files) {
  std::string name;
  for (const SourceFile& file : files) name += (name.empty() ? "" : " ") + hash_text_form(file.hash);
  return name;
}

}  // namespace supple
