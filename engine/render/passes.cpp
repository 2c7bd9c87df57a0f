#include "render/passes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "render/view.h"

namespace supple {
namespace {

// Holds what one pixel shows.
struct SurfacePoint {
  std::size_t mesh;
  std::array<std::uint32_t, 3> corners;
  Vec3 weights;  // of the corners
};

Vec3 place_at(const std::vector<float>& positions, std::uint32_t vertex) {
  const float* at = &positions[3 * std::size_t(vertex)];
  return {at[0], at[1], at[2]};
}

Vec3 place_of(const SurfacePoint& point, const std::vector<float>& positions) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 3; ++k) sum += point.weights[k] * place_at(positions, point.corners[std::size_t(k)]);
  return sum;
}

// Maps points of the world to pixels from the lower left, and to their distance along the viewing direction.
class Lens {
 public:
  Lens(const Camera& camera, int width, int height)
      : eye_(camera.eye),
        forward_((camera.target - camera.eye).normalized()),
        rays_(rays_through(camera, width, height)) {}

  const Vec3& eye() const { return eye_; }
  double depth(const Vec3& point) const { return (point - eye_).dot(forward_); }
  Vec3 ray(const Eigen::Vector2d& place) const { return rays_.corner + place.x() * rays_.right + place.y() * rays_.up; }
  // Returns nothing for points that are not in front of the eye.
  std::optional<Eigen::Vector2d> pixel(const Vec3& point) const {
    const double away = depth(point);
    if (!(away > 0)) return std::nullopt;
    const Vec3 ray = (point - eye_) / away - rays_.corner;
    return Eigen::Vector2d(ray.dot(rays_.right) / rays_.right.squaredNorm(),
                           ray.dot(rays_.up) / rays_.up.squaredNorm());
  }

 private:
  Vec3 eye_, forward_;
  Rays rays_;
};

// Returns the barycentric coordinates of the point where a ray meets a triangle's plane, as shaders/surface.frag has
// them: a triangle that is seen from the side goes on beyond its edges only a little.
Vec3 weights_on(const Vec3& eye, const Vec3& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 from_eye = a - eye, side_b = b - a, side_c = c - a;
  const Vec3 p = ray.cross(side_c), q = (-from_eye).cross(side_b);
  const double determinant = side_b.dot(p);
  const double at_b = -from_eye.dot(p) / determinant, at_c = ray.dot(q) / determinant;
  const Vec3 third = Vec3::Constant(1.0 / 3), off = Vec3(1 - at_b - at_c, at_b, at_c) - third;
  const double far = off.cwiseAbs().maxCoeff();
  return far < 1e6 ? Vec3(third + off / std::max(far, 1.0)) : third;
}

class PassMaker {
 public:
  PassMaker(const PassSource& source, std::span<const PicturePass> asked)
      : source_(source),
        now_(source.list.camera, source.width, source.height),
        next_((source.next != nullptr ? *source.next : source.list).camera, source.width, source.height),
        samples_(source.visibility.sample_places()) {
    std::uint32_t first = 1;
    for (const DrawMesh& mesh : source.meshes) {
      first_.push_back(first);
      first += static_cast<std::uint32_t>(mesh.triangles.size() / 3);
    }
    for (const PicturePass pass : asked) add(pass);
    find_movable();
  }

  std::vector<PassImage> make() {
    for (int y = 0; y < source_.height; ++y) {
      for (int x = 0; x < source_.width; ++x) take_pixel(x, y);
    }
    return std::move(images_);
  }

 private:
  void add(PicturePass pass) {
    const std::size_t pixels = std::size_t(source_.width) * source_.height;
    if (pass == PicturePass::masks) {
      add_masks(pixels);
      return;
    }
    const int channels = pass == PicturePass::depth ? 1 : 3;
    const float nothing = pass == PicturePass::depth ? no_depth : 0;
    images_.push_back({pass, "", channels, std::vector<float>(std::size_t(channels) * pixels, nothing)});
    if (pass == PicturePass::normals) compute_all_normals();
  }

  // Adds the masks. Meshes of one name share a mask.
  void add_masks(std::size_t pixels) {
    for (const DrawMesh& mesh : source_.meshes) {
      const auto same = std::ranges::find_if(images_, [&mesh](const PassImage& image) {
        return image.pass == PicturePass::masks && image.mesh == mesh.name;
      });
      const bool is_seen = !mesh.name.empty() && !mesh.triangles.empty();
      mask_of_.push_back(is_seen ? static_cast<int>(same - images_.begin()) : -1);
      if (is_seen && same == images_.end())
        images_.push_back({PicturePass::masks, mesh.name, 1, std::vector<float>(pixels, 0)});
    }
  }

  void compute_all_normals() {
    for (std::size_t m = 0; m < source_.meshes.size(); ++m) {
      const DrawMesh& mesh = source_.meshes[m];
      normals_.emplace_back(source_.list.positions[m].size() / 3 * 4);
      compute_normals(source_.list.positions[m], mesh.triangles, mesh.smooth, normals_.back().data());
    }
  }

  // Finds the meshes that have the same triangles in the next picture; a replay may change a collider's shape.
  void find_movable() {
    for (std::size_t m = 0; m < source_.meshes.size(); ++m)
      movable_.push_back(source_.next != nullptr && m < source_.next->positions.size() &&
                         source_.next->positions[m].size() == source_.list.positions[m].size());
    if (source_.next == nullptr) return;
    for (const auto& [m, mesh] : source_.next->renewed)
      if (mesh.triangles != source_.meshes[m].triangles) movable_[m] = false;
  }

  std::size_t mesh_of(std::uint32_t number) const {
    return std::size_t(std::ranges::upper_bound(first_, number) - first_.begin()) - 1;
  }

  // Returns the point of a surface as the visibility buffer holds it; nothing for none, and for a ghost.
  std::optional<SurfacePoint> point_of(std::uint32_t surface, int x, int y) const {
    const std::uint32_t number = surface & 0xffffffU;
    if (number == 0) return std::nullopt;
    SurfacePoint point;
    point.mesh = mesh_of(number);
    const DrawMesh& mesh = source_.meshes[point.mesh];
    if (mesh.ghost) return std::nullopt;
    const std::size_t first = 3 * std::size_t(number - first_[point.mesh]);
    for (std::size_t k = 0; k < 3; ++k) point.corners[k] = mesh.triangles[first + k];
    const std::vector<float>& places = source_.list.positions[point.mesh];
    point.weights = weights_on(now_.eye(), now_.ray(middle_of(surface >> 24, x, y)), place_at(places, point.corners[0]),
                               place_at(places, point.corners[1]), place_at(places, point.corners[2]));
    return point;
  }

  // Returns the mean place of some of a pixel's samples.
  Eigen::Vector2d middle_of(std::uint32_t samples, int x, int y) const {
    Eigen::Vector2d sum(0, 0);
    for (std::size_t s = 0; 2 * s < samples_.size(); ++s)
      if ((samples >> s & 1) != 0) sum += Eigen::Vector2d(samples_[2 * s], samples_[2 * s + 1]);
    return Eigen::Vector2d(x, y) + sum / std::max(1, std::popcount(samples));
  }

  void take_pixel(int x, int y) {
    const bool seen = source_.visibility.tiles().marked(x / Tiles::edge, y / Tiles::edge);
    const std::uint32_t* surfaces = &source_.visibility.surfaces()[2 * (std::size_t(y) * source_.width + x)];
    const std::size_t pixel = std::size_t(source_.height - 1 - y) * source_.width + x;
    if (seen) take_masks(surfaces, pixel);
    std::optional<SurfacePoint> point = seen ? point_of(surfaces[0], x, y) : std::nullopt;
    if (seen && !point) point = point_of(surfaces[1], x, y);
    if (point) {
      take_surface(*point, pixel);
    } else if (source_.ground) {
      take_ground(Eigen::Vector2d(x + 0.5, y + 0.5), pixel);
    }
  }

  void take_masks(const std::uint32_t* surfaces, std::size_t pixel) {
    for (int k = 0; k < 2 && !mask_of_.empty(); ++k) {
      if (surfaces[k] == 0) continue;
      const int mask = mask_of_[mesh_of(surfaces[k] & 0xffffffU)];
      if (mask < 0) continue;
      const auto shown = static_cast<float>(std::popcount(surfaces[k] >> 24));
      images_[std::size_t(mask)].values[pixel] += 2 * shown / static_cast<float>(samples_.size());
    }
  }

  void take_surface(const SurfacePoint& point, std::size_t pixel) {
    const std::vector<float>& places = source_.list.positions[point.mesh];
    const Vec3 place = place_of(point, places);
    const Vec3 later = movable_[point.mesh] ? place_of(point, source_.next->positions[point.mesh]) : place;
    write(pixel, place, normals_.empty() ? Vec3(Vec3::Zero()) : normal_of(point, place), motion(place, later));
  }

  void take_ground(const Eigen::Vector2d& at, std::size_t pixel) {
    const Vec3 ray = now_.ray(at);
    const double way = -now_.eye().y() / ray.y();
    if (!(way > 0) || !(way < no_depth)) return;  // the ray goes to the sky
    Vec3 place = now_.eye() + way * ray;
    place.y() = 0;
    write(pixel, place, Vec3::UnitY(), motion(place, place));
  }

  // Returns the normal that faces the eye on the side of the triangle that is seen.
  Vec3 normal_of(const SurfacePoint& point, const Vec3& place) const {
    const std::vector<float>& normals = normals_[point.mesh];
    Vec3 normal = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      const float* at = &normals[4 * std::size_t(point.corners[std::size_t(k)])];
      normal += point.weights[k] * Vec3(at[0], at[1], at[2]);
    }
    normal.normalize();
    const std::vector<float>& places = source_.list.positions[point.mesh];
    const Vec3 a = place_at(places, point.corners[0]), to_eye = now_.eye() - place;
    const Vec3 face = (place_at(places, point.corners[1]) - a).cross(place_at(places, point.corners[2]) - a);
    return face.dot(to_eye) < 0 && normal.dot(to_eye) < 0 ? Vec3(-normal) : normal;
  }

  Vec3 motion(const Vec3& from, const Vec3& to) const {
    if (source_.next == nullptr) return Vec3::Zero();
    const std::optional<Eigen::Vector2d> here = now_.pixel(from), there = next_.pixel(to);
    if (!here || !there) return Vec3::Zero();
    return {there->x() - here->x(), there->y() - here->y(), 0};
  }

  void write(std::size_t pixel, const Vec3& place, const Vec3& normal, const Vec3& motion) {
    for (PassImage& image : images_) {
      const auto set = [&](const Vec3& value) {
        for (std::size_t k = 0; k < 3; ++k)
          image.values[3 * pixel + k] = static_cast<float>(value[static_cast<Eigen::Index>(k)]);
      };
      switch (image.pass) {
        case PicturePass::depth: image.values[pixel] = static_cast<float>(now_.depth(place)); break;
        case PicturePass::normals: set(normal); break;
        case PicturePass::motion: set(motion); break;
        case PicturePass::positions: set(place); break;
        case PicturePass::masks: break;
      }
    }
  }

  const PassSource& source_;
  Lens now_, next_;
  std::vector<float> samples_;               // x y by sample
  std::vector<std::uint32_t> first_;         // by mesh: the number of its first triangle
  std::vector<bool> movable_;                // by mesh
  std::vector<int> mask_of_;                 // by mesh: the image of its mask; -1: none. Empty where none is asked for
  std::vector<std::vector<float>> normals_;  // by mesh: x y z 0 by vertex; empty where none is asked for
  std::vector<PassImage> images_;
};

}  // namespace

std::vector<PassImage> passes_of(const PassSource& source, std::span<const PicturePass> asked) {
  return PassMaker(source, asked).make();
}

}  // namespace supple
