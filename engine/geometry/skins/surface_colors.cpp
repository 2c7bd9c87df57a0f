#include "geometry/skins/surface_colors.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <unordered_map>

#include "base/hash.h"
#include "geometry/triangles/numbered_surface.h"
#include "geometry/triangles/refine_surface.h"
#include "geometry/triangles/triangle_soup.h"

namespace supple {
namespace {

using CornerColors = std::array<SurfaceColor, 3>;

bool same(const SurfaceColor& a, const SurfaceColor& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

struct KeyHash {
  template <class Key>
  std::size_t operator()(const Key& key) const {
    return std::size_t(hash_bytes(key.data(), sizeof key));
  }
};

// Finds triangles of a mesh by the places of their corners, whatever the order of these.
class TrianglesByPlace {
 public:
  explicit TrianglesByPlace(const TriMesh& mesh) : mesh_(mesh) {
    place_of_.reserve(std::size_t(mesh.points.rows()));
    for (Eigen::Index v = 0; v < mesh.points.rows(); ++v) {
      const auto next = static_cast<std::int32_t>(place_of_.size());
      place_of_.try_emplace(key_of(mesh.points.row(v)), next);
    }
    triangles_.reserve(std::size_t(mesh.triangles.rows()));
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) triangles_.try_emplace(*places_of(mesh, t), t);
  }

  // Returns the first triangle with the corners of a triangle of another mesh; -1 where there is none.
  Eigen::Index find(const TriMesh& other, Eigen::Index triangle) const {
    const auto places = places_of(other, triangle);
    const auto found = places ? triangles_.find(*places) : triangles_.end();
    return found == triangles_.end() ? -1 : found->second;
  }

 private:
  static std::array<std::uint64_t, 3> key_of(const Vec3& point) {
    std::array<std::uint64_t, 3> key;
    for (int k = 0; k < 3; ++k) key[std::size_t(k)] = std::bit_cast<std::uint64_t>(point[k] + 0.0);  // -0 becomes 0
    return key;
  }
  std::optional<std::array<std::int32_t, 3>> places_of(const TriMesh& mesh, Eigen::Index triangle) const {
    std::array<std::int32_t, 3> places;
    for (int k = 0; k < 3; ++k) {
      const auto place = place_of_.find(key_of(mesh.points.row(mesh.triangles(triangle, k))));
      if (place == place_of_.end()) return std::nullopt;
      places[std::size_t(k)] = place->second;
    }
    std::sort(places.begin(), places.end());
    return places;
  }

  const TriMesh& mesh_;
  std::unordered_map<std::array<std::uint64_t, 3>, std::int32_t, KeyHash> place_of_;
  std::unordered_map<std::array<std::int32_t, 3>, Eigen::Index, KeyHash> triangles_;
};

SurfaceColor mean(const SurfaceColor* colors, const Vec3& weights) {
  SurfaceColor result = colors[0];
  const auto mix = [&](float SurfaceColor::*part) {
    result.*part =
        static_cast<float>(weights[0] * colors[0].*part + weights[1] * colors[1].*part + weights[2] * colors[2].*part);
  };
  for (float SurfaceColor::*part :
       {&SurfaceColor::red, &SurfaceColor::green, &SurfaceColor::blue, &SurfaceColor::u, &SurfaceColor::v})
    mix(part);
  return result;
}

// Returns the colour at the point of a triangle that is closest to p.
SurfaceColor color_at(const TriMesh& mesh, Eigen::Index triangle, const CornerColors& colors, const Vec3& p) {
  const Vec3 a = corner(mesh, triangle, 0), b = corner(mesh, triangle, 1), c = corner(mesh, triangle, 2);
  return mean(colors.data(), weights_in_triangle(closest_in_triangle(p, a, b, c), a, b, c));
}

class FileTriangles {
 public:
  explicit FileTriangles(const ColoredSurface& file) : file_(file), by_place_(file.mesh) {}

  CornerColors colors_of(const TriMesh& surface, Eigen::Index triangle) {
    const Eigen::Index own = by_place_.find(surface, triangle);
    CornerColors result;
    if (own >= 0) {
      for (int k = 0; k < 3; ++k) {
        for (int j = 0; j < 3; ++j)
          if (corner(surface, triangle, k) == corner(file_.mesh, own, j)) result[std::size_t(k)] = color(own, j);
      }
      return result;
    }
    const Eigen::Index nearest = nearest_to(surface, triangle);
    if (nearest < 0) return result;
    const CornerColors colors = {color(nearest, 0), color(nearest, 1), color(nearest, 2)};
    for (int k = 0; k < 3; ++k)
      result[std::size_t(k)] = color_at(file_.mesh, nearest, colors, corner(surface, triangle, k));
    return result;
  }

  // Returns the places of a triangle's corners in a triangle of the file, which is the first one where none is near.
  std::array<RemeshedPlace, 3> places_of(const TriMesh& surface, Eigen::Index triangle) {
    Eigen::Index source = by_place_.find(surface, triangle);
    if (source < 0) source = std::max<Eigen::Index>(0, nearest_to(surface, triangle));
    const Vec3 a = corner(file_.mesh, source, 0), b = corner(file_.mesh, source, 1), c = corner(file_.mesh, source, 2);
    std::array<RemeshedPlace, 3> places;
    for (int k = 0; k < 3; ++k)
      places[std::size_t(k)] = {
          static_cast<std::int32_t>(source),
          weights_in_triangle(closest_in_triangle(corner(surface, triangle, k), a, b, c), a, b, c)};
    return places;
  }

  // Returns the part of a triangle; the first part where no triangle of the file is near.
  std::int32_t part_of(const TriMesh& surface, Eigen::Index triangle) {
    Eigen::Index source = by_place_.find(surface, triangle);
    if (source < 0) source = nearest_to(surface, triangle);
    return source < 0 ? 0 : file_.parts.of[std::size_t(file_.mesh.triangles(source, 0))];
  }

 private:
  // Returns the file's triangle that is nearest to the middle of another one; -1: there is none.
  Eigen::Index nearest_to(const TriMesh& surface, Eigen::Index triangle) {
    if (!soup_) soup_.emplace(finite_triangles());
    const Vec3 middle =
        (corner(surface, triangle, 0) + corner(surface, triangle, 1) + corner(surface, triangle, 2)) / 3;
    const double far = 10 * (bounds_of(soup_->mesh().points).diagonal() + bounds_of(surface.points).diagonal());
    const auto near = soup_->closest(middle, far, Vec3::Zero());
    return near.triangle < 0 ? -1 : kept_[std::size_t(near.triangle)];
  }

  const SurfaceColor& color(Eigen::Index triangle, int k) const {
    return file_.colors[std::size_t(file_.mesh.triangles(triangle, k))];
  }

  TriMesh finite_triangles() {
    for (Eigen::Index t = 0; t < file_.mesh.triangles.rows(); ++t) {
      if (corner(file_.mesh, t, 0).allFinite() && corner(file_.mesh, t, 1).allFinite() &&
          corner(file_.mesh, t, 2).allFinite())
        kept_.push_back(t);
    }
    return {file_.mesh.points, file_.mesh.triangles(kept_, Eigen::all)};
  }

  const ColoredSurface& file_;
  TrianglesByPlace by_place_;
  std::optional<TriangleSoup> soup_;  // of the triangles kept_, once it is needed
  std::vector<Eigen::Index> kept_;
};

// Returns which of the `size` pixels of a texture along an axis lies at i, which may be beyond the texture's edges.
int beyond_edges(std::int64_t i, int size, Wrap rule) {
  if (rule == Wrap::clamp) return int(std::clamp<std::int64_t>(i, 0, size - 1));
  const std::int64_t period = rule == Wrap::mirror ? 2 * std::int64_t(size) : size;
  const std::int64_t inside = (i % period + period) % period;
  return int(inside < size ? inside : period - 1 - inside);
}

// Returns the linear colour of the pixel of a texture that lies at a place of it.
Vec3 texel_at(const Texture& texture, const SurfaceColor& place) {
  const auto number = [](float at, int size) { return std::int64_t(std::floor(double(at) * size)); };
  const int x = beyond_edges(number(place.u, texture.width), texture.width, texture.wrap_u),
            y = beyond_edges(number(place.v, texture.height), texture.height, texture.wrap_v);
  const std::uint8_t* rgb =
      &texture.rgb[3 * (std::size_t(texture.height - 1 - y) * std::size_t(texture.width) + std::size_t(x))];
  const auto linear = [](std::uint8_t byte) {
    const double c = byte / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  return {linear(rgb[0]), linear(rgb[1]), linear(rgb[2])};
}

std::uint64_t hash_of(const SurfaceColors& colors) {
  std::uint64_t hash = hash_bytes(colors.corners.data(), sizeof(CornerColors) * colors.corners.size());
  if (!colors.textures) return hash;
  for (const Texture& texture : *colors.textures) {
    const std::int32_t head[] = {texture.width, texture.height, std::int32_t(texture.wrap_u),
                                 std::int32_t(texture.wrap_v)};
    hash = hash_bytes(texture.rgb.data(), texture.rgb.size(), hash_bytes(head, sizeof head, hash));
  }
  return hash;
}

// Holds a surface whose vertices are split where colours meet. Vertices that were one have one number in `place_of`.
struct SplitSurface {
  TriMesh mesh;
  std::vector<SurfaceColor> colors;    // by vertex
  std::vector<std::int32_t> place_of;  // by vertex
};

SplitSurface split(const TriMesh& surface, const SurfaceColors& colors) {
  SplitSurface result;
  result.mesh.triangles.resize(surface.triangles.rows(), 3);
  std::vector<std::vector<std::int32_t>> at(std::size_t(surface.points.rows()));  // the vertices at each place
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t place = surface.triangles(t, k);
      const SurfaceColor& color = colors.corners[std::size_t(t)][std::size_t(k)];
      std::vector<std::int32_t>& here = at[std::size_t(place)];
      const auto known =
          std::ranges::find_if(here, [&](std::int32_t v) { return same(result.colors[std::size_t(v)], color); });
      result.mesh.triangles(t, k) = known == here.end() ? static_cast<std::int32_t>(result.colors.size()) : *known;
      if (known != here.end()) continue;
      here.push_back(static_cast<std::int32_t>(result.colors.size()));
      result.colors.push_back(color);
      result.place_of.push_back(place);
    }
  }
  result.mesh.points = surface.points(result.place_of, Eigen::all);
  return result;
}

// Refines a split surface. An edge with different colours on its two sides is halved on both, because its length alone
// decides, and its two middles are one place.
SplitSurface refined_split(const SplitSurface& coarse, Eigen::Index places, double longest, Eigen::Index most) {
  RefinedSurface fine = refined(coarse.mesh, longest, most);
  SplitSurface result{std::move(fine.mesh), coarse.colors, coarse.place_of};
  std::unordered_map<std::array<std::int32_t, 2>, std::int32_t, KeyHash> middles;  // by the places of an edge's ends
  auto next = static_cast<std::int32_t>(places);
  for (const auto& [a, b] : fine.ends) {
    const SurfaceColor ends[] = {result.colors[std::size_t(a)], result.colors[std::size_t(b)], {}};
    result.colors.push_back(mean(ends, Vec3(0.5, 0.5, 0)));
    const auto [low, high] = std::minmax(result.place_of[std::size_t(a)], result.place_of[std::size_t(b)]);
    const auto [at, added] = middles.try_emplace({low, high}, next);
    next += added ? 1 : 0;
    result.place_of.push_back(at->second);
  }
  return result;
}

// Splits the vertices of a skin as those of a split surface with the same triangles are split, and gives them the
// colours of that surface. before: by vertex of the result, the vertex of the plain skin.
Skin split_as(const Skin& plain, const SplitSurface& colored_surface, std::vector<std::int32_t>& before) {
  Skin skin;
  before.clear();
  skin.rest.triangles.resize(plain.rest.triangles.rows(), 3);
  std::unordered_map<std::array<std::int32_t, 2>, std::int32_t, KeyHash> names;  // by vertex of both surfaces
  for (Eigen::Index t = 0; t < plain.rest.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t vertex = plain.rest.triangles(t, k), colored = colored_surface.mesh.triangles(t, k);
      const auto [at, added] = names.try_emplace({vertex, colored}, static_cast<std::int32_t>(before.size()));
      skin.rest.triangles(t, k) = at->second;
      if (!added) continue;
      before.push_back(vertex);
      skin.smooth.push_back(plain.smooth.empty() ? vertex : plain.smooth[std::size_t(vertex)]);
      skin.color.push_back(colored_surface.colors[std::size_t(colored)]);
      if (!plain.square.empty()) skin.square.push_back(plain.square[std::size_t(vertex)]);
    }
  }
  skin.rest.points = plain.rest.points(before, Eigen::all);
  skin.occlusion.assign(before.size(), 1.0f);
  skin.paint.assign(before.size(), plain.paint.empty() ? std::array<float, max_paint_layers>{} : plain.paint[0]);
  return skin;
}

TriMesh joined(const SplitSurface& surface) {
  const auto places = 1 + *std::ranges::max_element(surface.place_of);
  TriMesh mesh{Positions::Zero(places, 3), surface.mesh.triangles};
  for (std::size_t v = 0; v < surface.place_of.size(); ++v)
    mesh.points.row(surface.place_of[v]) = surface.mesh.points.row(static_cast<Eigen::Index>(v));
  for (std::int32_t& v : mesh.triangles.reshaped()) v = surface.place_of[std::size_t(v)];
  return mesh;
}

}  // namespace

std::shared_ptr<const SurfaceColors> colors_on(const TriMesh& surface, const ColoredSurface& file) {
  if (file.colors.empty()) return nullptr;
  auto result = std::make_shared<SurfaceColors>();
  result->textures = file.textures;
  FileTriangles triangles(file);
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t)
    result->corners.push_back(triangles.colors_of(surface, t));
  result->hash = hash_of(*result);
  return result;
}

std::shared_ptr<const SurfaceColors> colors_on(const FileCorners& corners, const ColoredSurface& file) {
  if (file.colors.empty()) return nullptr;
  auto result = std::make_shared<SurfaceColors>();
  result->textures = file.textures;
  for (const auto& triangle : corners) {
    CornerColors& colors = result->corners.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      SurfaceColor of[3];
      for (int j = 0; j < 3; ++j) of[j] = file.colors[std::size_t(file.mesh.triangles(triangle[k].triangle, j))];
      colors[k] = mean(of, triangle[k].weights);
    }
  }
  result->hash = hash_of(*result);
  return result;
}

std::shared_ptr<const SurfaceParts> parts_on(const TriMesh& surface, const ColoredSurface& file) {
  if (file.parts.of.empty()) return nullptr;
  auto parts = std::make_shared<SurfaceParts>();
  parts->names = file.parts.names;
  FileTriangles triangles(file);
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) parts->of.push_back(triangles.part_of(surface, t));
  return parts;
}

std::shared_ptr<const TextureCorners> places_on(const TriMesh& surface, const ColoredSurface& file) {
  if (file.places.empty()) return nullptr;
  FileCorners corners;
  FileTriangles triangles(file);
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) corners.push_back(triangles.places_of(surface, t));
  return places_on(corners, file);
}

double brightness_at(const Texture& picture, const Eigen::Vector2d& place) {
  const auto number = [](double at, int size) {
    const double inside = at >= 0 && at <= 1 ? at : at - std::floor(at);
    return std::min(size - 1, int(inside * size));
  };
  const int x = number(place.x(), picture.width), y = picture.height - 1 - number(place.y(), picture.height);
  const std::uint8_t* rgb = &picture.rgb[3 * (std::size_t(y) * std::size_t(picture.width) + std::size_t(x))];
  return (0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]) / 255;
}

Vec3 srgb_at(const SurfaceColors& colors, Eigen::Index triangle, const Vec3& weights) {
  const SurfaceColor color = mean(colors.corners[std::size_t(triangle)].data(), weights);
  Vec3 linear(color.red, color.green, color.blue);
  if (color.texture >= 0) linear = linear.cwiseProduct(texel_at((*colors.textures)[std::size_t(color.texture)], color));
  return linear.cwiseMax(0).cwiseMin(1).unaryExpr([](double c) {
    return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;  // IEC 61966-2-1
  });
}

std::vector<std::int32_t> put_on_colors(Skin& skin, const TriMesh& surface, const SurfaceColors& colors) {
  std::vector<std::int32_t> before;
  skin = split_as(skin, split(surface, colors), before);
  return before;
}

Skin colored_skin(const TriMesh& surface, const SurfaceColors& colors, double longest, Eigen::Index most,
                  double square) {
  const SplitSurface fine = refined_split(split(surface, colors), surface.points.rows(), longest, most);
  const TriMesh whole = joined(fine);
  std::vector<std::int32_t> vertex_of, before;
  return split_as(skin_of_surface(whole.points, whole.triangles, square, vertex_of), fine, before);
}

}  // namespace supple
