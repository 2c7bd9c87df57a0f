#include "geometry/reader/checked_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "base/error.h"
#include "base/read_file.h"
#include "geometry/files/number_words.h"
#include "geometry/files/text_rows.h"

namespace supple {

Vec3 far_origin(const Bounds& box) {
  // A body within this many of its sizes keeps all but four bits of a float's 24.
  constexpr double near = 16;
  if (box.empty() || !(box.diagonal() > 0)) return Vec3::Zero();
  const double reach = std::max(box.lower.cwiseAbs().maxCoeff(), box.upper.cwiseAbs().maxCoeff());
  return reach > near * box.diagonal() ? box.center() : Vec3(Vec3::Zero());
}

namespace {

// Refuses decimal commas in formats whose numbers stand between spaces: assimp would read only the part before a comma.
// Names in quotes may say anything. Texts of 16-bit characters, some of which assimp reads, have no such words, and
// pass.
CheckedSurface without_decimal_commas(std::string bytes, const std::string& name) {
  TextRows rows(bytes, name, {});
  while (rows.next()) {
    bool is_quoted = false;
    for (const RowWord& word : rows.words()) {
      const bool has_quotes = word.text.find('"') != std::string_view::npos;
      if (!is_quoted && !has_quotes && !why_no_number(word.text).empty())
        rows.refuse(word, fmt::format("'{}' is no number{}", word.text.substr(0, 40), why_no_number(word.text)));
      is_quoted ^= std::count(word.text.begin(), word.text.end(), '"') % 2 == 1;
    }
  }
  CheckedSurface result;
  result.bytes = std::move(bytes);
  return result;
}

}  // namespace

CheckedSurface checked_surface(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  check_regular_file(file);
  constexpr std::uintmax_t most_bytes = std::uintmax_t(1) << 30;
  const auto bytes = [&] { return read_text(file, most_bytes); };
  if (ending == ".obj") return checked_obj(bytes(), name);
  if (ending == ".off") return checked_off(bytes(), name);
  if (ending == ".ply") return checked_ply(bytes(), name);
  if (ending == ".stl") return checked_stl(bytes(), name);
  if (ending == ".gltf" || ending == ".glb") return checked_gltf(bytes(), file);
  if (ending == ".dae") return checked_collada(bytes(), name);
  for (const char* spaced : {".ac", ".ac3d", ".ase", ".nff", ".raw", ".smd"})
    if (ending == spaced) return without_decimal_commas(read_file(file, most_bytes), name);
  return {};
}

}  // namespace supple
