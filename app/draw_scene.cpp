#include "app/draw_scene.h"

#include "render/view.h"

namespace supple {

Stage make_stage(const SceneDef& scene, const std::vector<Body>& bodies, const std::vector<DrawnBody>& drawn,
                 const std::string& font) {
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
    DrawMesh mesh;
    mesh.label = bodies[b].def.label;
    mesh.triangles.assign(skin.rest.triangles.data(), skin.rest.triangles.data() + skin.rest.triangles.size());
    mesh.occlusion = skin.occlusion;
    mesh.paint = skin.paint;
    mesh.square = skin.square;
    mesh.printed = bodies[b].def.pattern == Pattern::checks ? Printed::checks : Printed::grid;
    mesh.two_sided = drawn[b].two_sided;
    mesh.color = drawn[b].color;
    for (const PaintLayer& layer : drawn[b].layers) mesh.layers.push_back({layer.color, layer.gloss, layer.soft});
    mesh.rest = bounds_of(bodies[b].description.mesh.rest);
    stage.meshes.push_back(std::move(mesh));
  }
  return stage;
}

Camera make_camera(const SceneDef& scene, const Stage& stage) {
  Bounds box;
  for (const DrawMesh& mesh : stage.meshes) {
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
  std::vector<float> result(points.size());
  for (Eigen::Index i = 0; i < points.size(); ++i) result[i] = static_cast<float>(points.data()[i]);
  return result;
}

}  // namespace supple
