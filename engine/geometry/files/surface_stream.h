// Defines what supple-read-surface writes of a surface, or of a picture (then all but the one texture is missing):
// either `refused`, a Place and a reason of one line, or `accepted` and, all with the bytes that they have in memory,
//   Counts, the positions (3 doubles a vertex), the indices (3 int32 a triangle), the colours (a SurfaceColor a
//   vertex), the textures (TextureHead, name, 3 bytes a pixel), the texture coordinates (2 floats a vertex), the parts
//   (an int32 a vertex), and as text the remarks, what was found, and the names: a line for each part, in which names
//   are separated by tabs.
#pragma once

#include <cstdint>

namespace supple::surface_stream {

inline constexpr char accepted[8] = {'s', 'u', 'r', 'f', 'a', 'c', 'e', '3'};
inline constexpr char refused[8] = {'r', 'e', 'f', 'u', 's', 'e', 'd', ':'};
inline constexpr std::int64_t most_triangles = 5'000'000;
inline constexpr std::int64_t most_vertices = 3 * most_triangles;  // reached when no vertex is shared
inline constexpr std::int64_t most_textures = 64;
inline constexpr std::int64_t most_pixels = 1 << 26;  // of all textures together
inline constexpr std::int64_t most_text = 1 << 16;    // bytes of the remarks, and of what was found
inline constexpr std::int64_t most_names = 1 << 24;   // bytes of the names of parts

inline constexpr char picture_mode[] = "--picture";  // the argument before the name of a file that is a picture

struct Place {
  std::int32_t line = 0, column = 0;  // 0: unknown
};

struct Counts {
  std::int64_t vertices = 0, triangles = 0;
  std::int64_t colors = 0;  // as many as vertices; 0: the file has none
  std::int64_t textures = 0;
  std::int64_t places = 0;                         // as many as vertices; 0: the file has no texture coordinates
  std::int64_t part_of = 0;                        // as many as vertices; 0: no part has a name
  std::int64_t remarks = 0, found = 0, names = 0;  // bytes
};

struct TextureHead {
  std::int32_t width = 0, height = 0, wrap_u = 0, wrap_v = 0, name = 0;  // name: the bytes of the texture's name
};

}  // namespace supple::surface_stream
