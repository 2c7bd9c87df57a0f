#include "geometry/skins/mesh_bytes.h"

#include <cstdint>
#include <cstring>

namespace supple {
namespace {

// Appends an array: its number of rows, and then its values.
template <class Values>
void add_values(std::string& bytes, std::uint64_t rows, const Values* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(&rows), sizeof rows);
  bytes.append(reinterpret_cast<const char*>(values), sizeof(Values) * count);
}

template <class Matrix>
void add_rows(std::string& bytes, const Matrix& rows) {
  add_values(bytes, std::uint64_t(rows.rows()), rows.data(), std::size_t(rows.size()));
}

template <class Value>
void add_list(std::string& bytes, const std::vector<Value>& list) {
  add_values(bytes, list.size(), list.data(), list.size());
}

class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}

  template <class Matrix>
  bool rows(Matrix& rows) {
    const std::uint64_t count = next_count(sizeof(typename Matrix::Scalar) * Matrix::ColsAtCompileTime);
    rows.resize(static_cast<Eigen::Index>(count), Matrix::ColsAtCompileTime);
    return take(rows.data(), sizeof(typename Matrix::Scalar) * std::size_t(rows.size()));
  }
  template <class Value>
  bool list(std::vector<Value>& list) {
    list.resize(next_count(sizeof(Value)));
    return take(list.data(), sizeof(Value) * list.size());
  }
  bool at_end() const { return whole_ && rest_.empty(); }

 private:
  // Returns the number of rows of the next array; 0 where fewer are left, and then nothing more is read.
  std::uint64_t next_count(std::size_t row_bytes) {
    std::uint64_t count = 0;
    if (take(&count, sizeof count) && count > rest_.size() / row_bytes) whole_ = false;
    return whole_ ? count : 0;
  }
  bool take(void* values, std::size_t count) {
    whole_ = whole_ && count <= rest_.size();
    if (!whole_ || count == 0) return whole_;
    std::memcpy(values, rest_.data(), count);
    rest_.remove_prefix(count);
    return true;
  }

  std::string_view rest_;
  bool whole_ = true;
};

}  // namespace

std::string bytes_of(const TetMesh& mesh) {
  std::string bytes;
  add_rows(bytes, mesh.rest);
  add_rows(bytes, mesh.tets);
  add_list(bytes, mesh.regions);
  return bytes;
}

std::optional<TetMesh> tet_mesh_from(std::string_view bytes) {
  Reader reader(bytes);
  TetMesh mesh;
  if (!reader.rows(mesh.rest) || !reader.rows(mesh.tets) || !reader.list(mesh.regions)) return std::nullopt;
  return reader.at_end() ? std::optional(std::move(mesh)) : std::nullopt;
}

std::string bytes_of(const CarriedSkin& carried) {
  std::string bytes;
  add_rows(bytes, carried.skin.rest.points);
  add_rows(bytes, carried.skin.rest.triangles);
  add_list(bytes, carried.skin.occlusion);
  add_list(bytes, carried.skin.paint);
  add_list(bytes, carried.skin.square);
  add_list(bytes, carried.skin.flat);
  add_list(bytes, carried.skin.color);
  add_list(bytes, carried.skin.smooth);
  const Embedding& embedding = carried.embedding;
  add_rows(bytes, embedding.corners);
  add_rows(bytes, embedding.weights);
  add_list(bytes, embedding.begin);
  add_list(bytes, embedding.shares);
  add_rows(bytes, embedding.offset);
  add_list(bytes, embedding.frames.vertex);
  add_list(bytes, embedding.frames.begin);
  add_list(bytes, embedding.frames.corner);
  add_rows(bytes, embedding.frames.gradient);
  return bytes;
}

std::optional<CarriedSkin> carried_skin_from(std::string_view bytes) {
  Reader reader(bytes);
  CarriedSkin carried;
  Skin& skin = carried.skin;
  Embedding& embedding = carried.embedding;
  VertexFrames& frames = embedding.frames;
  const bool read = reader.rows(skin.rest.points) && reader.rows(skin.rest.triangles) && reader.list(skin.occlusion) &&
                    reader.list(skin.paint) && reader.list(skin.square) && reader.list(skin.flat) &&
                    reader.list(skin.color) && reader.list(skin.smooth) && reader.rows(embedding.corners) &&
                    reader.rows(embedding.weights) && reader.list(embedding.begin) && reader.list(embedding.shares) &&
                    reader.rows(embedding.offset) && reader.list(frames.vertex) && reader.list(frames.begin) &&
                    reader.list(frames.corner) && reader.rows(frames.gradient);
  return read && reader.at_end() ? std::optional(std::move(carried)) : std::nullopt;
}

}  // namespace supple
