#include "geometry/tetrahedra/cut_elements.h"

#include <algorithm>
#include <utility>

namespace supple {
namespace {

using FaceList = std::vector<Eigen::Index>;

int shared_corners(const Triangles& faces, Eigen::Index a, Eigen::Index b) {
  int shared = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) shared += faces(a, i) == faces(b, j) ? 1 : 0;
  }
  return shared;
}

// Groups the faces around a vertex into fans that are connected through edges.
std::vector<FaceList> fans_of(const Triangles& faces, FaceList open) {
  std::vector<FaceList> fans;
  while (!open.empty()) {
    FaceList fan = {open.back()};
    open.pop_back();
    for (std::size_t at = 0; at < fan.size(); ++at) {
      for (std::size_t i = 0; i < open.size();) {
        if (shared_corners(faces, fan[at], open[i]) >= 2) {
          fan.push_back(open[i]);
          open.erase(open.begin() + static_cast<std::ptrdiff_t>(i));
        } else {
          ++i;
        }
      }
    }
    fans.push_back(std::move(fan));
  }
  return fans;
}

// Tells whether an edge of the fan has four faces: such an edge joins two fans into one that visits a neighbour more
// than twice.
bool visits_an_edge_too_often(const Triangles& faces, const FaceList& fan, std::int32_t vertex) {
  std::vector<std::int32_t> neighbours;
  for (const Eigen::Index f : fan) {
    for (int k = 0; k < 3; ++k) {
      if (faces(f, k) != vertex) neighbours.push_back(faces(f, k));
    }
  }
  std::sort(neighbours.begin(), neighbours.end());
  for (std::size_t i = 2; i < neighbours.size(); ++i) {
    if (neighbours[i] == neighbours[i - 2]) return true;
  }
  return false;
}

// Returns the faces on the smaller side of each place where the boundary touches itself.
FaceList touching_faces(const TetMesh& mesh, const Triangles& faces) {
  std::vector<FaceList> faces_at(mesh.rest.rows());
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) faces_at[faces(f, k)].push_back(f);
  }
  FaceList touching;
  for (std::size_t v = 0; v < faces_at.size(); ++v) {
    const std::vector<FaceList> fans = fans_of(faces, faces_at[v]);
    bool pinched = fans.size() > 1;
    for (const FaceList& fan : fans) pinched |= visits_an_edge_too_often(faces, fan, static_cast<std::int32_t>(v));
    if (!pinched) continue;
    const auto smallest =
        std::min_element(fans.begin(), fans.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
    touching.insert(touching.end(), smallest->begin(), smallest->end());
  }
  return touching;
}

// Clears the flag of the element of each touching face. Returns false when there is no such face.
bool drop_elements_of(const TetMesh& mesh, const Triangles& faces, const FaceList& touching, std::vector<char>& keep) {
  if (touching.empty()) return false;
  std::vector<FaceList> tets_at(mesh.rest.rows());
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    for (int k = 0; k < 4; ++k) tets_at[mesh.tets(e, k)].push_back(e);
  }
  for (const Eigen::Index f : touching) {
    for (const Eigen::Index e : tets_at[faces(f, 0)]) {
      int shared = 0;
      for (int k = 0; k < 4; ++k) {
        for (int j = 0; j < 3; ++j) shared += mesh.tets(e, k) == faces(f, j) ? 1 : 0;
      }
      if (shared == 3) keep[e] = 0;
    }
  }
  return true;
}

TetMesh largest_piece(const TetMesh& mesh) {
  const std::vector<int> pieces = face_connected_pieces(mesh.tets);
  std::vector<double> volumes;
  for (std::size_t e = 0; e < pieces.size(); ++e) {
    const auto piece = static_cast<std::size_t>(pieces[e]);
    if (piece >= volumes.size()) volumes.resize(piece + 1, 0);
    volumes[piece] += tet_volume(mesh, static_cast<Eigen::Index>(e));
  }
  if (volumes.size() <= 1) return mesh;
  const auto largest = std::max_element(volumes.begin(), volumes.end()) - volumes.begin();
  std::vector<char> keep(pieces.size());
  for (std::size_t e = 0; e < pieces.size(); ++e) keep[e] = pieces[e] == largest;
  return submesh(mesh, keep);
}

}  // namespace

TetMesh oriented_mesh(const std::vector<Eigen::RowVector3d>& vertices, const std::vector<std::array<int, 4>>& tets) {
  TetMesh mesh;
  mesh.rest.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t v = 0; v < vertices.size(); ++v) mesh.rest.row(static_cast<Eigen::Index>(v)) = vertices[v];
  mesh.tets.resize(static_cast<Eigen::Index>(tets.size()), 4);
  for (std::size_t e = 0; e < tets.size(); ++e) {
    for (int k = 0; k < 4; ++k) mesh.tets(static_cast<Eigen::Index>(e), k) = tets[e][static_cast<std::size_t>(k)];
    if (tet_volume(mesh, static_cast<Eigen::Index>(e)) < 0)
      std::swap(mesh.tets(static_cast<Eigen::Index>(e), 2), mesh.tets(static_cast<Eigen::Index>(e), 3));
  }
  return mesh;
}

TetMesh one_manifold_piece(TetMesh mesh) {
  constexpr int most_rounds = 20;  // what is left may touch itself elsewhere; a few rounds suffice
  for (int round = 0; round < most_rounds && mesh.tets.rows() > 0; ++round) {
    mesh = largest_piece(mesh);
    const Triangles faces = boundary_faces(mesh.tets);
    std::vector<char> keep(mesh.tets.rows(), 1);
    if (!drop_elements_of(mesh, faces, touching_faces(mesh, faces), keep)) break;
    mesh = submesh(mesh, keep);
  }
  return mesh;
}

}  // namespace supple
