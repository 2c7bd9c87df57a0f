#include "render/surface_buffers.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "render/color.h"
#include "render/view.h"

namespace supple {
namespace {

// A mesh's material takes this many texels of four floats: linear colours with gloss, of which the first is the
// uncovered surface and eight are its layers; the widths of the layers' borders, one in each of eight texels; the kind
// of print, whether it shows the field, whether its edges are drawn, and whether it has the colours of its file; the
// colour of a cloth's back with 0 for no cloth, 1 for this colour and 2 for a tone of the front's; the distance of its
// yarns and the width of its hem; what it lets through, and how far that light goes inside.
constexpr std::size_t material_texels = 21;

// In the place of a gloss, a roughness is written larger by this.
constexpr double rough_above = 2;

// Returns what is written for the gloss of a part of a surface. A painted part keeps a gloss that is above what the
// roughness of the surface leaves, so that eyes shine in a face of chalk, and a wet face is wet all over.
double shine(double gloss, const Finish& finish, bool painted) {
  if (!finish.roughness || (painted && gloss > 1 - *finish.roughness)) return gloss;
  return rough_above + *finish.roughness;
}

// Returns the way in a body after which a third of the light is left that has entered it [m]. A cloth is thin; for it,
// this is how far away towards the lamp a thing lies that leaves it a third of the light.
double way_of_light(const DrawMesh& mesh) {
  constexpr double through_solid = 0.25, behind_cloth = 0.03;  // over the body's size
  return (mesh.cloth ? behind_cloth : through_solid * mesh.finish.translucent) * mesh.rest.diagonal();
}

void append_translucency(const DrawMesh& mesh, float* out) {
  if (mesh.mapped || mesh.finish.translucent == 0) return;
  out[0] = static_cast<float>(mesh.finish.translucent);
  out[1] = static_cast<float>(way_of_light(mesh));
}

void append_cloth(const DrawMesh& mesh, float* out) {
  // A surface that shows a field has neither sides nor yarns, as it has no print.
  if (!mesh.cloth || mesh.mapped) return;
  const Vec3 back = linear_of(mesh.cloth->back.value_or(Vec3::Zero()));
  for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(back[k]);
  out[3] = mesh.cloth->back ? 1.0f : 2.0f;
  out[4] = static_cast<float>(mesh.cloth->yarn);
  out[5] = static_cast<float>(mesh.cloth->hem);
}

void append_material(const DrawMesh& mesh, std::vector<float>& out) {
  const std::size_t begin = out.size();
  out.resize(begin + 4 * material_texels);
  const auto put = [&](std::size_t slot, const Vec3& srgb, double gloss) {
    const Vec3 linear = linear_of(srgb);
    for (int k = 0; k < 3; ++k) out[begin + 4 * slot + k] = static_cast<float>(linear[k]);
    out[begin + 4 * slot + 3] = static_cast<float>(gloss);
  };
  put(0, mesh.color, shine(mesh.gloss, mesh.finish, false));
  for (std::size_t layer = 0; layer < std::min<std::size_t>(mesh.layers.size(), 8); ++layer) {
    put(layer + 1, mesh.layers[layer].color, shine(mesh.layers[layer].gloss, mesh.finish, true));
    out[begin + 4 * (layer + 9)] = static_cast<float>(mesh.layers[layer].soft);
  }
  // A surface that shows a field has no print: its lines would be taken for values of the field, or for shadows.
  const bool printed = !mesh.square.empty() && !mesh.mapped;
  out[begin + 4 * 17] = !printed ? 0.0f : mesh.printed == Printed::grid ? 1.0f : 2.0f;
  out[begin + 4 * 17 + 1] = mesh.mapped ? 1.0f : 0.0f;
  out[begin + 4 * 17 + 2] = mesh.wires ? 1.0f : 0.0f;
  out[begin + 4 * 17 + 3] = mesh.surface_colors.empty() ? 0.0f : 1.0f;
  append_cloth(mesh, &out[begin + 4 * 18]);
  append_translucency(mesh, &out[begin + 4 * 20]);
}

// Packs what the shader must know of a triangle's colours: its mesh (16 bits), the topmost layer that covers all of it
// or zero (4 bits), and which layers above that one have a border on it or close to it (8 bits). Most triangles have no
// such border.
std::uint32_t packed_look(const DrawMesh& mesh, std::size_t index, const std::uint32_t* corners) {
  std::uint32_t covering = 0, bordering = 0;
  for (std::size_t layer = 0; layer < std::min<std::size_t>(mesh.layers.size(), 8); ++layer) {
    const auto at = [&](int k) { return mesh.paint[corners[k]][layer]; };
    const auto [low, high] = std::minmax({at(0), at(1), at(2)});
    // The shader widens a border to a pixel, which may be larger than the triangle. Two hundredths of the body are more
    // than a pixel in any picture that is large enough to show borders.
    const double reach =
        std::max({0.5 * mesh.layers[layer].soft, 0.6 * double(high - low), 0.02 * mesh.rest.diagonal()});
    if (low > reach) continue;
    if (high < -reach) {
      covering = static_cast<std::uint32_t>(layer + 1);
      bordering = 0;
    } else {
      bordering |= 1u << layer;
    }
  }
  return static_cast<std::uint32_t>(index) | covering << 16 | bordering << 20;
}

// Writes how hollow a surface is at its vertices into the fourth numbers of their normals.
void add_hollows(const std::vector<float>& hollow, float* normals) {
  for (std::size_t v = 0; v < hollow.size(); ++v) normals[4 * v + 3] = hollow[v];
}

}  // namespace

SurfaceBuffers::SurfaceBuffers(const GlTable& gl, const std::vector<DrawMesh>& meshes, const TextureBuffer& textures)
    : gl_(gl) {
  make_static(meshes);
  make_colors(meshes, textures);
}

SurfaceBuffers::~SurfaceBuffers() {
  for (const Lookup* lookup : {&places_, &normals_, &triangles_, &paint_, &squares_, &materials_, &values_, &tints_,
                               &texture_places_, &flats_}) {
    gl_.DeleteTextures(1, &lookup->texture);
    gl_.DeleteBuffers(1, &lookup->buffer);
  }
  gl_.DeleteBuffers(1, &indices_);
  gl_.DeleteVertexArrays(1, &array_);
}

// Makes a buffer, which has room for one element at least, because an empty one cannot be read as a texture.
void SurfaceBuffers::make_lookup(Lookup& lookup, GLenum format, std::size_t bytes, const void* data, GLenum usage) {
  gl_.GenBuffers(1, &lookup.buffer);
  gl_.BindBuffer(GL_TEXTURE_BUFFER, lookup.buffer);
  gl_.BufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(std::max<std::size_t>(bytes, 16)),
                 bytes == 0 ? nullptr : data, usage);
  gl_.GenTextures(1, &lookup.texture);
  gl_.BindTexture(GL_TEXTURE_BUFFER, lookup.texture);
  gl_.TexBuffer(GL_TEXTURE_BUFFER, format, lookup.buffer);
}

void SurfaceBuffers::make_static(const std::vector<DrawMesh>& meshes) {
  std::vector<std::uint32_t> triangles, indices;
  std::vector<float> paint, squares, flats, materials;
  unsigned vertices = 0;
  const bool printed = std::ranges::any_of(meshes, [](const DrawMesh& mesh) { return !mesh.square.empty(); });
  const bool painted = std::ranges::any_of(meshes, [](const DrawMesh& mesh) { return !mesh.layers.empty(); });
  const bool woven = std::ranges::any_of(meshes, [](const DrawMesh& mesh) { return mesh.cloth.has_value(); });
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const DrawMesh& mesh = meshes[m];
    const auto first_caster = static_cast<unsigned>(indices.size() / 3);
    const std::vector<std::uint32_t>& casters = mesh.shadow_triangles.empty() ? mesh.triangles : mesh.shadow_triangles;
    for (const std::uint32_t vertex : casters) indices.push_back(vertices + vertex);
    ranges_.push_back({vertices, first_caster, static_cast<unsigned>(casters.size() / 3)});
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
      for (std::size_t k = 0; k < 3; ++k) triangles.push_back(vertices + mesh.triangles[t + k]);
      triangles.push_back(packed_look(mesh, m, &mesh.triangles[t]));
    }
    for (std::size_t v = 0; v < mesh.occlusion.size(); ++v) {
      place_data_.insert(place_data_.end(), {0, 0, 0, mesh.occlusion[v]});
      if (painted) paint.insert(paint.end(), mesh.paint[v].begin(), mesh.paint[v].end());
      if (woven) {
        const std::array<float, 3> flat = mesh.flat.empty() ? std::array<float, 3>{} : mesh.flat[v];
        flats.insert(flats.end(), {flat[0], flat[1], flat[2], 0});
      }
      if (!printed) continue;
      const std::array<float, 2> square = mesh.square.empty() ? std::array<float, 2>{} : mesh.square[v];
      squares.insert(squares.end(), square.begin(), square.end());
    }
    append_material(mesh, materials);
    vertices += static_cast<unsigned>(mesh.occlusion.size());
  }
  normal_data_.assign(4 * std::size_t(vertices), 0.0f);
  const std::size_t by_vertex = 4 * sizeof(float) * vertices;
  make_lookup(places_, GL_RGBA32F, by_vertex, nullptr, GL_STREAM_DRAW);
  make_lookup(normals_, GL_RGBA32F, by_vertex, nullptr, GL_STREAM_DRAW);
  make_lookup(triangles_, GL_RGBA32UI, triangles.size() * sizeof(std::uint32_t), triangles.data(), GL_STATIC_DRAW);
  make_lookup(paint_, GL_R32F, paint.size() * sizeof(float), paint.data(), GL_STATIC_DRAW);
  make_lookup(squares_, GL_RG32F, squares.size() * sizeof(float), squares.data(), GL_STATIC_DRAW);
  make_lookup(flats_, GL_RGBA32F, flats.size() * sizeof(float), flats.data(), GL_STATIC_DRAW);
  if (std::ranges::any_of(meshes, &DrawMesh::mapped)) value_data_.assign(vertices, no_field);
  make_lookup(values_, GL_R32F, value_data_.size() * sizeof(float), value_data_.data(), GL_STREAM_DRAW);
  make_lookup(materials_, GL_RGBA32F, materials.size() * sizeof(float), materials.data(), GL_STATIC_DRAW);

  gl_.GenVertexArrays(1, &array_);
  gl_.BindVertexArray(array_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, places_.buffer);
  gl_.EnableVertexAttribArray(0);
  gl_.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 4 * sizeof(float), nullptr);
  gl_.GenBuffers(1, &indices_);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(std::uint32_t)),
                 indices.data(), GL_STATIC_DRAW);
  gl_.BindVertexArray(0);
}

void SurfaceBuffers::make_colors(const std::vector<DrawMesh>& meshes, const TextureBuffer& textures) {
  std::vector<float> tints, places;
  if (std::ranges::any_of(meshes, [](const DrawMesh& mesh) { return !mesh.surface_colors.empty(); })) {
    for (const DrawMesh& mesh : meshes) {
      const int first = textures.first_of(mesh);
      for (std::size_t v = 0; v < mesh.occlusion.size(); ++v) {
        const SurfaceColor color = mesh.surface_colors.empty() ? SurfaceColor{} : mesh.surface_colors[v];
        const int number = color.texture < 0 ? 0 : first + color.texture + 1;
        tints.insert(tints.end(), {color.red, color.green, color.blue, static_cast<float>(number)});
        places.insert(places.end(), {color.u, color.v});
      }
    }
  }
  make_lookup(tints_, GL_RGBA32F, tints.size() * sizeof(float), tints.data(), GL_STATIC_DRAW);
  make_lookup(texture_places_, GL_RG32F, places.size() * sizeof(float), places.data(), GL_STATIC_DRAW);
}

void SurfaceBuffers::upload(const std::vector<DrawMesh>& meshes, const DrawList& list) {
  const std::vector<std::vector<float>>& positions = list.positions;
  SUPPLE_CHECK(positions.size(), ==, ranges_.size());
  for (std::size_t m = 0; m < ranges_.size(); ++m) {
    SUPPLE_CHECK(positions[m].size(), ==, 3 * meshes[m].occlusion.size());
    float* place = place_data_.data() + 4 * std::size_t(ranges_[m].first_vertex);
    for (std::size_t i = 0; i < positions[m].size(); i += 3, place += 4) std::copy_n(&positions[m][i], 3, place);
    float* normals = normal_data_.data() + 4 * std::size_t(ranges_[m].first_vertex);
    compute_normals(positions[m], meshes[m].triangles, meshes[m].smooth, normals);
    if (m < list.hollow.size()) add_hollows(list.hollow[m], normals);
  }
  put(places_, place_data_);
  put(normals_, normal_data_);
  if (!value_data_.empty()) upload_field(meshes, list.field);
}

void SurfaceBuffers::upload_field(const std::vector<DrawMesh>& meshes, const std::vector<std::vector<float>>& field) {
  std::ranges::fill(value_data_, no_field);
  for (std::size_t m = 0; m < std::min(field.size(), ranges_.size()); ++m) {
    if (field[m].empty()) continue;
    SUPPLE_CHECK(field[m].size(), ==, meshes[m].occlusion.size());
    std::ranges::copy(field[m], value_data_.begin() + ranges_[m].first_vertex);
  }
  put(values_, value_data_);
}

void SurfaceBuffers::put(const Lookup& lookup, const std::vector<float>& data) const {
  gl_.BindBuffer(GL_TEXTURE_BUFFER, lookup.buffer);
  gl_.BufferSubData(GL_TEXTURE_BUFFER, 0, static_cast<GLsizeiptr>(data.size() * sizeof(float)), data.data());
}

void SurfaceBuffers::draw_caster(std::size_t mesh) const {
  gl_.BindVertexArray(array_);
  const std::size_t begin = 3 * sizeof(std::uint32_t) * ranges_[mesh].first_caster;
  gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * ranges_[mesh].casters), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(begin));
}

int SurfaceBuffers::bind(const Program& program, int unit) const {
  for (const auto& [name, lookup] : {std::pair{"places", &places_},
                                     {"normals", &normals_},
                                     {"triangles", &triangles_},
                                     {"paint", &paint_},
                                     {"squares", &squares_},
                                     {"flats", &flats_},
                                     {"materials", &materials_},
                                     {"values", &values_},
                                     {"tints", &tints_},
                                     {"texture_places", &texture_places_}}) {
    program.set_texture(name, unit++, GL_TEXTURE_BUFFER, lookup->texture);
  }
  return unit;
}

}  // namespace supple
