#include "film/pictures/film_stage.h"

#include <algorithm>
#include <numbers>

#include "base/floats.h"
#include "film/pictures/drawn_cloth.h"
#include "film/pictures/picture_words.h"
#include "geometry/skins/rounded_skin.h"
#include "geometry/skins/simplify.h"
#include "geometry/skins/skin_stretch.h"
#include "render/view.h"
#include "sim/elements/tetrahedron.h"

namespace supple {

namespace {

constexpr double collider_gloss = 0.35;

// A skin's edges outside all elements are shortened if they are stretched by more than this factor times the largest
// stretch of the elements (at least 1).
constexpr double most_skin_stretch = 1.4;

Vec3 collider_color(const ColliderDef& def) {
  const bool painted = !def.shape.paint.empty() || def.shape.color != Shape{}.color;
  return def.color.value_or(painted ? def.shape.color : Vec3(0.56, 0.64, 0.71));
}

// Makes the part of a drawn mesh that follows from its skin, for bodies and colliders alike.
DrawMesh mesh_of(const Skin& skin, const std::vector<PaintLayer>& layers) {
  DrawMesh mesh;
  mesh.triangles.assign(skin.rest.triangles.data(), skin.rest.triangles.data() + skin.rest.triangles.size());
  mesh.occlusion = skin.occlusion;
  mesh.paint = skin.paint;
  mesh.square = skin.square;
  mesh.flat = skin.flat;
  mesh.surface_colors = skin.color;
  mesh.smooth.assign(skin.smooth.begin(), skin.smooth.end());
  for (const PaintLayer& layer : layers) mesh.layers.push_back({layer.color, layer.gloss, layer.soft});
  return mesh;
}

Positions at_pose(const Positions& points, const Eigen::Isometry3d& pose) {
  return (points * pose.linear().transpose()).rowwise() + pose.translation().transpose();
}

// Returns the distance from a point straight down to a collider at the start of the film; nothing where the collider
// does not lie between the point and the drawn ground. The values of the distance field are steps that lead through no
// surface (sphere tracing, Hart 1996). near: how close to the surface counts as on it [m].
std::optional<double> way_down(const Vec3& from, const SceneCollider& collider, double near) {
  const Eigen::Isometry3d to_local = collider.pose(0).inverse();
  const double certainty = collider.def.shape.certainty();
  for (double way = 0; way < from.y();) {
    const double there = certainty * collider.def.shape.distance(to_local * Vec3(from - way * Vec3::UnitY()));
    if (there < near) return way;
    way += there;
  }
  return std::nullopt;
}

// Returns the collider on which a body comes down. meshes: the drawn meshes of the bodies, then those of the colliders.
std::optional<Board> board_of(const Bounds& body, const std::vector<SceneCollider>& colliders,
                              const std::vector<DrawMesh>& meshes, std::size_t bodies) {
  std::optional<Board> board;
  const double near = 1e-3 * body.diagonal();
  double least = 1e300;
  for (std::size_t c = 0; c < colliders.size(); ++c) {
    if (!meshes[bodies + c].framed) continue;
    const std::optional<double> way = way_down(body.center(), colliders[c], near);
    if (!way || *way == 0 || *way >= least) continue;
    least = *way;
    const Eigen::Isometry3d pose = colliders[c].pose(0);
    const Vec3 local = pose.inverse() * Vec3(body.center() - least * Vec3::UnitY());
    const Vec3 normal = pose.linear() * colliders[c].def.shape.gradient(local, near).normalized();
    const Vec3 downhill = normal.y() * normal - Vec3::UnitY();
    constexpr double level = 0.05;  // the sine of an angle at which bodies stay rather than slide
    board = Board{bodies + c, downhill.norm() > level ? downhill : Vec3(Vec3::Zero())};
  }
  return board;
}

// Finds the colliders on which bodies come down. A collider that bears several bodies is a ground to them.
void find_boards(const std::vector<SceneCollider>& colliders, std::size_t bodies, std::vector<DrawMesh>& meshes) {
  std::vector<int> borne(meshes.size(), 0);
  for (std::size_t b = 0; b < bodies; ++b) {
    meshes[b].board = board_of(meshes[b].rest, colliders, meshes, bodies);
    if (meshes[b].board) ++borne[meshes[b].board->mesh];
  }
  for (std::size_t b = 0; b < bodies; ++b)
    if (meshes[b].board && borne[meshes[b].board->mesh] > 1) meshes[b].board.reset();
}

}  // namespace

Bounds bounds_at_rest(const std::vector<Body>& bodies) {
  Bounds around;
  for (const Body& body : bodies) {
    const Bounds box = bounds_of(body.description.mesh.rest);
    around.include(box.lower);
    around.include(box.upper);
  }
  return around;
}

std::vector<Skin> collider_skins(const std::vector<SceneCollider>& colliders, const std::vector<Body>& bodies) {
  std::vector<Skin> skins;
  for (const SceneCollider& collider : colliders) skins.push_back(drawn_collider(collider, bounds_at_rest(bodies)));
  return skins;
}

void add_colliders(const std::vector<SceneCollider>& colliders, const std::vector<Skin>& skins, double time,
                   DrawList& list) {
  for (std::size_t c = 0; c < colliders.size(); ++c)
    list.positions.push_back(as_floats(at_pose(drawn_places(colliders[c], skins[c], time), colliders[c].pose(time))));
}

DrawMesh collider_mesh(const SceneCollider& collider, const Skin& skin) {
  DrawMesh mesh = mesh_of(skin, collider.def.shape.paint);
  mesh.name = collider.def.name;
  mesh.color = collider_color(collider.def);
  mesh.gloss = collider_gloss;
  mesh.finish = collider.def.finish;
  mesh.rest = bounds_of(at_pose(skin.rest.points, collider.pose(0)));
  mesh.framed = skin.rest.points.rows() > 0 && collider.def.shape.bounds().diagonal() < 1e6;
  return mesh;
}

StageColors colors_of(const LookDef& look) { return {look.ground, look.background, look.exposure}; }

namespace {

LightRig rig_of(LightKind kind) {
  switch (kind) {
    case LightKind::sunset: return sunset_light();
    case LightKind::overcast: return overcast_light();
    case LightKind::dark: return dark_light();
    case LightKind::studio: break;
  }
  return studio_light();
}

}  // namespace

Stage make_stage(const SceneDef& scene, const std::vector<Body>& bodies, const std::vector<DrawnBody>& drawn,
                 const std::vector<SceneCollider>& colliders, const std::vector<Skin>& skins, const Font& font) {
  Stage stage;
  stage.width = scene.output.width;
  stage.height = scene.output.height;
  stage.samples = scene.output.samples;
  stage.colors = colors_of(scene.look);
  stage.light = rig_of(scene.look.light);
  stage.font = font;
  stage.note_template = longest_note(scene);
  stage.headline_template = longest_headline(scene);
  stage.subtitles = all_subtitles(scene.text);
  if (scene.look.backdrop == BackdropKind::plain) stage.backdrop = Backdrop::plain;
  if (scene.look.backdrop == BackdropKind::transparent) stage.backdrop = Backdrop::transparent;
  if (scene.look.backdrop == BackdropKind::shadows) stage.backdrop = Backdrop::shadows;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Skin& skin = drawn[b].skin;
    DrawMesh mesh = mesh_of(skin, drawn[b].layers);
    mesh.name = bodies[b].def.name;
    if (scene.look.show_labels) mesh.label = bodies[b].def.label;
    mesh.kept_clear = true;
    mesh.printed = bodies[b].def.pattern == Pattern::checks ? Printed::checks : Printed::grid;
    mesh.shadow_triangles.assign(drawn[b].casters.data(), drawn[b].casters.data() + drawn[b].casters.size());
    mesh.two_sided = drawn[b].two_sided;
    mesh.color = drawn[b].color;
    mesh.textures = drawn[b].textures;
    mesh.cloth = cloth_look(bodies[b].def, bodies[b].description.mesh.rest);
    mesh.gloss = gloss_of(bodies[b].def);
    mesh.finish = bodies[b].def.finish;
    mesh.wires = scene.look.wireframe;
    mesh.rest = bounds_of(bodies[b].description.mesh.rest);
    stage.meshes.push_back(std::move(mesh));
  }
  for (std::size_t c = 0; c < colliders.size(); ++c) stage.meshes.push_back(collider_mesh(colliders[c], skins[c]));
  find_boards(colliders, bodies.size(), stage.meshes);
  return stage;
}

namespace {

// Returns the edge of a pixel at the point of the body at rest that is nearest to the camera [m].
double pixel_on(const Bounds& body, const Camera& camera, int height) {
  const double nearest = std::max((camera.eye - body.center()).norm() - 0.5 * body.diagonal(), 0.1 * body.diagonal());
  return 2 * std::tan(camera.fov_deg * std::numbers::pi / 360) * nearest / height;
}

// Returns the edge of the smallest pixel that one of the cameras has there [m].
double pixel_on(const Bounds& body, const std::vector<Camera>& cameras, int height) {
  double pixel = 1e300;
  for (const Camera& camera : cameras) pixel = std::min(pixel, pixel_on(body, camera, height));
  return pixel;
}

// Returns how round a skin has to be to look round in enlarged pictures: edges are up to six pixels long, or off by
// less than half a pixel.
Roundness roundness_for(double pixel) { return {6 * pixel, 0.5 * pixel}; }

void round_body(DrawnBody& drawn, const Body& body, double pixel) {
  const ExactSurface exact{body.shape, body.placement};
  const auto ends = round_off(drawn.skin, roundness_for(pixel), body.def.shape.empty() ? nullptr : &exact);
  if (!ends.empty())
    drawn.embedding = with_middles(drawn.embedding, drawn.skin.rest.points, ends, body.description.mesh);
}

void fit_to_pixels(DrawnBody& drawn, const TetMesh& mesh, double pixel) {
  // The surface bends from element to element, so the triangles that are drawn may be no longer than two elements. With
  // an error of 0.75 pixels, dents were visible in enlarged pictures.
  drawn.skin.rest.triangles = simplified(drawn.skin, 0.4 * pixel, 2 * mean_edge(mesh), drawn.layers, drawn.skin.color);
  const std::vector<std::int32_t> kept = remove_unused_vertices(drawn.skin);
  keep_points(drawn.embedding, kept);
  // A texel of the shadow map is about as large as a pixel, and a shadow shows neither normals nor colours.
  drawn.casters = simplified(drawn.skin, 0.8 * pixel, 2 * mean_edge(mesh), {});
}

}  // namespace

void fit_to_cameras(std::vector<DrawnBody>& drawn, const std::vector<Body>& bodies, const std::vector<Camera>& cameras,
                    int height) {
  for (std::size_t b = 0; b < drawn.size(); ++b) {
    if (!drawn[b].vertex_of.empty() && !drawn[b].subdivides) continue;
    const TetMesh& mesh = bodies[b].description.mesh;
    const double pixel = pixel_on(bounds_of(mesh.rest), cameras, height);
    if (drawn[b].subdivides) {
      smooth_for_pixels(drawn[b], mesh.rest, pixel);
      continue;
    }
    round_body(drawn[b], bodies[b], pixel);
    fit_to_pixels(drawn[b], mesh, pixel);
  }
  limit_stretch(drawn);
}

void round_for_cameras(Skin& skin, const SceneCollider& collider, const std::vector<Camera>& cameras, int height) {
  const ShapeGroup& root = collider.def.shape.root;
  const bool of_file = root.parts.size() == 1 && std::holds_alternative<ClosedSurface>(root.parts.front().primitive);
  if (skin.rest.points.rows() == 0 || of_file) return;
  const ExactSurface exact{collider.def.shape, no_placement()};
  const double pixel = pixel_on(bounds_of(at_pose(skin.rest.points, collider.pose(0))), cameras, height);
  round_off(skin, roundness_for(pixel), &exact);
}

void limit_stretch(std::vector<DrawnBody>& drawn) {
  for (DrawnBody& body : drawn)
    if (body.vertex_of.empty()) body.limit = skin_limit(body.skin.rest, body.embedding);
}

Positions skin_places(const DrawnBody& drawn, const TetMesh& mesh, const Positions& now, Threads* threads) {
  const bool carried = drawn.vertex_of.empty();
  const Embedding& embedding = drawn.embedding;
  const bool subdivided = drawn.weights.rows() > 0;
  const Eigen::Index count = carried      ? embedding.points()
                             : subdivided ? drawn.weights.rows()
                                          : Eigen::Index(drawn.vertex_of.size());
  Positions result(count, 3);
  const std::vector<Mat3> frames = carried ? frames_at(embedding.frames, now, threads) : std::vector<Mat3>();
  constexpr Eigen::Index chunk = 4096;
  run_chunks(threads, static_cast<int>((count + chunk - 1) / chunk), 12 * count, [&](int number) {
    const Eigen::Index end = std::min(count, (number + 1) * chunk);
    for (Eigen::Index v = number * chunk; v < end; ++v)
      result.row(v) = carried      ? embedded_point(embedding, v, now, frames)
                      : subdivided ? smooth_place(drawn.weights, v, now)
                                   : Vec3(now.row(drawn.vertex_of[v]));
  });
  const double stretch = drawn.limit ? drawn.limit->largest_stretch(result) : 0;
  if (stretch > most_skin_stretch) {
    const double most = most_skin_stretch * std::max(1.0, largest_element_stretch(mesh, now));
    if (stretch > most) drawn.limit->apply(most, result);
  }
  return result;
}

std::vector<float> skin_positions(const DrawnBody& drawn, const TetMesh& mesh, const Positions& now, Threads* threads) {
  return as_floats(skin_places(drawn, mesh, now, threads));
}

std::optional<double> skin_excess(const DrawnBody& drawn, const std::vector<float>& skin, const TetMesh& mesh,
                                  const Positions& now) {
  if (!drawn.vertex_of.empty()) return std::nullopt;
  constexpr double unremarkable = 1.5;
  constexpr double shortest = 1e-4;  // shorter edges do not count, over the body's size: the positions are floats
  const Positions at = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(
                           skin.data(), Eigen::Index(skin.size() / 3), 3)
                           .cast<double>();
  // Nearly always no edge of any length is stretched so much, which is quicker to tell.
  if (drawn.limit && drawn.limit->largest_stretch(at) <= unremarkable) return std::nullopt;
  const StretchedEdge most = most_stretched_edge(drawn.skin.rest, at, shortest * bounds_of(mesh.rest).diagonal());
  if (most.factor <= unremarkable) return std::nullopt;
  return most.factor / std::max(1.0, largest_element_stretch(mesh, now));
}

}  // namespace supple
