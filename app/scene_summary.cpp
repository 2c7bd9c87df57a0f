#include <fmt/format.h>

#include <algorithm>

#include "app/solvers.h"
#include "app/summary.h"
#include "base/text.h"
#include "film/frame_cost.h"
#include "film/plan/shipped_files.h"
#include "geometry/shapes/solid_motion.h"
#include "output/run/profile.h"
#include "scene/building/skin_report.h"
#include "scene/replay/script.h"

namespace supple {
namespace {

constexpr int tried_frames = 5;

// Says what the first frames' steps cost, or why that is not known.
std::string cost_text(const World& world, const FrameCost& cost, const Threads& threads) {
  if (!cost.failure.empty()) return cost.failure;
  if (cost.frame_ms.empty()) return "not known: another body's step fails in the first frame";
  const bool free = world.scene().may_touch() && !cost.touched;
  return fmt::format("{:.2f} ms a frame (median of the first {}, {} threads{})", distribution_of(cost.frame_ms).p50,
                     cost.frame_ms.size(), threads.count(),
                     free ? "; it touches nothing in them, and contacts cost more" : "");
}

std::string substance_text(const Body& body) {
  if (body.def.cloth && body.def.cloth->fabric)
    return fmt::format("{} triangles of {}", body.description.cloth.size(), name_of(body.description.fabric.membrane));
  if (body.def.cloth) return fmt::format("{} springs", body.description.springs.size());
  std::vector<std::string> names;
  for (const Material& material : body.description.materials) {
    const std::string name(name_of(material));
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return fmt::format("{} elements of {}", body.description.mesh.tets.rows(), fmt::join(names, ", "));
}

std::string flow_text(const Body& body) {
  std::vector<std::string> parts;
  if (const auto& plastic = body.description.plastic) {
    parts.push_back(fmt::format("keeps strains above a stress of {:g} Pa", plastic->yield));
    if (plastic->hardening > 0) parts.back() += fmt::format(", hardens by {:g} Pa", plastic->hardening);
  }
  if (const auto& creep = body.description.creep)
    parts.push_back(fmt::format("{:g} % of the stiffness gives way in {:g} s", 100 * creep->share, creep->time));
  return parts.empty() ? "" : fmt::format("  flow            {}\n", fmt::join(parts, "; "));
}

std::string handle_text(const Body& body, std::size_t index) {
  const Handle& handle = body.description.handles[index];
  const HandleDef& def = body.def.handles[index];
  Vec3 center = Vec3::Zero();
  for (const std::int32_t v : handle.vertices)
    center += Vec3(body.description.mesh.rest.row(v)) / static_cast<double>(handle.vertices.size());
  std::string times;
  if (def.grabs) {
    times = fmt::format(", from {:g} s{}: a new factor {}", def.from,
                        std::isfinite(def.until) ? fmt::format(" until {:g} s", def.until) : "",
                        std::isfinite(def.until) ? "at both" : "there");
  }
  return fmt::format("  handle          '{}' {} {} vertices around ({:.3g}, {:.3g}, {:.3g}) m{}\n",
                     printable(handle.name), handle.stiffness > 0 ? "pulls" : "holds", handle.vertices.size(),
                     center.x(), center.y(), center.z(), times);
}

// Says what a seam joins.
std::string seam_text(const Body::Seam& seam) {
  return fmt::format(
      "  seam            {} pairs, {:.3g} m of border with {:.3g} m, up to {:.2g} m apart at the start\n", seam.pairs,
      seam.length[0], seam.length[1], seam.widest);
}

std::string body_text(const MovingBody& moving, const DrawnBody& drawn) {
  const Body& body = moving.body();
  const Model& model = moving.model();
  const TetMesh& mesh = body.description.mesh;
  const Vec3 extent = bounds_of(mesh.rest).extent();
  std::string text = fmt::format("\nbody '{}'\n  made of         {}\n", body.def.name, printable(body.source));
  text += fmt::format("  size            {} vertices, {}\n", mesh.rest.rows(), substance_text(body));
  text += fmt::format("  extent          {:.3g} x {:.3g} x {:.3g} m\n", extent.x(), extent.y(), extent.z());
  if (!body.def.cloth) {
    const MeshQuality q = quality(mesh);
    text +=
        fmt::format("  elements        dihedral angles {:.1f} to {:.1f} degrees, smallest volume {:.1e} of the mean\n",
                    q.smallest_dihedral, q.largest_dihedral, q.smallest_volume);
  }
  text += flow_text(body);
  const std::string skin = skin_text(body, drawn);
  if (!skin.empty()) text += fmt::format("  skin            {}\n", skin);
  text += fmt::format("  mass that moves {:.4g} kg\n", model.total_mass);
  for (const Body::Seam& seam : body.seams) text += seam_text(seam);
  for (std::size_t h = 0; h < body.description.handles.size(); ++h) text += handle_text(body, h);
  text +=
      fmt::format("  solver          {}, {} iterations a step, {} numbers in the factor\n",
                  name_of(body.def.solver.method), body.def.solver.settings.iterations, model.factor.stored_numbers());
  return text;
}

// Describes the value that a change leads to, and how it gets there.
std::string course_text(const TimedChange& change) {
  if (change.over <= 0) return fmt::format("becomes {}", printable(change.to.whole_text()));
  return fmt::format("from {} to {} over {:g} s, {}{}", change.from->whole_text(), change.to.whole_text(), change.over,
                     name_of(change.ease), change.by == RampRule::ratio ? " by ratio" : "");
}

// Names the frames in which a change takes effect, and what must be recomputed in each of them.
std::string frames_text(const Script& script, const TimedChange& change) {
  int first = -1, count = 0;
  for (int frame = 0; frame < script.scene().frames; ++frame) {
    const std::vector<const TimedChange*> at_work = script.at_work(frame);
    if (std::ranges::find(at_work, &change) == at_work.end()) continue;
    if (count++ == 0) first = frame;
  }
  if (count == 0) return change.at > 0 ? "not in this film" : "before the first frame";
  const std::string cost = change.cost.text();
  if (count == 1) return fmt::format("in frame {}{}{}", first, cost.empty() ? "" : ": ", cost);
  return fmt::format("in frames {} to {}{}{}", first, first + count - 1, cost.empty() ? "" : ", each: ", cost);
}

// Lists the changes in the order in which they begin.
std::string changes_text(const Script& script) {
  std::string text = fmt::format("changes         {} while it runs\n", script.changes().size());
  for (const TimedChange& change : script.changes()) {
    text += fmt::format("  {:<14}{} {}; {}\n", fmt::format("{:g} s", change.at), change.path, course_text(change),
                        frames_text(script, change));
  }
  return text;
}

std::string deforming_text(const SurfaceMotionDef& motion, const FrameRate& scene_fps) {
  return fmt::format(", deforms: {} frames at {} a second from {:g} s on", motion.motion->frames() - motion.first,
                     motion.fps ? fmt::format("{:g}", *motion.fps) : scene_fps.text(), motion.start);
}

}  // namespace

std::string scene_summary(const SceneSource& source, int thread_count) {
  Script script = Script::load(source, assets_folder(), {});
  std::vector<Body> bodies = assemble(script.scene());
  World world(std::move(script), std::move(bodies));
  Threads threads(thread_count);
  world.start(all_solvers().steps, &threads);
  const SceneDef scene = world.scene();
  std::string text = fmt::format("scene           {}{}\n", printable(scene.name),
                                 scene.title.empty() ? "" : ": " + printable(scene.title));
  text += fmt::format("film            {} frames at {} a second ({}), {} of {} s a frame, {} x {} pixels\n",
                      scene.frames, scene.fps.text(), duration_text(scene.fps.time_of(scene.frames)),
                      scene.substeps == 1 ? "one step" : fmt::format("{} steps", scene.substeps),
                      fmt::format("{:.3g}", scene.time_step()), scene.output.width, scene.output.height);
  if (scene.from)
    text += fmt::format("from            frame {} of {}; what follows tells of the scene's own start\n",
                        scene.from->frame, scene.from->run.string());
  if (world.script().is_replay()) text += changes_text(world.script());
  for (const ColliderDef& collider : scene.colliders)
    text += fmt::format("collider        '{}', friction {:g}{}{}\n", collider.name, collider.friction,
                        collider.keys.empty() ? "" : ", moves",
                        collider.motion ? deforming_text(*collider.motion, scene.fps) : "");
  const std::vector<DrawnBody> drawn = drawn_bodies(world.bodies());
  std::vector<std::string> of_bodies;
  for (std::size_t b = 0; b < world.size(); ++b) of_bodies.push_back(body_text(world.body(b), drawn[b]));
  const std::vector<FrameCost> costs = cost_of_frames(world, std::min(tried_frames, scene.frames));
  for (std::size_t b = 0; b < world.size(); ++b)
    text += of_bodies[b] + fmt::format("  costs           {}\n", cost_text(world, costs[b], threads));
  return text;
}

}  // namespace supple
