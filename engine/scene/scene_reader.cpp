#include "scene/scene_reader.h"

#include <algorithm>
#include <set>

namespace supple {
namespace {

template <std::size_t... I>
std::vector<std::string> material_names(std::index_sequence<I...>) {
  return {std::string(std::variant_alternative_t<I, Material>::name)...};
}

const std::vector<std::string>& material_names() {
  static const std::vector<std::string> names =
      material_names(std::make_index_sequence<std::variant_size_v<Material>>());
  return names;
}

template <class M>
bool read_parameters(const ConfigTable& table, std::string_view model, Material& material) {
  if (M::name != model) return false;
  M read;
  for (const auto& p : M::parameters()) {
    read.*p.value = table.number({p.name, p.unit, p.meaning}, p.may_be_zero ? std::optional<double>(0.0) : std::nullopt,
                                 p.may_be_zero ? Range::at_least(0) : Range::positive());
  }
  material = read;
  return true;
}

template <std::size_t... I>
Material material_of(const ConfigTable& table, std::string_view model, std::index_sequence<I...>) {
  Material material;
  (void)(read_parameters<std::variant_alternative_t<I, Material>>(table, model, material) || ...);
  return material;
}

Material read_material(const ConfigTable& owner) {
  const auto table = owner.table({"material", "", "what the body is made of"}, "required");
  if (!table) {
    if (!owner.has("material"))
      owner.complain("'material' is missing: such as material = { model = \"neo-hookean\", mu = 1e5, lambda = 4e5 }");
    return Polynomial{1};
  }
  const std::string model = table->choice({"model", "", "the energy"}, std::nullopt, material_names());
  return material_of(*table, model, std::make_index_sequence<std::variant_size_v<Material>>());
}

SolverSettings read_solver(const ConfigTable& table, SolverSettings s, StretchInterval& fit, Precision& precision) {
  (void)table.choice({"method", "", "how a step is solved"}, "quasi-newton", {"quasi-newton"});
  s.iterations = table.integer({"iterations", "", "quasi-Newton iterations a step, at most"}, s.iterations,
                               Range::between(1, 10000));
  s.history =
      table.integer({"history", "", "window m of L-BFGS; 0 is plain quasi-Newton"}, s.history, Range::between(0, 100));
  const std::string search =
      table.choice({"line_search", "", "how a step length is accepted; none takes every full step"},
                   s.line_search == LineSearch::armijo ? "armijo" : "none", {"armijo", "none"});
  s.line_search = search == "armijo" ? LineSearch::armijo : LineSearch::none;
  s.armijo = table.number({"armijo", "", "gamma of the sufficient decrease"}, s.armijo, Range::above(0, 0.5));
  s.target_error =
      table.number({"target_error", "", "stop once the solver's own error estimate is below; 0 does all iterations"},
                   s.target_error, Range::between(0, 1));
  const Vec3 interval = {fit.start, fit.end, 0};
  fit.start = table.number({"fit_from", "", "start of the stretch interval of equation 11"}, interval.x(),
                           Range::between(0.01, 0.999));
  fit.end = table.number({"fit_to", "", "end of the stretch interval of equation 11"}, interval.y(),
                         Range::between(1.001, 10));
  const std::string digits = table.choice(
      {"factor", "", "precision of the factor of M/h^2 + L, hence of directions; energies are always double"},
      precision == Precision::single_precision ? "single" : "double", {"single", "double"});
  precision = digits == "single" ? Precision::single_precision : Precision::double_precision;
  return s;
}

Selection read_selection(const ConfigTable& handle) {
  Selection s;
  s.place = handle.place("select", "");
  const auto table =
      handle.table({"select", "", "which vertices, by exactly one of region, box, sphere, plane"}, "required");
  if (!table) {
    if (!handle.has("select"))
      handle.complain("'select' is missing: such as select = { box = [[0, 0, 0], [1, 0.1, 1]] }");
    return s;
  }
  int given = 0;
  if (table->has("region")) {
    ++given;
    s.kind = Selection::Kind::region;
    s.region = table->text({"region", "", "all vertices of elements with this tag"}, std::nullopt);
  }
  if (table->has("box")) {
    ++given;
    s.kind = Selection::Kind::box;
    const std::vector<Vec3> corners =
        table->vectors({"box", "", "lower and upper corner, relative to the rest bounding box (0 to 1)"}, 2);
    if (corners.size() == 2) {
      s.lower = corners[0];
      s.upper = corners[1];
      if ((s.lower.array() > s.upper.array()).any())
        table->complain("box", "box: the first corner must be the lower one");
    }
  }
  if (const auto sphere = table->table({"sphere", "", "vertices in a ball"})) {
    ++given;
    s.kind = Selection::Kind::sphere;
    s.center = sphere->vector({"center", "", "relative to the rest bounding box (0 to 1)"}, std::nullopt);
    s.radius = sphere->number({"radius", "", "relative to the longest side"}, std::nullopt, Range::positive());
  }
  if (const auto plane = table->table({"plane", "", "vertices on one side of a plane"})) {
    ++given;
    s.kind = Selection::Kind::plane;
    s.center = plane->vector({"point", "", "relative to the rest bounding box (0 to 1)"}, std::nullopt);
    s.normal = plane->vector({"normal", "", "points to the side that is picked"}, std::nullopt);
    if (s.normal.norm() < 1e-9) plane->complain("normal", "normal: must not be zero");
  }
  if (given != 1) table->complain("a selection is one of region, box, sphere or plane");
  return s;
}

HandleDef read_handle(const ConfigTable& table) {
  HandleDef handle;
  handle.name = table.text({"name", "", "addresses the handle in --set and in messages"}, std::nullopt);
  handle.select = read_selection(table);
  handle.spring =
      table
          .number_or_word({"stiffness", "N/m",
                           "of each vertex's spring to its target; hard vertices are eliminated and follow exactly"},
                          "hard", Range::positive())
          .value_or(0);
  handle.ease = table.choice({"ease", "", "how keys are joined"}, "smooth", {"smooth", "linear"}) == "smooth"
                    ? Ease::smooth
                    : Ease::linear;
  double last = -1;
  for (const ConfigTable& row :
       table.tables({"keys", "", "the motion; before the first key and after the last it stands still"})) {
    HandleKey key;
    key.time = row.number({"t", "s", "when"}, std::nullopt, Range::at_least(0));
    key.move = row.vector({"move", "m", "displacement from rest"}, Vec3(0, 0, 0));
    key.turn_deg =
        row.vector({"turn_deg", "degrees", "rotation about the handle's centre: x, then y, then z"}, Vec3(0, 0, 0));
    if (key.time <= last)
      row.complain(
          "t", fmt::format("t = {:g}: keys must stand in order of time (the one before is at {:g})", key.time, last));
    last = key.time;
    handle.keys.push_back(key);
  }
  return handle;
}

struct Defaults {
  SolverSettings solver;
  StretchInterval fit;
  Precision precision = Precision::single_precision;
};

BodyDef read_body(const ConfigTable& table, const Defaults& defaults) {
  BodyDef body;
  body.place = table.place(nullptr, "");
  body.name = table.text({"name", "", "addresses the body in --set and in reports"}, "body");
  if (body.name.empty() || body.name.find_first_of("./\\ \t\n") != std::string::npos) {
    table.complain("name", fmt::format("name = '{}': must be a word without spaces, dots and slashes", body.name));
  }
  body.label = table.text({"label", "", "caption in the film; the default is the name"}, body.name);
  body.shape = table.file({"shape", "", "a shape file, to be meshed here"});
  body.mesh = table.file({"mesh", "", "a tetrahedral mesh (MEDIT .mesh)"});
  if (table.has("shape") + table.has("mesh") != 1) table.complain("a body needs exactly one of 'shape' and 'mesh'");
  body.vertices = table.integer({"vertices", "", "of the tetrahedra made from a shape (within 3 %)"}, 4000,
                                Range::between(50, 500000));
  body.size = table.number_if_given({"size", "m", "longest side; without it the file's units are metres"},
                                    Range::above(0, 1e6));
  body.position = table.vector({"position", "m", "of the middle of the bounding box's bottom"}, Vec3(0, 0, 0));
  body.turn_deg =
      table.vector({"turn_deg", "degrees", "rotation about x, then y, then z, before it is placed"}, Vec3(0, 0, 0));
  body.density =
      table.number_if_given({"density", "kg/m^3", "mass by volume; 1000 without it and total_mass"}, Range::positive());
  body.total_mass = table.number_if_given({"total_mass", "kg", "spread evenly over the volume"}, Range::positive());
  if (body.density && body.total_mass) table.complain("total_mass", "a body has a density or a total_mass, not both");
  body.material = read_material(table);
  if (const auto regions = table.table({"regions", "", "materials of tagged parts, by the name of the tag"})) {
    for (const std::string& name : regions->keys()) {
      const auto region = regions->table({name.c_str(), "", "a tagged part"});
      if (region) body.regions.push_back({name, read_material(*region), regions->place(name.c_str(), "")});
    }
  }
  std::set<std::string> names;
  for (const ConfigTable& row : table.tables({"handles", "", "vertices that follow a motion from outside"})) {
    body.handles.push_back(read_handle(row));
    if (!names.insert(body.handles.back().name).second)
      row.complain("name", fmt::format("two handles named '{}'", body.handles.back().name));
  }
  body.solver = defaults.solver;
  body.fit = defaults.fit;
  body.precision = defaults.precision;
  if (const auto solver = table.table({"solver", "", "this body's own, over the scene's"})) {
    body.solver = read_solver(*solver, body.solver, body.fit, body.precision);
  }
  body.color = table.vector_if_given({"color", "sRGB", "over the shape's own"}, Range::between(0, 1));
  body.skin_cells = table.number({"skin_cells", "", "cells of the drawn skin along the longest side of a shape"}, 72,
                                 Range::between(8, 400));
  return body;
}

}  // namespace

const std::vector<std::set<std::string>>& exclusive_keys() {
  static const std::vector<std::set<std::string>> groups = {{"shape", "mesh"}, {"density", "total_mass"}};
  return groups;
}

SceneDef read_scene(Config& config) {
  SceneDef scene;
  scene.assets = config.assets();
  scene.name = std::filesystem::path(config.name()).stem().string();
  const ConfigTable root = config.root();
  (void)root.integer({"version", "", "of this format"}, 1, Range::between(1, 1));
  scene.title = root.text({"title", "", "for people"}, "");
  scene.frames = root.integer({"frames", "", "length of the film"}, 120, Range::between(1, 1000000));
  scene.fps = root.number({"fps", "1/s", "frames a second"}, 30, Range::between(1, 100000));
  scene.substeps = root.integer({"substeps", "", "steps a frame: h = 1 / (fps substeps)"}, 1, Range::between(1, 1000));
  scene.gravity = root.vector({"gravity", "m/s^2", "acceleration of free fall"}, scene.gravity);
  Defaults defaults;
  if (const auto solver = root.table({"solver", "", "for all bodies"})) {
    defaults.solver = read_solver(*solver, defaults.solver, defaults.fit, defaults.precision);
  }
  std::set<std::string> names;
  for (const ConfigTable& table : root.tables({"body", "", "what moves"})) {
    scene.bodies.push_back(read_body(table, defaults));
    if (!names.insert(scene.bodies.back().name).second)
      table.complain("name", fmt::format("two bodies named '{}'", scene.bodies.back().name));
  }
  if (scene.bodies.empty()) root.complain("a scene needs at least one [[body]]");

  if (const auto camera = root.table({"camera", "", "where the film is seen from"})) {
    scene.camera.position = camera->vector_if_given({"position", "m", "of the eye; without it all bodies are framed"});
    scene.camera.target = camera->vector_if_given({"target", "m", "what the eye looks at"});
    if (scene.camera.position && scene.camera.target && *scene.camera.position == *scene.camera.target) {
      camera->complain("target", "target: must not be the camera's own position");
    }
    scene.camera.fov_deg =
        camera->number({"fov_deg", "degrees", "vertical field of view"}, scene.camera.fov_deg, Range::between(1, 150));
    scene.camera.margin = camera->number({"margin", "", "air around the bodies when they are framed"},
                                         scene.camera.margin, Range::between(0.5, 10));
  }
  if (const auto look = root.table({"look", "", "the stage"})) {
    scene.look.ground =
        look->vector({"ground", "sRGB", "colour of the ground"}, scene.look.ground, Range::between(0, 1));
    scene.look.background = look->vector({"background", "sRGB", "colour that the ground fades into"},
                                         scene.look.background, Range::between(0, 1));
    scene.look.exposure = look->number({"exposure", "", "multiplies the light"}, 1.0, Range::above(0, 100));
    scene.look.show_labels = look->boolean({"labels", "", "captions below the bodies"}, true);
  }
  if (const auto output = root.table({"output", "", "the pictures"})) {
    scene.output.width =
        output->integer({"width", "pixels", "even, for the film's encoder"}, 1280, Range::between(16, 8192));
    scene.output.height =
        output->integer({"height", "pixels", "even, for the film's encoder"}, 720, Range::between(16, 8192));
    if (scene.output.width % 2 != 0) output->complain("width", "width: must be even");
    if (scene.output.height % 2 != 0) output->complain("height", "height: must be even");
    scene.output.samples =
        output->integer({"samples", "", "antialiasing samples a pixel: 1, 2, 4 or 8"}, 4, Range::between(1, 8));
    if ((scene.output.samples & (scene.output.samples - 1)) != 0)
      output->complain("samples", "samples: must be 1, 2, 4 or 8");
  }
  return scene;
}

SceneDef load_scene(const std::filesystem::path& path, const std::filesystem::path& assets,
                    const std::vector<std::string>& settings, std::string* resolved_json) {
  Config config = Config::load(path, assets);
  for (const std::string& setting : settings) config.set(setting, exclusive_keys());
  SceneDef scene = read_scene(config);
  config.finish();
  if (resolved_json != nullptr) *resolved_json = config.as_json();
  return scene;
}

}  // namespace supple
