#include "geometry/solids/surface_pieces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/disjoint_sets.h"
#include "geometry/triangles/numbered_surface.h"
#include "geometry/triangles/triangle_soup.h"

namespace supple {
namespace {

enum class Link { none, touch, overlap };

struct Part {
  std::vector<Eigen::Index> triangles;  // of the whole boundary
  TriMesh mesh;
  Bounds box;
  double volume = 0;               // negative for a cavity [m^3]
  std::vector<TriangleSoup> soup;  // one, once it has been needed
};

// Returns the listed triangles as a mesh whose points are their corners alone, numbered anew. name: scratch for these
// numbers, by vertex of `mesh`; -1 for each before the call, and again after it.
TriMesh own_mesh(const TriMesh& mesh, const std::vector<Eigen::Index>& triangles, std::vector<std::int32_t>& name) {
  std::vector<std::int32_t> used;
  TriMesh part{Positions(), mesh.triangles(triangles, Eigen::all)};
  for (std::int32_t& v : part.triangles.reshaped<Eigen::RowMajor>()) {
    if (name[at(v)] < 0) {
      name[at(v)] = std::int32_t(used.size());
      used.push_back(v);
    }
    v = name[at(v)];
  }
  part.points = mesh.points(used, Eigen::all);
  for (const std::int32_t v : used) name[at(v)] = -1;
  return part;
}

// Returns the parts of a mesh. Triangles that share a vertex are in one part, also where they share no edge: what a
// clean-up joined in one point stays together.
std::vector<Part> parts_of(const TriMesh& mesh) {
  DisjointSets joined(at(mesh.points.rows()));
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
    for (int k = 1; k < 3; ++k) joined.join(at(mesh.triangles(t, k)), at(mesh.triangles(t, 0)));
  std::vector<int> label(at(mesh.points.rows()), -1);
  std::vector<Part> parts;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    int& own = label[joined.of(at(mesh.triangles(t, 0)))];
    if (own < 0) {
      own = int(parts.size());
      parts.emplace_back();
    }
    parts[std::size_t(own)].triangles.push_back(t);
  }
  std::vector<std::int32_t> name(at(mesh.points.rows()), -1);
  for (Part& part : parts) {
    part.mesh = own_mesh(mesh, part.triangles, name);
    part.box = bounds_of(part.mesh.points);
    part.volume = enclosed_volume(part.mesh);
  }
  return parts;
}

const TriangleSoup& soup_of(Part& part) {
  if (part.soup.empty()) part.soup.emplace_back(part.mesh);
  return part.soup.front();
}

bool boxes_meet(const Bounds& a, const Bounds& b, double gap) {
  return ((a.lower.array() - gap) <= b.upper.array()).all() && ((b.lower.array() - gap) <= a.upper.array()).all();
}

bool crosses(const TriangleSoup& other, const Vec3& a, const Vec3& b) {
  const double length = (b - a).norm();
  if (!(length > 0)) return false;
  const auto hit = other.first_hit(a, (b - a) / length, -1);
  return hit && *hit <= length;
}

// Returns how two parts are linked, as the vertices and edges of the first one show.
Link link_from(Part& from, Part& to, double gap) {
  const TriangleSoup& other = soup_of(to);
  Link link = Link::none;
  for (Eigen::Index t = 0; t < from.mesh.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = corner(from.mesh, t, k), b = corner(from.mesh, t, (k + 1) % 3);
      Bounds edge;
      edge.include(a);
      edge.include(b);
      if (!boxes_meet(edge, to.box, gap)) continue;
      if (std::abs(other.winding_number(a)) > 0.5 || crosses(other, a, b)) return Link::overlap;
      if (link == Link::none && other.closest(a, gap, Vec3::Zero()).triangle >= 0) link = Link::touch;
    }
  }
  return link;
}

Link link_between(Part& a, Part& b, double gap) {
  if (!boxes_meet(a.box, b.box, gap)) return Link::none;
  const Link one = link_from(a, b, gap);
  return one == Link::overlap ? one : std::max(one, link_from(b, a, gap));
}

// Gives what is drawn to the pieces, triangle by triangle.
void share_out(const TriMesh& drawn, std::vector<SolidSurface>& pieces) {
  std::vector<TriangleSoup> soups;
  for (const SolidSurface& piece : pieces) soups.emplace_back(piece.boundary);
  std::vector<std::vector<Eigen::Index>> owned(pieces.size());
  const double far = 10 * bounds_of(drawn.points).diagonal();
  for (Eigen::Index t = 0; t < drawn.triangles.rows(); ++t) {
    const Vec3 middle = (corner(drawn, t, 0) + corner(drawn, t, 1) + corner(drawn, t, 2)) / 3;
    std::size_t owner = 0;
    double nearest = far;
    for (std::size_t p = 0; p < soups.size(); ++p) {
      const auto near = soups[p].closest(middle, nearest, Vec3::Zero());
      if (near.triangle < 0) continue;
      owner = p;
      nearest = std::sqrt(near.squared);
    }
    owned[owner].push_back(t);
  }
  std::vector<std::int32_t> name(at(drawn.points.rows()), -1);
  for (std::size_t p = 0; p < pieces.size(); ++p) pieces[p].drawn = own_mesh(drawn, owned[p], name);
}

// Returns the volume of a piece's solid. Where no two of its parts may hold the same place, the sum of the parts is
// exact.
double solid_volume(const TriMesh& mesh, const std::vector<const Part*>& parts) {
  const double sum = enclosed_volume(mesh);
  bool may_overlap = false;
  for (std::size_t a = 0; a < parts.size(); ++a)
    for (std::size_t b = a + 1; b < parts.size() && !may_overlap; ++b)
      may_overlap = parts[a]->volume > 0 && parts[b]->volume > 0 && boxes_meet(parts[a]->box, parts[b]->box, 0);
  if (!may_overlap) return sum;
  constexpr double error = 0.005;  // more than that of united_volume(), as a share
  const double united = united_volume(mesh);
  return std::abs(united - sum) < error * sum ? sum : united;
}

}  // namespace

double enclosed_volume(const TriMesh& boundary) {
  const Vec3 center = bounds_of(boundary.points).center();
  double volume = 0;
  for (Eigen::Index t = 0; t < boundary.triangles.rows(); ++t)
    volume += area_vector(boundary, t).dot(corner(boundary, t, 0) - center) / 3;
  return volume;
}

std::vector<TriMesh> closed_parts(const TriMesh& boundary) {
  std::vector<TriMesh> result;
  for (Part& part : parts_of(boundary)) result.push_back(std::move(part.mesh));
  return result;
}

SurfacePieces pieces_of(SolidSurface surface, Joining joining, double gap) {
  std::vector<Part> parts = parts_of(surface.boundary);
  SurfacePieces result;
  DisjointSets pieces(parts.size());
  for (std::size_t a = 0; a < parts.size(); ++a) {
    for (std::size_t b = a + 1; b < parts.size(); ++b) {
      if (pieces.of(a) == pieces.of(b)) continue;
      if (joining == Joining::cavities && parts[a].volume > 0 && parts[b].volume > 0) continue;
      const Link link = link_between(parts[a], parts[b], gap);
      if (link == Link::none) continue;
      result.touching |= link == Link::touch;
      pieces.join(a, b);
    }
  }
  std::vector<std::vector<Eigen::Index>> triangles(parts.size());
  std::vector<std::vector<const Part*>> parts_of_piece(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    auto& own = triangles[pieces.of(i)];
    own.insert(own.end(), parts[i].triangles.begin(), parts[i].triangles.end());
    parts_of_piece[pieces.of(i)].push_back(&parts[i]);
  }
  std::erase_if(triangles, [](const auto& list) { return list.empty(); });
  std::erase_if(parts_of_piece, [](const auto& list) { return list.empty(); });
  if (triangles.size() == 1) {  // the whole surface, with the bits that it had
    result.volumes = {solid_volume(surface.boundary, parts_of_piece.front())};
    result.pieces.push_back(std::move(surface));
    return result;
  }
  std::vector<std::pair<double, TriMesh>> meshes;
  std::vector<std::int32_t> name(at(surface.boundary.points.rows()), -1);
  for (std::size_t p = 0; p < triangles.size(); ++p) {
    std::sort(triangles[p].begin(), triangles[p].end());
    TriMesh mesh = own_mesh(surface.boundary, triangles[p], name);
    const double volume = solid_volume(mesh, parts_of_piece[p]);
    meshes.emplace_back(volume, std::move(mesh));
  }
  std::stable_sort(meshes.begin(), meshes.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (auto& [volume, mesh] : meshes) {
    result.volumes.push_back(volume);
    result.pieces.push_back({std::move(mesh), {}});
  }
  if (surface.drawn.triangles.rows() > 0) share_out(surface.drawn, result.pieces);
  return result;
}

}  // namespace supple
