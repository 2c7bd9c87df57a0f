#include "render/texture_buffer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/color.h"

namespace supple {
namespace {

constexpr std::int64_t most_texels = 48'000'000;  // of all levels: 384 MB, and within what software rasterisers take

// Holds the texels along an axis that a texel of the coarser level covers, with their shares of it.
struct Cover {
  int first = 0, count = 0;
  std::array<float, 3> share = {};
};

Cover cover_of(int coarse, int coarse_size, int fine_size) {
  const double ratio = double(fine_size) / coarse_size, from = coarse * ratio, to = (coarse + 1) * ratio;
  Cover cover{int(from), 0, {}};
  for (int i = cover.first; i < fine_size && double(i) < to - 1e-9 && cover.count < 3; ++i)
    cover.share[std::size_t(cover.count++)] =
        static_cast<float>((std::min<double>(i + 1, to) - std::max<double>(i, from)) / ratio);
  return cover;
}

std::int64_t texels_below(const Texture& texture, int dropped) {
  std::int64_t sum = 0;
  for (int width = texture.width, height = texture.height, level = 0;; ++level) {
    if (level >= dropped) sum += std::int64_t(width) * height;
    if (width == 1 && height == 1) return sum;
    width = std::max(1, width / 2);
    height = std::max(1, height / 2);
  }
}

// Returns how many of each texture's finest levels are left out so that all have room.
std::vector<int> dropped_levels(const std::vector<const Texture*>& textures, std::int64_t room) {
  std::vector<int> dropped(textures.size(), 0);
  for (;;) {
    std::int64_t sum = 0, largest = 0;
    std::size_t which = 0;
    for (std::size_t t = 0; t < textures.size(); ++t) {
      const std::int64_t own = texels_below(*textures[t], dropped[t]);
      sum += own;
      if (own <= largest) continue;
      largest = own;
      which = t;
    }
    if (sum <= room || largest <= 1) return dropped;
    ++dropped[which];
  }
}

}  // namespace

LinearTexture linear_texture(const Texture& texture) {
  std::array<std::uint16_t, 256> linear;
  for (int i = 0; i < 256; ++i) linear[std::size_t(i)] = std::uint16_t(std::lround(65535 * linear_of(i / 255.0)));
  LinearTexture result{texture.width, texture.height, {}};
  result.texels.reserve(4 * std::size_t(texture.width) * std::size_t(texture.height));
  for (int y = texture.height; y-- > 0;) {
    const std::uint8_t* row = &texture.rgb[3 * std::size_t(y) * std::size_t(texture.width)];
    for (int x = 0; x < texture.width; ++x, row += 3)
      result.texels.insert(result.texels.end(), {linear[row[0]], linear[row[1]], linear[row[2]], 65535});
  }
  return result;
}

LinearTexture half_as_fine(const LinearTexture& fine) {
  LinearTexture coarse{std::max(1, fine.width / 2), std::max(1, fine.height / 2), {}};
  coarse.texels.reserve(4 * std::size_t(coarse.width) * std::size_t(coarse.height));
  std::vector<Cover> columns;
  for (int x = 0; x < coarse.width; ++x) columns.push_back(cover_of(x, coarse.width, fine.width));
  for (int y = 0; y < coarse.height; ++y) {
    const Cover rows = cover_of(y, coarse.height, fine.height);
    for (const Cover& cover : columns) {
      float sum[3] = {0, 0, 0};
      for (int j = 0; j < rows.count; ++j) {
        for (int i = 0; i < cover.count; ++i) {
          const float share = rows.share[std::size_t(j)] * cover.share[std::size_t(i)];
          const std::size_t at =
              4 * (std::size_t(rows.first + j) * std::size_t(fine.width) + std::size_t(cover.first + i));
          for (std::size_t k = 0; k < 3; ++k) sum[k] += share * fine.texels[at + k];
        }
      }
      for (const float value : sum) coarse.texels.push_back(std::uint16_t(std::clamp(value + 0.5f, 0.0f, 65535.0f)));
      coarse.texels.push_back(65535);
    }
  }
  return coarse;
}

TextureBuffer::TextureBuffer(const GlTable& gl, const std::vector<DrawMesh>& meshes) : gl_(gl) {
  std::vector<const Texture*> textures;
  for (const DrawMesh& mesh : meshes) {
    if (!mesh.textures || !first_.try_emplace(mesh.textures.get(), int(textures.size())).second) continue;
    kept_.push_back(mesh.textures);
    for (const Texture& texture : *mesh.textures) textures.push_back(&texture);
  }
  GLint limit = 65536;
  gl_.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &limit);
  const std::vector<int> dropped = dropped_levels(textures, std::min<std::int64_t>(limit, most_texels));
  // By texture: its first level, the number of its levels, and how it goes on beyond its edges; then by level: its
  // first texel and its sides.
  std::vector<std::uint32_t> heads, levels;
  std::vector<std::uint16_t> texels;
  for (std::size_t t = 0; t < textures.size(); ++t) {
    const auto first = std::uint32_t(textures.size() + levels.size() / 4);
    LinearTexture level = linear_texture(*textures[t]);
    for (int l = 0;; ++l) {
      if (l >= dropped[t]) {
        levels.insert(levels.end(),
                      {std::uint32_t(texels.size() / 4), std::uint32_t(level.width), std::uint32_t(level.height), 0});
        texels.insert(texels.end(), level.texels.begin(), level.texels.end());
      }
      if (level.width == 1 && level.height == 1) break;
      level = half_as_fine(level);
    }
    const auto count = std::uint32_t(textures.size() + levels.size() / 4) - first;
    heads.insert(heads.end(), {first, count, std::uint32_t(textures[t]->wrap_u), std::uint32_t(textures[t]->wrap_v)});
  }
  heads.insert(heads.end(), levels.begin(), levels.end());
  make(texel_buffer_, texels_, GL_RGBA16, texels.size() * sizeof(std::uint16_t), texels.data());
  make(level_buffer_, levels_, GL_RGBA32UI, heads.size() * sizeof(std::uint32_t), heads.data());
}

TextureBuffer::~TextureBuffer() {
  for (const GLuint* texture : {&texels_, &levels_}) gl_.DeleteTextures(1, texture);
  for (const GLuint* buffer : {&texel_buffer_, &level_buffer_}) gl_.DeleteBuffers(1, buffer);
}

// Makes a buffer, which has room for one element at least, because an empty one cannot be read as a texture.
void TextureBuffer::make(GLuint& buffer, GLuint& texture, GLenum format, std::size_t bytes, const void* data) {
  gl_.GenBuffers(1, &buffer);
  gl_.BindBuffer(GL_TEXTURE_BUFFER, buffer);
  gl_.BufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(std::max<std::size_t>(bytes, 16)),
                 bytes == 0 ? nullptr : data, GL_STATIC_DRAW);
  gl_.GenTextures(1, &texture);
  gl_.BindTexture(GL_TEXTURE_BUFFER, texture);
  gl_.TexBuffer(GL_TEXTURE_BUFFER, format, buffer);
}

int TextureBuffer::first_of(const DrawMesh& mesh) const {
  const auto found = first_.find(mesh.textures.get());
  return found == first_.end() ? 0 : found->second;
}

int TextureBuffer::bind(const Program& program, int unit) const {
  program.set_texture("texels", unit++, GL_TEXTURE_BUFFER, texels_);
  program.set_texture("levels", unit++, GL_TEXTURE_BUFFER, levels_);
  return unit;
}

}  // namespace supple
