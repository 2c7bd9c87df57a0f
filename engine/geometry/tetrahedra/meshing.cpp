#include "geometry/tetrahedra/meshing.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "base/error.h"
#include "geometry/skins/mesh_bytes.h"
#include "geometry/solids/surface_pieces.h"
#include "geometry/solids/triangle_solid.h"
#include "geometry/tetrahedra/tetrahedralize.h"
#include "geometry/triangles/surface_thickness.h"

namespace supple {
namespace {

// A mesh has lost a part of the body when a larger share of the surface than this has no element inside.
constexpr double most_unheld = 0.01;

MeshingListener listener_of(const WantedMesh& wanted, const SlowWork& work) {
  return {[&](int attempt, double share) {
            if (work.tell)
              work.tell(fmt::format("meshing {} with {} vertices: attempt {}, {:.0f} %", wanted.source, wanted.vertices,
                                    attempt, 100 * share));
          },
          {}};
}

std::string kept_name(const WantedMesh& wanted) {
  return fmt::format("mesh of {} vertices from {}", wanted.vertices, wanted.content);
}

// Joins parts that touch without an overlap by what lies between them: their fields melt into each other there.
std::optional<Shape> bridged(const TriMesh& boundary, double gap) {
  constexpr std::size_t most_parts = 64;  // every part is asked for every distance
  Shape shape;
  for (TriMesh& mesh : closed_parts(boundary)) {
    if (!(enclosed_volume(mesh) > 0)) return std::nullopt;
    ShapePart part;
    part.primitive = ClosedSurface{std::make_shared<TriangleSolid>(std::move(mesh))};
    part.blend = shape.root.parts.empty() ? 0 : gap;
    shape.root.parts.push_back(std::move(part));
  }
  if (shape.root.parts.size() < 2 || shape.root.parts.size() > most_parts) return std::nullopt;
  return shape;
}

std::string count_text(double vertices) {
  return vertices > 500000 ? "more than 500000" : fmt::format("about {:.0f}", std::ceil(vertices / 100) * 100);
}

// Tells which samples have their middle inside an element.
std::vector<char> held_samples(const std::vector<ThicknessSample>& samples, const TetMesh& mesh) {
  Positions middles(static_cast<Eigen::Index>(samples.size()), 3);
  for (std::size_t s = 0; s < samples.size(); ++s)
    middles.row(static_cast<Eigen::Index>(s)) = samples[s].middle().transpose();
  return inside_elements(mesh, middles);
}

double unheld_share(const std::vector<char>& held) {
  if (held.empty()) return 0;
  return double(std::count(held.begin(), held.end(), 0)) / double(held.size());
}

// Tells what of a surface is thinner than an element of a uniform mesh.
struct Thinness {
  double spacing = 0;                    // of the uniform lattice with the wanted number of vertices
  double wanted = 0;                     // number of vertices that resolve nearly all of it
  double thin_share = 0;                 // of the surface
  std::vector<ThicknessSample> samples;  // the thinnest first
};

Thinness thinness_of(const TriMesh& boundary, int vertices) {
  const double volume = enclosed_volume(boundary), area = area_of(boundary);
  if (!(volume > 0)) return {};
  Thinness result;
  result.spacing = spacing_for(volume, area, vertices);
  constexpr double per_square = 4;  // samples on the square of a spacing
  const double wanted = per_square * area / std::pow(result.spacing, 2);
  if (!std::isfinite(wanted)) return {};
  result.samples = sampled_thickness(boundary, int(std::clamp(wanted, 2000.0, 200000.0)));
  result.wanted = vertices_wanted(result.samples, volume, area);
  const auto thin = std::count_if(result.samples.begin(), result.samples.end(), [&](const ThicknessSample& sample) {
    return is_thin(sample.thickness, result.spacing);
  });
  result.thin_share = double(thin) / std::max<double>(1, double(result.samples.size()));
  return result;
}

// Says which share of the surface is thinner than an element, and which share has no element inside. Returns an empty
// text where neither is worth a word.
std::string thinness_note(const Thinness& thinness, const TetMesh& mesh, int vertices) {
  const std::vector<char> held = held_samples(thinness.samples, mesh);
  const double unheld = unheld_share(held);
  const bool is_lost = unheld > most_unheld;
  if (thinness.thin_share < 0.05 && !is_lost) return "";
  const std::string note =
      fmt::format("{:.1f} % of the surface belongs to parts thinner than an element of {} vertices ({:.2g})",
                  100 * thinness.thin_share, vertices, thinness.spacing);
  if (!is_lost) return note + "; they have elements inside nevertheless";
  const auto first = static_cast<std::size_t>(std::find(held.begin(), held.end(), 0) - held.begin());
  const Vec3& place = thinness.samples[first].place;
  return note + fmt::format(
                    "; {:.1f} % has none inside, first at ({:.3g}, {:.3g}, {:.3g}), in the file's units: {} vertices "
                    "resolve them",
                    100 * unheld, place.x(), place.y(), place.z(), count_text(thinness.wanted));
}

// Returns how far elements reach beyond a surface. solid: the shape inside the surface.
double reach_beyond(const TetMesh& mesh, const Shape& solid) {
  double most = 0;
  for (Eigen::Index v = 0; v < mesh.rest.rows(); ++v)
    most = std::max(most, solid.distance(mesh.rest.row(v).transpose()));
  return most;
}

// Keeps the best of the meshes that are tried: the one that leaves least of the surface without an element inside.
struct Attempts {
  const std::vector<ThicknessSample>& samples;  // of the surface
  TetMesh best;
  double least = 1.1;  // share of the surface that the best one leaves; more than there can be: there is no mesh
  std::string reason = "is too thin for its elements";  // why the last of the failed attempts failed

  // Makes a mesh, and tells whether it holds all of the surface.
  bool holds_all(const std::function<TetMesh()>& make) {
    try {
      TetMesh mesh = make();
      const double unheld = unheld_share(held_samples(samples, mesh));
      if (unheld < least) best = std::move(mesh);
      least = std::min(least, unheld);
      return unheld <= most_unheld;
    } catch (const InputError& error) {
      reason = error.problems().front().message;
      return false;
    }
  }
};

[[noreturn]] void refuse_surface(const WantedMesh& wanted, const std::string& reason, const Thinness& thinness) {
  const std::string resolving =
      thinness.wanted > 0 ? fmt::format("; {} resolve nearly all of it", count_text(thinness.wanted)) : "";
  throw InputError(wanted.source, fmt::format("{}; more vertices (now {}{}) may help, or pieces = \"largest\", or "
                                              "thicken = 0.01 [m], which gives sheets a thickness",
                                              reason, wanted.vertices, resolving));
}

// Returns the best mesh of a body that some lattice makes. shape: the solid inside the body's surface. Throws
// InputError where none makes a mesh.
TetMesh tetrahedra_of(const SurfaceBody& body, const WantedMesh& wanted, const Shape& shape, const Thinness& thinness,
                      const SlowWork& work) {
  const MeshingListener listener = listener_of(wanted, work);
  Attempts attempts{thinness.samples, {}};
  double uniform_loss = 0;  // share of the surface that a uniform lattice inside it loses
  const auto uniform = [&](const Shape& inside, double& loss) {
    // The first mesh of about the right size tells whether parts are lost: others of that size lose them too.
    MeshingListener judging = listener;
    judging.judge = [&](const TetMesh& mesh) {
      loss = unheld_share(held_samples(thinness.samples, mesh));
      if (loss > most_unheld) throw InputError(wanted.source, "loses parts that are thinner than its elements");
    };
    return attempts.holds_all([&] { return tetrahedralize(inside, wanted.vertices, wanted.source, judging); });
  };
  const auto lossy = [&] { return tetrahedralize(shape, wanted.vertices, wanted.source, listener); };
  const auto graded = [&](double swollen_to) {
    return attempts.holds_all([&] {
      return graded_tetrahedralize(shape, wanted.vertices, wanted.source, thinness.samples, swollen_to, listener);
    });
  };
  // A mesh that loses less than this share of the surface is taken in place of the last resort: a swollen shape, which
  // is much thicker than the surface.
  constexpr double bearable = 0.05;
  // Where most of the surface is thin, no lattice inside it holds together, and there are no vertices to spare.
  if (thinness.thin_share < 0.5) {
    if (uniform(shape, uniform_loss)) return std::move(attempts.best);
    if (!thinness.samples.empty() && (graded(1.25) || graded(1.5))) return std::move(attempts.best);
    double loss = 0;
    const auto joined = body.touching ? bridged(body.solid.boundary, 3 * thinness.spacing) : std::nullopt;
    if (joined && uniform(*joined, loss)) return std::move(attempts.best);
    if (attempts.least >= bearable && uniform_loss > most_unheld && uniform_loss < bearable) attempts.holds_all(lossy);
    if (attempts.least < bearable) return std::move(attempts.best);
  }
  attempts.holds_all([&] {
    for (const double swell : {0.5, 1.0}) {
      try {
        return tetrahedralize(shape, wanted.vertices, wanted.source, listener, swell);
      } catch (const InputError&) {  // the reason is that of the body inside
      }
    }
    throw InputError(wanted.source, attempts.reason);
  });
  // A body without its thin parts, of which a note tells, is better than none.
  if (attempts.best.rest.rows() == 0 && uniform_loss > most_unheld) attempts.holds_all(lossy);
  if (attempts.best.rest.rows() == 0) refuse_surface(wanted, attempts.reason, thinness);
  return std::move(attempts.best);
}

MadeMesh made_of_surface(const SurfaceBody& body, const WantedMesh& wanted, const SlowWork& work) {
  const Thinness thinness = thinness_of(body.solid.boundary, wanted.vertices);
  const Shape shape = shape_of(body.solid.boundary);
  MadeMesh made{tetrahedra_of(body, wanted, shape, thinness, work), {}};
  const std::string note = thinness_note(thinness, made.mesh, wanted.vertices);
  if (!note.empty()) made.notes.push_back(note);
  const double beyond = reach_beyond(made.mesh, shape);
  if (beyond > 0.1 * thinness.spacing) {
    made.notes.push_back(fmt::format(
        "the elements reach {:.2g} beyond the surface, in the file's units, so that they hold its thin or loose parts: "
        "it bends as what is that much thicker does, and colliders touch the elements, or with contact.skin the skin",
        beyond));
  }
  return made;
}

}  // namespace

MadeMesh mesh_of_surface(const SurfaceBody& body, const WantedMesh& wanted, const SlowWork& work) {
  return kept_or_made(work.cache, kept_name(wanted), made_mesh_from,
                      [&] { return made_of_surface(body, wanted, work); });
}

MadeMesh mesh_of_shape(const Shape& shape, const WantedMesh& wanted, const SlowWork& work) {
  // Slender shapes gain and lose whole layers of vertices at once, and have no mesh of some numbers between.
  constexpr double most_missed = 0.5;
  MadeMesh made;
  made.mesh = kept_or_made(work.cache, kept_name(wanted), tet_mesh_from, [&] {
    return tetrahedralize(shape, wanted.vertices, wanted.source, listener_of(wanted, work), 0, most_missed);
  });
  const Eigen::Index vertices = made.mesh.rest.rows();
  if (std::abs(double(vertices) / wanted.vertices - 1) > usual_miss)
    made.notes.push_back(
        fmt::format("has {} vertices, the nearest number to {} of which a mesh was found", vertices, wanted.vertices));
  return made;
}

std::string bytes_of(const MadeMesh& made) {
  std::string bytes;
  for (const std::string& note : made.notes) bytes += note + '\n';
  return bytes + '\0' + bytes_of(made.mesh);
}

std::optional<MadeMesh> made_mesh_from(std::string_view bytes) {
  const std::size_t end = bytes.find('\0');
  if (end == std::string_view::npos) return std::nullopt;
  auto mesh = tet_mesh_from(bytes.substr(end + 1));
  if (!mesh) return std::nullopt;
  MadeMesh made{std::move(*mesh), {}};
  for (std::size_t at = 0; at < end;) {
    const std::size_t line = bytes.find('\n', at);
    if (line > end) return std::nullopt;
    made.notes.emplace_back(bytes.substr(at, line - at));
    at = line + 1;
  }
  return made;
}

}  // namespace supple
