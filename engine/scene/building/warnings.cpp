#include "scene/building/warnings.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "geometry/meshes/cloth.h"
#include "geometry/shapes/solid_motion.h"
#include "scene/building/body_depths.h"
#include "scene/building/body_passings.h"
#include "scene/building/cloth_cut.h"
#include "scene/building/collision_set.h"
#include "scene/building/seam_pairs.h"
#include "scene/building/solver_warnings.h"
#include "scene/building/starts_inside.h"
#include "scene/building/thin_bodies.h"
#include "scene/definition/field_def.h"
#include "scene/definition/meeting.h"
#include "scene/definition/scene_def.h"
#include "sim/coarse/rest_moduli.h"
#include "sim/elements/tetrahedron.h"
#include "sim/measures/measures.h"

namespace supple {
namespace {

Warning at(WarningKind kind, const FilePlace& place, std::string message) {
  return {kind, {place, std::move(message)}};
}

constexpr double stiff_crossing = 300;  // above this number, ten iterations leave a visible error
constexpr double soft_crossing = 1;     // below this number, no wave crosses the body in a step

// Tells whether a body starts as a line or a point and has a material whose forces cannot restore it: laws in F alone
// and springs have no force across a body that is flat in two directions.
bool stays_flat(const Body& body) {
  const auto* flat = std::get_if<Flattened>(&body.def.start);
  if (flat == nullptr || flat->kept.sum() > 1.5) return false;
  return body.def.cloth ||
         std::visit([](const auto& m) { return m.needs == Needs::deformation_gradient; }, body.def.substance.material);
}

// Warns of a solid that its own weight stretches or squashes by more than its size: rho g L / k, where it hangs or
// stands. No material here is meant for such strains, and ten iterations do not reach them.
void warn_of_weight(const SceneDef& scene, const Body& body, const Bounds& box, std::vector<Warning>& list) {
  if (body.def.cloth || (body.def.handles.empty() && scene.colliders.empty()) || scene.gravity.isZero(0)) return;
  const double k =
      system_stiffness(body.def.substance.material, body.def.solver.fit).k + body.def.substance.fibre.kappa;
  const double height = box.extent().dot(scene.gravity.normalized().cwiseAbs());
  const double strain = body.description.density * scene.gravity.norm() * height / k;
  if (strain <= 1) return;
  list.push_back(at(WarningKind::weight, body.def.place,
                    fmt::format("body '{}' is soft for its load: its own weight strains it by {:.0f} %; a "
                                "stiffer material, less gravity or more solver.iterations help",
                                body.def.name, 100 * strain)));
}

// Warns of regions whose stiffnesses are so far apart that the iterations spend themselves on the stiffest one: at a
// ratio of 1e6 the error of the whole body stayed at 0.44.
void warn_of_regions(const Body& body, std::vector<Warning>& list) {
  double least = HUGE_VAL, most = 0;
  std::vector<char> seen(body.description.materials.size(), 0);
  for (const int region : body.description.mesh.regions) {
    if (std::exchange(seen[std::size_t(region)], 1) != 0) continue;
    const double k = system_stiffness(body.description.materials[std::size_t(region)], body.def.solver.fit).k;
    least = std::min(least, k);
    most = std::max(most, k);
  }
  if (!(most > 1e4 * least)) return;
  list.push_back(at(WarningKind::regions, body.def.place,
                    fmt::format("regions of body '{}' differ in stiffness by a factor of {:.1g}: "
                                "iterations are spent on the stiffest, and the others stay unsolved",
                                body.def.name, most / least)));
}

// Warns of a body that is so small that gravity alone carries it past its own size within a step: contact finds it deep
// inside what it falls on.
void warn_of_size(const SceneDef& scene, const Body& body, const Bounds& box, std::vector<Warning>& list) {
  const double fall = scene.gravity.norm() * scene.time_step() * scene.time_step();
  if (scene.colliders.empty() || fall <= box.diagonal()) return;
  list.push_back(at(WarningKind::size, body.def.place,
                    fmt::format("body '{}' is small for its steps: gravity carries it by {:.2g} times its "
                                "size ({:.2g} m) in one; more substeps or a higher fps help",
                                body.def.name, fall / box.diagonal(), box.diagonal())));
}

// Warns of a delay that leaves no iteration to be accelerated.
void warn_of_delay(const Body& body, std::vector<Warning>& list) {
  const SolverDef& solver = body.def.solver;
  const int delay = solver.settings.chebyshev.delay, iterations = solver.settings.iterations;
  if (solver.method.acceleration != Acceleration::chebyshev || delay < iterations) return;
  list.push_back(at(WarningKind::delay, body.def.place,
                    fmt::format("body '{}' is solved by chebyshev, whose acceleration begins after {} iterations, and "
                                "a step has {}: this is projective-dynamics; make chebyshev_delay smaller than "
                                "iterations",
                                body.def.name, delay, iterations)));
}

void warn_of_substance(const Body& body, std::vector<Warning>& list) {
  for (const Material& material : body.description.materials) {
    if (system_stiffness(material, body.def.solver.fit).floored) {
      list.push_back(
          at(WarningKind::material, body.def.place,
             fmt::format("a material of body '{}' ({}) softens so much that its stiffness fit is not positive; "
                         "the solver works with a thousandth of its steepest slope instead",
                         body.def.name, name_of(material))));
    }
  }
  if (stays_flat(body)) {
    list.push_back(at(WarningKind::material, body.def.place,
                      fmt::format("body '{}' starts as a line or a point, and its material has no force across "
                                  "those: it will not recover",
                                  body.def.name)));
  }
}

// Warns of a body that search directions take for far stiffer than it is near rest. Ten iterations hardly move what is
// free there, and the estimates of errors do not see all of it: stiff cubes of such materials that land end steps with
// all of their motion missing (docs/stability.md).
void warn_of_looseness(const Body& body, std::vector<Warning>& list) {
  constexpr double firm = 30;
  if (body.def.cloth || crossing_number(body) <= firm) return;
  for (const Material& material : body.description.materials) {
    if (!is_loose_at_rest(material, system_stiffness(material, body.def.solver.fit))) continue;
    list.push_back(at(WarningKind::material, body.def.place,
                      fmt::format("body '{}' is firm for its time step, but its material ({}) is loose near rest: the "
                                  "solver works with the stiffness of larger strains, so that steps may end far from "
                                  "solved, and not all are named; more substeps make it less",
                                  body.def.name, name_of(material))));
  }
}

// Tells whether all trial bodies of a material came back from folded starts by themselves (docs/stability.md).
bool comes_back_from_folds(const Material& material) {
  return std::holds_alternative<AsRigidAsPossible>(material) || std::holds_alternative<Corotated>(material) ||
         std::holds_alternative<StrainLimiting>(material);
}

// Tells whether a collider may stop a body that falls down this shaft, at any time.
bool may_stop_a_fall(const SceneCollider& collider, const Bounds& shaft) {
  if (is_half_space(collider)) return true;
  std::vector<double> times = {0};
  for (const MotionKey& key : collider.def.keys) times.push_back(key.time);
  const Bounds box = collider.def.shape.bounds();
  Bounds swept;
  for (const double time : times) {
    const Vec3 center = collider.pose(time) * box.center();
    const Vec3 reach = Vec3::Constant(0.5 * box.diagonal() + collider.def.thickness);
    swept.include(center - reach);
    swept.include(center + reach);
  }
  return (swept.upper.array() >= shaft.lower.array()).all() && (swept.lower.array() <= shaft.upper.array()).all();
}

// Warns of a body that falls through the ground, which every film shows at y = 0 and which stops nothing.
void warn_of_fall(const SceneDef& scene, const Body& body, std::vector<Warning>& list) {
  const double size = bounds_of(body.description.mesh.rest).diagonal(), duration = scene.fps.time_of(scene.frames);
  for (std::size_t h = 0; h < body.description.handles.size(); ++h) {
    if (body.def.handles[h].from < scene.time_at_start() + duration) return;
  }
  Bounds shaft = bounds_of(first_positions(body));
  const Vec3 velocity = body.from ? Vec3(body.from->v.colwise().mean().transpose()) : body.def.velocity;
  const double bottom = shaft.lower.y(), g = -scene.gravity.y();
  const double lowest = bottom + velocity.y() * duration - 0.5 * g * duration * duration;
  if (g <= 0 || bottom < -0.01 * size || lowest > -0.5 * size) return;
  const Vec3 drift = velocity * duration + 0.5 * duration * duration * scene.gravity;
  shaft.include(shaft.lower + drift);
  shaft.include(shaft.upper + drift);
  for (const SceneCollider& collider : collision_set(scene).scene_colliders) {
    if (may_stop_a_fall(collider, shaft)) return;
  }
  list.push_back(at(WarningKind::fall, body.def.place,
                    fmt::format("body '{}' falls through the ground that the film shows: the scene has no collider "
                                "there, such as [[collider]] shape = {{ half_space = {{ normal = [0, 1, 0] }} }}",
                                body.def.name)));
}

// Warns of colliders that deform so fast that a body may be hit before its elements can give way: where a part of the
// surface goes further in a step than a tenth of the smallest body.
void warn_of_fast_surfaces(const SceneDef& scene, const std::vector<Body>& bodies, std::vector<Warning>& list) {
  constexpr double most = 0.1;
  double size = HUGE_VAL;
  for (const Body& body : bodies) size = std::min(size, bounds_of(body.description.mesh.rest).diagonal());
  for (const ColliderDef& collider : scene.colliders) {
    if (!collider.motion) continue;
    const double frames = std::min(1.0, collider.motion->fps.value_or(scene.fps) * scene.time_step());
    const double way = frames * collider.shape.root.parts.front().scale * collider.motion->motion->longest_way();
    if (way <= most * size) continue;
    list.push_back(
        {std::nullopt,
         {collider.place,
          fmt::format("collider '{}': its motion takes the surface {:.2g} m further in one step of {:.3g} s, "
                      "which is {:.0f} % of the smallest body; more 'substeps', or a lower 'fps' of the "
                      "motion, keep contact exact",
                      collider.name, way, scene.time_step(), 100 * way / size)}});
  }
}

// Warns of handles that follow a body whose velocities keep fast vibrations, because implicit midpoint damps none: the
// handle's targets go on with these velocities for a step, and shake. A cube of rubber on springs of 50 N/m exploded
// within 24 frames.
void warn_of_followed(const std::vector<Body>& bodies, std::vector<Warning>& list) {
  const auto followed = [&bodies](const HandleDef& handle) {
    return std::ranges::any_of(bodies, [&handle](const Body& body) {
      return handle.attach && handle.attach->body == body.def.name &&
             body.def.solver.integrator == Integrator::implicit_midpoint;
    });
  };
  for (const Body& body : bodies) {
    for (const HandleDef& handle : body.def.handles) {
      if (!followed(handle)) continue;
      list.push_back(
          at(WarningKind::handle, handle.select.place,
             fmt::format("handle '{}' of body '{}' will shake: it follows body '{}', whose implicit-midpoint "
                         "keeps fast vibrations; backward-euler there, or a collider, leads smoothly",
                         handle.name, body.def.name, handle.attach->body)));
      list.back().meant = is_meant(body.def, WarningKind::handle);
    }
  }
}

// Tells whether an overlap is only that of bodies that touch, in a film that goes on from another one.
bool is_contact_of_earlier_run(const std::vector<Body>& bodies, const BodyDepth& overlap) {
  return bodies[overlap.a].from && bodies[overlap.b].from && overlap.share <= DeepBodies::deep;
}

// Warns of bodies that start in the same place, whether they meet or pass through each other, or in themselves. Either
// of them may say that it is meant.
void warn_of_shared_space(const std::vector<Body>& bodies, std::vector<Warning>& list) {
  std::vector<Positions> points;
  for (const Body& body : bodies) points.push_back(first_positions(body));
  const auto warn = [&](std::size_t a, std::size_t b, std::string message) {
    const BodyDef &one = bodies[a].def, &other = bodies[b].def;
    list.push_back(at(WarningKind::overlap, other.place, std::move(message)));
    list.back().meant = is_meant(one, WarningKind::overlap) || is_meant(other, WarningKind::overlap);
  };
  BodyPassings passings(bodies);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (passings.crosses_itself(b, points[b]))
      warn(b, b,
           fmt::format(
               "cloth '{}' crosses itself at the start: contact holds each part on its side, and it hardly moves "
               "there; contact = {{ self = false }} lets it pass through itself",
               bodies[b].def.name));
  }
  for (const auto& [a, b] : passings.find(points))
    warn(a, b,
         meet(bodies[a].def, bodies[b].def)
             ? fmt::format("cloths '{}' and '{}' cross each other at the start: contact holds each part on its side",
                           bodies[a].def.name, bodies[b].def.name)
             : fmt::format("bodies '{}' and '{}' pass through each other from the start on: these two do not meet",
                           bodies[a].def.name, bodies[b].def.name));
  for (const auto& overlaps : {overlaps_of_bodies(bodies, points), bodies_in_themselves(bodies, points)})
    for (const BodyDepth& overlap : overlaps)
      if (!is_contact_of_earlier_run(bodies, overlap)) warn(overlap.a, overlap.b, start_overlap_text(bodies, overlap));
}

}  // namespace

namespace {

// Tells whether ten iterations leave a cloth behind its motion. A swinging sheet of triangles whose stiffness is 2.2e5
// times their inertia ends a swing of 1.3 sizes within 0.06 sizes of the solved one.
bool is_stiff_cloth(const Body& body) {
  constexpr double most = 3e5;
  if (!body.def.cloth || !body.def.cloth->fabric) return false;
  const Positions& rest = body.description.mesh.rest;
  const double edge = mean_edge(body.cloth.surface.triangles, rest), size = bounds_of(rest).diagonal();
  return crossing_number(body) * size * size > most * edge * edge;
}

}  // namespace

double crossing_number(const Body& body) {
  const double h = body.description.time_step, size = bounds_of(body.description.mesh.rest).diagonal();
  double stiffness =
      system_stiffness(body.def.substance.material, body.def.solver.fit).k + body.def.substance.fibre.kappa;
  double density = body.description.density;
  if (body.def.cloth) {  // for a sheet: tension by width, over mass by area
    const std::vector<double>& points = body.description.point_mass;
    const std::vector<double> areas = vertex_areas({body.description.mesh.rest, body.cloth.surface.triangles});
    const ClothDef& cloth = *body.def.cloth;
    stiffness = cloth.stretch;
    if (cloth.fabric) {
      const auto [warp, weft] =
          system_stiffness(cloth.fabric->fabric.membrane, body.def.solver.fit.start, body.def.solver.fit.end).along;
      stiffness = std::max(warp, weft);
    }
    density = std::accumulate(points.begin(), points.end(), 0.0) / std::accumulate(areas.begin(), areas.end(), 0.0);
  }
  return stiffness * h * h / (density * size * size);
}

std::string stiffness_words(double crossing) {
  if (crossing > stiff_crossing) return "stiff for its time step";
  return crossing > soft_crossing ? "firm for its time step" : "soft for its time step";
}

bool is_meant(const BodyDef& body, WarningKind kind) { return std::ranges::find(body.meant, kind) != body.meant.end(); }

std::vector<Problem> said(std::vector<Warning> list) {
  std::vector<Problem> problems;
  for (Warning& warning : list)
    if (!warning.meant) problems.push_back(std::move(warning.problem));
  return problems;
}

namespace {

// Warns of a cloth that starts stretched or pressed far from its cut.
void warn_of_cut(const Body& body, std::vector<Warning>& list) {
  if (body.flat.empty()) return;
  const CutStretch stretch = cut_stretch(body);
  if (stretch.far <= 0) return;
  const double equal = scale_of_equal_area(body), own = cut_scale(body);
  const bool is_scale = own > 1.2 * equal || own < equal / 1.2;
  list.push_back(
      at(WarningKind::cut, body.def.cloth->cut_place,
         fmt::format("body '{}' starts far from its cut: {:.3g} % of its triangles are stretched beyond 1.5 or pressed "
                     "below 0.67 ({:.2f} to {:.2f} in all); {}",
                     body.def.name, 100 * stretch.far, stretch.least, stretch.largest,
                     is_scale ? fmt::format("cut_scale = {:.4g} would give the cut the area of the surface", equal)
                              : "the texture may be no cut of it")));
}

void warn_of_slivers(const Body& body, const MeshQuality& quality, std::vector<Warning>& list) {
  if (body.def.cloth || quality.smallest_volume >= 1e-4) return;
  list.push_back(at(WarningKind::slivers, body.def.place,
                    fmt::format("body '{}' has slivers: its smallest element has {:.1e} of the mean volume, its "
                                "smallest dihedral angle is {:.2g} degrees",
                                body.def.name, quality.smallest_volume, quality.smallest_dihedral)));
}

// Warns of handles that jump, or are soft for their load. weight: weight of the body [N]; size: its diagonal [m].
void warn_of_handles(const Body& body, double weight, double size, std::vector<Warning>& list) {
  for (std::size_t i = 0; i < body.description.handles.size(); ++i) {
    const Handle& handle = body.description.handles[i];
    const HandleDef& def = body.def.handles[i];
    if (def.grabs && !body.motions[i].at(def.from).isApprox(Eigen::Isometry3d::Identity(), 1e-6)) {
      list.push_back(at(WarningKind::handle, def.select.place,
                        fmt::format("handle '{}' of body '{}' has moved by its keys already when it grabs, at {:g} s: "
                                    "its vertices jump",
                                    handle.name, body.def.name, def.from)));
    }
    if (handle.stiffness <= 0 || def.grabs) continue;
    const double sag = weight / (handle.stiffness * static_cast<double>(handle.vertices.size()));
    if (sag <= 0.02 * size) continue;
    list.push_back(at(WarningKind::handle, def.select.place,
                      fmt::format("handle '{}' of body '{}' is soft for its load: the body's weight alone stretches "
                                  "its springs by {:.2g} m ({:.0f} % of its size)",
                                  handle.name, body.def.name, sag, 100 * sag / size)));
  }
}

// Warns of a body that is too stiff for its solver to move as it should.
void warn_of_stiffness(const SceneDef& scene, const Body& body, std::vector<Warning>& list) {
  const double crossing = crossing_number(body);
  const SolverSettings& solver = body.def.solver.settings;
  constexpr double turns_with_one_level = 0.3;  // at 0.46, a ball of jelly loses a quarter of its roll
  if (crossing > turns_with_one_level && solver.levels < 2 && !body.def.cloth) {
    list.push_back(at(WarningKind::turning, body.def.place,
                      fmt::format("body '{}' will turn less than it should, because it is stiff and its solver has one "
                                  "level; solver.levels = 2 mends it",
                                  body.def.name)));
  }
  if (std::string slow = damping_text(scene, body); !slow.empty())
    list.push_back(at(WarningKind::turning, body.def.place, std::move(slow)));
  if ((crossing > stiff_crossing || is_stiff_cloth(body)) && solver.iterations <= 10) {
    list.push_back(at(WarningKind::stiffness, body.def.place,
                      fmt::format("body '{}' is stiff for {} iterations a step; more solver.iterations or substeps "
                                  "make its motion sharper",
                                  body.def.name, solver.iterations)));
  }
}

void warn_of_body(const SceneDef& scene, const Body& body, std::vector<Warning>& list) {
  const std::size_t first = list.size();
  const MeshQuality q = quality(body.description.mesh);
  const Bounds box = bounds_of(body.description.mesh.rest);
  const std::vector<double>& points = body.description.point_mass;
  const double mass = body.description.density * q.volume + std::accumulate(points.begin(), points.end(), 0.0);
  warn_of_slivers(body, q, list);
  warn_of_handles(body, mass * scene.gravity.norm(), box.diagonal(), list);
  warn_of_cut(body, list);
  for (std::size_t s = 0; s < body.seams.size(); ++s) {
    if (std::string uneven = uneven_seam_text(body, s); !uneven.empty())
      list.push_back(at(WarningKind::seam, body.def.cloth->seams[s].places[0], std::move(uneven)));
  }
  warn_of_stiffness(scene, body, list);
  if (!body.starts_inside.empty() && !body.from && body.def.start_inside != StartInside::push)
    list.push_back(at(WarningKind::inside, body.def.place, start_inside_text(body)));
  warn_of_fall(scene, body, list);
  warn_of_substance(body, list);
  warn_of_looseness(body, list);
  warn_of_weight(scene, body, box, list);
  warn_of_size(scene, body, box, list);
  warn_of_regions(body, list);
  if (std::string thin = thinness_text(body); !thin.empty())
    list.push_back(at(WarningKind::thin, body.def.place, std::move(thin)));
  warn_of_delay(body, list);
  for (std::size_t i = first; i < list.size(); ++i) list[i].meant = is_meant(body.def, *list[i].kind);
}

}  // namespace

std::vector<Warning> warnings(const SceneDef& scene, const std::vector<Body>& bodies) {
  std::vector<Warning> list;
  for (const Body& body : bodies) warn_of_body(scene, body, list);
  warn_of_shared_space(bodies, list);
  warn_of_fast_surfaces(scene, bodies, list);
  warn_of_followed(bodies, list);
  if (std::string idle = idle_matrix_text(bodies); !idle.empty())
    list.push_back({std::nullopt, {bodies.front().def.place, std::move(idle)}});
  return list;
}

std::string untangle_advice(const Body& body) {
  if (body.def.cloth || body.def.solver.untangle ||
      std::ranges::all_of(body.description.materials, comes_back_from_folds))
    return {};
  const TetMesh& rest = body.description.mesh;
  const TetMesh start{first_positions(body), rest.tets, {}};
  int tangled = 0;
  for (Eigen::Index e = 0; e < rest.tets.rows(); ++e)
    tangled += tet_volume(start, e) <= without_volume * tet_volume(rest, e) ? 1 : 0;
  if (tangled == 0) return {};
  return fmt::format(
      "{} of its {} elements start inverted or flat, and '{}' may stay folded from there: "
      "solver.untangle = true unfolds nearly all such starts",
      tangled, rest.tets.rows(), name_of(body.description.materials.front()));
}

std::vector<Problem> known_after_film(const SceneDef& scene) {
  std::vector<Problem> list;
  if (scene.field.quantity != FieldQuantity::none && scene.field.range_by == FieldRange::film)
    list.push_back({"field.range", 0, 0,
                    "\"film\" is known only once the film has been made: give two numbers here, or draw the run again "
                    "with it (supple draw RUN --set field.range=film)"});
  if (scene.text.time_graph)
    list.push_back({"text.time_graph", 0, 0,
                    "the pictures of a run hold no graph of times that are still being measured: draw the run again "
                    "with it (supple draw RUN --set text.time_graph=true)"});
  return list;
}

}  // namespace supple
