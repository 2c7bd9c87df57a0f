#include "scene/building/assemble.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/hash.h"
#include "base/text.h"
#include "scene/building/cloth_cut.h"
#include "scene/building/seam_pairs.h"
#include "scene/building/selected_vertices.h"
#include "scene/building/skin_offsets.h"
#include "scene/building/starts_inside.h"
#include "scene/building/unplaced_body.h"
#include "scene/building/weaving.h"
#include "scene/definition/rotation.h"
#include "scene/definition/scene_def.h"
#include "scene/reading/body_pieces.h"
#include "sim/air/enclosed_volume.h"

namespace supple {
namespace {

// Returns the map from the file's frame to the world: the body is rotated about the origin, scaled, and moved so that
// the middle of its bottom is at `position`.
Eigen::Affine3d placement(const BodyDef& def, const Positions& points) {
  Eigen::Affine3d turned(rotation_from_degrees(def.turn_deg).toRotationMatrix());
  Bounds box, untouched;
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    box.include(turned * Vec3(points.row(v)));
    untouched.include(points.row(v).transpose());
  }
  const double scale = def.size ? *def.size / untouched.extent().maxCoeff() : def.scale;
  const Vec3 foot(box.center().x(), box.lower.y(), box.center().z());
  return Eigen::Translation3d(def.position) * Eigen::Scaling(scale) * Eigen::Translation3d(-foot) * turned;
}

void apply(const Eigen::Affine3d& place, Positions& points) {
  for (Eigen::Index v = 0; v < points.rows(); ++v) points.row(v) = (place * Vec3(points.row(v))).transpose();
}

// Returns the points by whose box a body is placed and scaled. For one of several pieces these are the points of the
// whole, in which the pieces keep their places; for a body whose skin touches, those of the skin, on which it then
// stands.
const Positions& points_to_place(const Body& body) {
  const auto& read = body.def.read_surface;
  if (read && read->pieces.size() > 1) return read->whole;
  return body.def.contact.skin && body.skin.points.rows() > 0 ? body.skin.points : body.unplaced;
}

Problem at(const FilePlace& place, std::string message) { return {place, std::move(message)}; }

// Refuses a body that is too far from the origin. Near 1e16 of its sizes away, no number distinguishes its vertices;
// elements lose digits long before that.
void check_distance(const Body& body, std::vector<Problem>& problems) {
  const Positions& points = body.description.mesh.rest;
  const double far = points.cwiseAbs().maxCoeff(), size = bounds_of(points).diagonal();
  if (far <= 1e8 * size) return;
  problems.push_back(
      at(body.def.place, fmt::format("position of body '{}': {:.3g} m from the origin is more than 1e8 times "
                                     "its size ({:.3g} m), where coordinates have too few digits",
                                     body.def.name, far, size)));
}

// Notes that a body is very large or very small, which is rarely meant: units may have been mixed up.
void note_size(Body& body) {
  const double size = bounds_of(body.description.mesh.rest).extent().maxCoeff();
  if (size <= 20 && size >= 1e-3) return;
  body.notes.push_back(
      fmt::format("body '{}' is {:.3g} m long; size = 0.5 makes it half a metre{}", body.def.name, size,
                  body.def.surface.empty() ? "" : ", and units = \"mm\" takes the file's numbers for that"));
}

void set_substances(Body& body, std::vector<Problem>& problems) {
  const BodyDef& def = body.def;
  BodyDescription& description = body.description;
  // The fibres' direction turns with the body.
  const Mat3 turn = rotation_from_degrees(def.turn_deg).toRotationMatrix();
  const auto turned = [&turn](Fibre fibre) {
    const Vec3 direction = turn * Vec3(fibre.direction[0], fibre.direction[1], fibre.direction[2]);
    for (int i = 0; i < 3; ++i) fibre.direction[i] = direction[i];
    return fibre;
  };
  description.materials.assign(body.regions.size(), def.substance.material);
  description.fibres.assign(body.regions.size(), turned(def.substance.fibre));
  for (const RegionDef& region : def.regions) {
    const auto known = std::find(body.regions.begin(), body.regions.end(), region.name);
    if (known == body.regions.end()) {
      const std::vector<std::string> names(body.regions.begin() + 1, body.regions.end());
      const std::string nearest = did_you_mean(region.name, names);
      // A body that uses another mesh than the one for which the scene was written may lack the region (it may have no
      // teeth that could be stiff). That is noted and not refused.
      if (!def.mesh.empty()) {
        body.notes.push_back(fmt::format("there is no region '{}'; its material is not used", region.name));
      } else {
        problems.push_back(at(region.place, fmt::format("body '{}' has no region '{}'{}", def.name, region.name,
                                                        names.empty()     ? "; it has no tags"
                                                        : nearest.empty() ? "; there is " + word_list(names)
                                                                          : nearest)));
      }
      continue;
    }
    description.materials[known - body.regions.begin()] = region.substance.material;
    description.fibres[known - body.regions.begin()] = turned(region.substance.fibre);
  }
}

// Notes a drag that has no air to come from.
void note_drag(const SceneDef& scene, Body& body) {
  if (!body.def.drag || scene.wind) return;
  body.notes.push_back(fmt::format("body '{}' has a drag, but the scene has no [wind] and so no air", body.def.name));
}

// Tells which vertices belong to earlier handles at some time at which `next` holds, too: the earlier handles keep
// these vertices.
std::vector<char> taken_before(const Body& body, const HandleDef& next) {
  std::vector<char> taken(body.description.mesh.rest.rows(), 0);
  for (std::size_t h = 0; h < body.description.handles.size(); ++h) {
    const HandleDef& earlier = body.def.handles[h];
    if (earlier.until <= next.from || next.until <= earlier.from) continue;
    for (const std::int32_t v : body.description.handles[h].vertices) taken[v] = 1;
  }
  return taken;
}

}  // namespace

void add_handle(Body& body, const HandleDef& def, std::vector<Problem>& problems) {
  const TetMesh& mesh = body.description.mesh;
  Handle handle{def.name, selected_vertices(def.select, body), def.stiffness, !def.grabs || def.holds_at(0)};
  const auto beyond = std::ranges::find_if(def.select.vertices, [&](int v) { return v > mesh.rest.rows(); });
  if (beyond != def.select.vertices.end()) {
    problems.push_back(at(def.select.place, fmt::format("handle '{}': body '{}' has no vertex {}; it has {}", def.name,
                                                        body.def.name, *beyond, mesh.rest.rows())));
    return;
  }
  const bool selects_none = handle.vertices.empty();
  const std::vector<char> taken = taken_before(body, def);
  std::erase_if(handle.vertices, [&](std::int32_t v) { return taken[v] != 0; });
  if (handle.vertices.empty()) {
    problems.push_back(
        at(def.select.place,
           fmt::format("handle '{}' of body '{}' selects no vertex{}", def.name, body.def.name,
                       selects_none ? empty_reason(def.select, body) : " that no other handle holds at that time")));
  }
  const Eigen::Index held = std::accumulate(
      body.description.handles.begin(), body.description.handles.end(),
      def.stiffness <= 0 ? Eigen::Index(handle.vertices.size()) : 0, [](Eigen::Index sum, const Handle& other) {
        return sum + (other.stiffness <= 0 ? Eigen::Index(other.vertices.size()) : 0);
      });
  if (def.stiffness <= 0 && held == mesh.rest.rows()) {
    problems.push_back(
        at(def.select.place, fmt::format("with handle '{}' every vertex of body '{}' is held: nothing is left to move",
                                         def.name, body.def.name)));
  }
  if (def.select.picture)
    body.files.push_back({def.select.mask, hash_bytes(def.select.picture->rgb.data(), def.select.picture->rgb.size())});
  KeyedMotion motion{Vec3::Zero(), def.ease, def.keys};
  Bounds box;
  for (const std::int32_t v : handle.vertices) box.include(mesh.rest.row(v).transpose());
  if (!box.empty()) motion.center = box.center();
  body.description.handles.push_back(std::move(handle));
  body.motions.push_back(std::move(motion));
}

namespace {

// Refuses a pressure in a surface that encloses nothing.
void check_gas(Body& body, std::vector<Problem>& problems) {
  const BodyDescription& description = body.description;
  const Triangles surface =
      description.surface.rows() > 0 ? description.surface : boundary_faces(description.mesh.tets);
  const std::string reason = why_not_closed(surface, description.mesh.rest);
  body.holds_gas = reason.empty();
  if (!reason.empty())
    problems.push_back(at(body.def.pressure_place, fmt::format("pressure of body '{}': a pressure needs a closed "
                                                               "surface, and its surface {}",
                                                               body.def.name, reason)));
}

// Sets all that follows from the definition once the mesh is in its place, except for the handles.
void set_values(Body& body, const SceneDef& scene, std::vector<Problem>& problems) {
  const BodyDef& def = body.def;
  body.description.time_step = scene.time_step();
  body.description.fit = def.solver.fit;
  body.description.precision = def.solver.precision;
  body.description.integrator = def.solver.integrator;
  body.description.damping = def.solver.damping;
  if (def.cloth) {
    weave(body);
  } else {
    body.description.density = def.total_mass ? *def.total_mass / body.volume : def.body_density();
    set_substances(body, problems);
    body.description.plastic = def.plastic;
    body.description.creep = def.creep;
  }
  if (def.pressure && !body.holds_gas) check_gas(body, problems);
}

}  // namespace

void update_body(Body& body, const SceneDef& scene, const BodyDef& def) {
  std::vector<Problem> problems;
  const std::vector<std::string> notes = body.notes;  // these notes were printed when the body was assembled
  const auto starts_or_ends = [&](double ClothDef::*stiffness) {
    return def.cloth && ((*def.cloth).*stiffness > 0) != ((*body.def.cloth).*stiffness > 0);
  };
  if (starts_or_ends(&ClothDef::shear) || starts_or_ends(&ClothDef::bend))
    throw InputError({at(
        def.place, fmt::format("shear and bend of the cloth of body '{}' cannot reach or leave 0 while the film runs",
                               def.name))});
  const bool is_fabric = def.cloth && def.cloth->fabric;
  if (is_fabric != (body.def.cloth && body.def.cloth->fabric))
    throw InputError({at(def.place, fmt::format("cloth of body '{}': springs stay springs while the film runs, and a "
                                                "material stays a material",
                                                def.name))});
  if (is_fabric && def.cloth->fabric->fabric.bending > 0 && body.description.fabric.bending <= 0)
    throw InputError({at(def.place, fmt::format("bend of the cloth of body '{}' cannot leave 0 while the film runs: it "
                                                "can start from a small number",
                                                def.name))});
  if (def.cloth && def.cloth->curved != body.def.cloth->curved)
    throw InputError(
        {at(def.place, fmt::format("curved of the cloth of body '{}' cannot change while the film runs", def.name))});
  if (def.plastic.has_value() != body.def.plastic.has_value() || def.creep.has_value() != body.def.creep.has_value())
    throw InputError({at(def.place, fmt::format("body '{}': 'plastic' and 'creep' can change while the film runs, but "
                                                "neither come nor go",
                                                def.name))});
  body.def = def;
  set_values(body, scene, problems);
  body.notes = notes;
  body.earlier = body.motions;
  for (std::size_t h = 0; h < def.handles.size(); ++h) {
    Handle& handle = body.description.handles[h];
    if ((handle.stiffness <= 0) != (def.handles[h].stiffness <= 0))
      problems.push_back(at(def.handles[h].select.place,
                            fmt::format("handle '{}' of body '{}': hard handles stay hard, and springs stay springs",
                                        handle.name, def.name)));
    handle.stiffness = def.handles[h].stiffness;
    body.motions[h].ease = def.handles[h].ease;
    body.motions[h].keys = def.handles[h].keys;
  }
  if (!problems.empty()) throw InputError(std::move(problems));
}

std::vector<Body> assemble(const SceneDef& scene) { return assemble(scene, SlowWork{}); }

std::vector<Body> assemble(const SceneDef& scene, const SlowWork& work) {
  std::vector<Body> bodies;
  std::vector<Problem> problems;
  UnplacedBodies unplaced(work);
  for (const BodyDef& def : scene.bodies) {
    try {
      Body body = unplaced.get(scene, def);
      body.seed = scene.seed;
      body.unplaced = body.description.mesh.rest;
      body.placement = placement(def, points_to_place(body));
      apply(body.placement, body.description.mesh.rest);
      for (double& overhang : body.description.overhang) overhang *= scale_of(body);
      if (def.contact.skin) body.description.drawn_offset = skin_offsets(body);
      check_distance(body, problems);
      note_size(body);
      note_drag(scene, body);
      if (!def.cloth) body.volume = quality(body.description.mesh).volume;
      set_values(body, scene, problems);
      if (!body.flat.empty()) body.notes.push_back(cut_text(body));
      if (def.pattern_size && *def.pattern_size < 1e-3 * bounds_of(body.description.mesh.rest).diagonal()) {
        problems.push_back(
            at(def.place, fmt::format("pattern_size of body '{}' is below a thousandth of its size", def.name)));
      }
      for (const HandleDef& handle : def.handles) add_handle(body, handle, problems);
      bodies.push_back(std::move(body));
    } catch (const InputError& error) {
      problems.insert(problems.end(), error.problems().begin(), error.problems().end());
    }
  }
  find_starts_inside(scene, bodies, problems);
  for (Body& body : bodies) add_seams(body, problems);
  std::vector<Problem> unique;
  for (Problem& problem : problems) {
    const bool seen =
        std::any_of(unique.begin(), unique.end(), [&](const Problem& p) { return p.text() == problem.text(); });
    if (!seen) unique.push_back(std::move(problem));
  }
  if (!unique.empty()) throw InputError(std::move(unique));
  return bodies;
}

namespace {

// Returns the places from which keys move handled vertices while nothing is grabbed, and tells which handles hold at
// the start.
Anchors rest_anchors(const Model& model, const Body& body) {
  Anchors anchors;
  anchors.points.resize(model.handled.size(), 3);
  for (std::size_t i = 0; i < model.handled.size(); ++i)
    anchors.points.row(i) = model.rest.row(model.handled[i].vertex);
  for (const KeyedMotion& motion : body.motions) anchors.centers.push_back(motion.center);
  for (const HandleDef& def : body.def.handles) anchors.holds.push_back(!def.grabs || def.holds_at(0));
  return anchors;
}

}  // namespace

Positions first_positions(const Body& body) { return body.from ? body.from->x : scene_start(body); }

Positions scene_start(const Body& body) {
  const Positions& rest = body.description.mesh.rest;
  Positions start = start_positions(body.def.start, rest, body.seed, body.description.name);
  start.rowwise() += body.start_move.transpose();
  for (std::size_t h = 0; h < body.description.handles.size(); ++h) {
    if (body.def.handles[h].grabs) continue;
    for (const std::int32_t v : body.description.handles[h].vertices) start.row(v) = rest.row(v);
  }
  return start;
}

namespace {

// Adds the velocities of turning about the centre of mass. spin [rad/s]
void add_spin(const Model& model, const Vec3& spin, State& state) {
  Vec3 center = Vec3::Zero();
  double mass = 0;
  for (int v = 0; v < model.vertices; ++v) {
    mass += model.mass[v];
    center += model.mass[v] * state.x.row(v).transpose();
  }
  center /= mass;
  for (int v = 0; v < model.vertices; ++v)
    state.v.row(v) += spin.cross(Vec3(state.x.row(v).transpose()) - center).transpose();
}

}  // namespace

namespace {

// Gives the handle of the same name what a handle of an earlier run held.
void take_over(const EarlierState::Held& held, const Model& model, const Body& body, Anchors& anchors) {
  const auto found = std::ranges::find(body.def.handles, held.handle, &HandleDef::name);
  if (found == body.def.handles.end()) return;
  const auto handle = static_cast<std::int32_t>(found - body.def.handles.begin());
  anchors.centers[std::size_t(handle)] = held.center;
  anchors.holds[std::size_t(handle)] = held.holds;
  for (std::size_t i = 0; i < model.handled.size(); ++i) {
    if (model.handled[i].handle != handle) continue;
    const auto vertex = std::ranges::find(held.vertices, model.input_of[model.handled[i].vertex]);
    if (vertex != held.vertices.end())
      anchors.points.row(Eigen::Index(i)) = held.points.row(vertex - held.vertices.begin());
  }
}

// Returns the state of a body that goes on from an earlier run.
State later_state(const Model& model, const Body& body, const EarlierState& from) {
  State state = rest_state(model);
  for (int v = 0; v < model.vertices; ++v) {
    state.x.row(v) = from.x.row(model.input_of[v]);
    state.v.row(v) = from.v.row(model.input_of[v]);
  }
  state.time = state.flow.until = from.time;
  if (from.flow.plastic.size() == state.flow.plastic.size() && from.flow.viscous.size() == state.flow.viscous.size())
    state.flow = from.flow;
  state.anchors = rest_anchors(model, body);
  for (std::size_t h = 0; h < body.def.handles.size(); ++h)
    if (body.def.handles[h].grabs) state.anchors.holds[h] = 0;  // it grabs in the first step, where the body is then
  for (const EarlierState::Held& held : from.handles) take_over(held, model, body, state.anchors);
  if (from.memory) state.memory = *from.memory;
  state.bounces = from.bounces;
  return state;
}

}  // namespace

State start_state(const Model& model, const Body& body) {
  if (body.from) return later_state(model, body, *body.from);
  State state = rest_state(model);
  const Positions start = first_positions(body);
  for (int v = 0; v < model.vertices; ++v) {
    state.x.row(v) = start.row(model.input_of[v]);
    state.v.row(v) = body.def.velocity.transpose();
  }
  if (!body.def.spin_deg.isZero(0)) add_spin(model, body.def.spin_deg * (std::numbers::pi / 180), state);
  for (const auto& [vertex, handle, holds] : model.handled) {
    if (!body.def.handles[handle].grabs) state.v.row(vertex).setZero();
  }
  state.anchors = rest_anchors(model, body);
  return state;
}

void grab(const Model& model, int handle, const Positions& x, Anchors& anchors) {
  Bounds box;
  for (std::size_t i = 0; i < model.handled.size(); ++i) {
    if (model.handled[i].handle != handle) continue;
    anchors.points.row(i) = x.row(model.handled[i].vertex);
    box.include(anchors.points.row(i).transpose());
  }
  if (!box.empty()) anchors.centers[handle] = box.center();
}

namespace {

void add_targets(const Model& model, std::vector<KeyedMotion> motions, const Anchors& anchors, double time,
                 double weight, Positions& targets) {
  std::vector<Eigen::Isometry3d> pose;
  for (std::size_t h = 0; h < motions.size(); ++h) {
    motions[h].center = anchors.centers[h];
    pose.push_back(motions[h].at(time));
  }
  for (std::size_t i = 0; i < model.handled.size(); ++i)
    targets.row(i) += weight * (pose[model.handled[i].handle] * Vec3(anchors.points.row(i))).transpose();
}

}  // namespace

void handle_targets(const Model& model, const Body& body, const Anchors& anchors, double time, double change,
                    Positions& targets) {
  targets.setZero(model.handled.size(), 3);
  const bool changing = !body.earlier.empty() && change < 1;
  if (changing) add_targets(model, body.earlier, anchors, time, 1 - change, targets);
  add_targets(model, body.motions, anchors, time, changing ? change : 1, targets);
}

void handle_targets(const Model& model, const Body& body, double time, Positions& targets) {
  handle_targets(model, body, rest_anchors(model, body), time, 1, targets);
}

}  // namespace supple
