#include "film/draw_scene.h"

#include "render/view.h"

namespace supple {

namespace {

constexpr double collider_gloss = 0.35;

Vec3 collider_color(const ColliderDef& def) {
  const bool painted = !def.shape.paint.empty() || def.shape.color != Shape{}.color;
  return def.color.value_or(painted ? def.shape.color : Vec3(0.56, 0.64, 0.71));
}

// The part of a drawn mesh that follows from its skin, for bodies and colliders alike.
DrawMesh mesh_of(const Skin& skin, const std::vector<PaintLayer>& layers) {
  DrawMesh mesh;
  mesh.triangles.assign(skin.rest.triangles.data(), skin.rest.triangles.data() + skin.rest.triangles.size());
  mesh.occlusion = skin.occlusion;
  mesh.paint = skin.paint;
  mesh.square = skin.square;
  for (const PaintLayer& layer : layers) mesh.layers.push_back({layer.color, layer.gloss, layer.soft});
  return mesh;
}

std::vector<float> as_floats(const Positions& points) {
  std::vector<float> result(points.size());
  for (Eigen::Index i = 0; i < points.size(); ++i) result[i] = static_cast<float>(points.data()[i]);
  return result;
}

Positions at_pose(const Positions& points, const Eigen::Isometry3d& pose) {
  return (points * pose.linear().transpose()).rowwise() + pose.translation().transpose();
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

std::vector<Skin> collider_skins(const std::vector<Obstacle>& obstacles, const std::vector<Body>& bodies) {
  std::vector<Skin> skins;
  for (const Obstacle& obstacle : obstacles) skins.push_back(drawn_obstacle(obstacle, bounds_at_rest(bodies)));
  return skins;
}

void add_colliders(const std::vector<Obstacle>& obstacles, const std::vector<Skin>& skins, double time,
                   DrawList& list) {
  for (std::size_t c = 0; c < obstacles.size(); ++c)
    list.positions.push_back(as_floats(at_pose(skins[c].rest.points, obstacles[c].pose(time))));
}

DrawMesh collider_mesh(const Obstacle& obstacle, const Skin& skin) {
  DrawMesh mesh = mesh_of(skin, obstacle.def.shape.paint);
  mesh.color = collider_color(obstacle.def);
  mesh.gloss = collider_gloss;
  mesh.rest = bounds_of(at_pose(skin.rest.points, obstacle.pose(0)));
  mesh.framed = skin.rest.points.rows() > 0 && obstacle.def.shape.bounds().diagonal() < 1e6;
  return mesh;
}

Stage make_stage(const SceneDef& scene, const std::vector<Body>& bodies, const std::vector<DrawnBody>& drawn,
                 const std::vector<Obstacle>& obstacles, const std::vector<Skin>& skins, const std::string& font) {
  Stage stage;
  stage.width = scene.output.width;
  stage.height = scene.output.height;
  stage.samples = scene.output.samples;
  stage.ground = scene.look.ground;
  stage.background = scene.look.background;
  stage.exposure = scene.look.exposure;
  if (scene.look.show_labels) stage.font = font;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Skin& skin = drawn[b].skin;
    DrawMesh mesh = mesh_of(skin, drawn[b].layers);
    mesh.label = bodies[b].def.label;
    mesh.printed = bodies[b].def.pattern == Pattern::checks ? Printed::checks : Printed::grid;
    mesh.two_sided = drawn[b].two_sided;
    mesh.color = drawn[b].color;
    mesh.rest = bounds_of(bodies[b].description.mesh.rest);
    stage.meshes.push_back(std::move(mesh));
  }
  for (std::size_t c = 0; c < obstacles.size(); ++c) stage.meshes.push_back(collider_mesh(obstacles[c], skins[c]));
  return stage;
}

Camera make_camera(const SceneDef& scene, const Stage& stage) {
  Bounds box;
  for (const DrawMesh& mesh : stage.meshes) {
    if (!mesh.framed) continue;
    box.include(mesh.rest.lower);
    box.include(mesh.rest.upper);
  }
  Camera camera =
      framing(box, scene.camera.fov_deg, scene.camera.margin, static_cast<double>(stage.width) / stage.height);
  if (scene.camera.target) camera.target = *scene.camera.target;
  if (scene.camera.position) camera.eye = *scene.camera.position;
  return camera;
}

std::vector<float> skin_positions(const DrawnBody& drawn, const Model& model, const State& state) {
  const Positions mesh = in_input_order(model, state.x);
  Positions points;
  if (drawn.vertex_of.empty()) {
    apply(drawn.embedding, mesh, points);
  } else {
    points.resize(drawn.vertex_of.size(), 3);
    for (std::size_t v = 0; v < drawn.vertex_of.size(); ++v) points.row(v) = mesh.row(drawn.vertex_of[v]);
  }
  return as_floats(points);
}

}  // namespace supple
