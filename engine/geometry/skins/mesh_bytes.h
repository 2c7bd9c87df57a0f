// Turns meshes, skins and embeddings into bytes and back, so that they can be kept from run to run (base/user_cache.h).
// The bytes are for programs of the same build on the same machine; formats for other programs are in
// files/mesh_file.h.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "geometry/skins/embedding.h"
#include "geometry/skins/skin.h"

namespace supple {

std::string bytes_of(const TetMesh& mesh);
std::optional<TetMesh> tet_mesh_from(std::string_view bytes);  // nothing where these are not the bytes of a mesh

// Holds a skin, and how elements carry it.
struct CarriedSkin {
  Skin skin;
  Embedding embedding;
};
std::string bytes_of(const CarriedSkin& carried);
std::optional<CarriedSkin> carried_skin_from(std::string_view bytes);

}  // namespace supple
