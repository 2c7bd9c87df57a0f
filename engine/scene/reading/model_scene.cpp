#include "scene/reading/model_scene.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "base/read_file.h"
#include "geometry/files/mesh_file.h"
#include "geometry/tetrahedra/meshing.h"
#include "scene/reading/body_pieces.h"
#include "scene/reading/sagging.h"
#include "scene/reading/upright.h"

namespace supple {
namespace {

// The endings of surfaces that are often met; assimp reads more of them, in scenes that name them.
constexpr std::array surface_endings = {".obj", ".ply", ".stl", ".off",   ".gltf", ".glb",
                                        ".dae", ".3ds", ".fbx", ".blend", ".3mf",  ".x3d"};

std::string ending_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return ending;
}

// Writes a name as a basic string of TOML.
std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"' || c == '\\') text += '\\';
    text += static_cast<unsigned char>(c) < 0x20 ? fmt::format("\\u{:04x}", int(c)) : std::string(1, c);
  }
  return text + "\"";
}

constexpr double model_density = 1000, model_poisson = 0.4;
constexpr double wanted_sag = 0.05;  // over the height
constexpr double fall = 0.1;         // over the model's height
constexpr double frames_a_second = 30;
constexpr int coarse_vertices = 800, film_vertices = 4000;  // a solid has as many where a scene says nothing

// Holds what is known of a model once it has been read and stood up.
struct StandingModel {
  TetMesh mesh;   // coarse, as large as in the film
  double height;  // height of the whole model [m]
  double sole;    // share of the height: what is as low as this stands on the ground
  Upright upright;
  double young = 0;  // [Pa]

  Sagging sagging() const { return {model_density, model_poisson, wanted_sag, sole}; }
};

// Turns points so that this axis points up.
Positions turned_up(const Positions& points, UpAxis up) {
  SurfaceOptions options;
  options.up = up;
  return set_up({points, {}}, options).points;
}

Upright upright_of(const ModelWish& wish, const std::filesystem::path& file, const TriMesh& surface) {
  return wish.up ? Upright{*wish.up, ""} : guess_upright(file, surface);
}

StandingModel standing_surface(const std::filesystem::path& file, const ModelWish& wish) {
  BodyDef def;
  def.surface = file;
  BodySurface read = read_body_surface(def);
  StandingModel model{{}, 0, 0, upright_of(wish, file, read.pieces.front().boundary), 0};
  if (model.upright.up != UpAxis::y) {
    def.surface_options.up = model.upright.up;
    read = read_body_surface(def);
  }
  const double scale = wish.size / read.box.extent().maxCoeff();
  model.height = scale * read.box.extent().y();
  model.sole = steady_sole(read.pieces.front().boundary);
  const auto mesh_of = [&](int vertices) {
    TetMesh mesh = mesh_of_surface({read.pieces.front(), read.touching}, {vertices, file.string(), ""}, {}).mesh;
    mesh.rest *= scale;
    return mesh;
  };
  model.mesh = mesh_of(film_vertices);  // first, so that what cannot be meshed is refused in the film's own words
  double guess = 0;
  try {
    // Coarse elements are much thicker than thin legs. What they give is no more than a first guess.
    guess = young_for_sag(mesh_of(coarse_vertices), model.sagging(), guess);
  } catch (const InputError&) {
    // The surface is too fine for coarse elements; the search goes without a guess.
  }
  model.young = young_for_sag(model.mesh, model.sagging(), guess);
  model.young = young_for_fall(model.mesh, model.sagging(), model.young, fall * model.height);
  return model;
}

StandingModel standing_mesh(const std::filesystem::path& file, const ModelWish& wish) {
  StandingModel model{read_mesh(file).mesh, 0, 0, {}, 0};
  const TriMesh boundary{model.mesh.rest, boundary_faces(model.mesh.tets)};
  model.upright = guess_upright(file, boundary);
  model.mesh.rest = turned_up(model.mesh.rest, model.upright.up);
  const Vec3 extent = bounds_of(model.mesh.rest).extent();
  model.mesh.rest *= wish.size / extent.maxCoeff();
  model.height = wish.size / extent.maxCoeff() * extent.y();
  model.sole = steady_sole({model.mesh.rest, boundary.triangles});
  model.young =
      young_for_fall(model.mesh, model.sagging(), young_for_sag(model.mesh, model.sagging()), fall * model.height);
  return model;
}

// Returns the keys that turn a body so that this axis points up.
std::string turning_keys(UpAxis up, bool is_mesh) {
  if (up == UpAxis::y) return "";
  if (!is_mesh) return fmt::format("up = \"{}\"\n", name_of(up));
  return up == UpAxis::z ? "turn_deg = [-90, 0, 0]\n" : "turn_deg = [0, 0, 90]\n";
}

// Returns a number with two digits, as people would choose it.
double rounded(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1);
  return unit * std::round(value / unit);
}

// Returns the keys of a fall from a height: what is held falls freely, frame by frame, and stops.
std::string falling_keys(double height) {
  std::string keys = "{ t = 0 }";
  for (int frame = 1; frame < 100; ++frame) {
    const double time = frame / frames_a_second, way = std::min(height, 0.5 * standard_gravity * time * time);
    keys += fmt::format(", {{ t = {:.4f}, move = [0, {:.4f}, 0] }}", time, -way);
    if (way >= height) break;
  }
  return keys;
}

}  // namespace

bool is_model(const std::filesystem::path& path) {
  const std::string ending = ending_of(path);
  return is_mesh_file(path) ||
         std::find(surface_endings.begin(), surface_endings.end(), ending) != surface_endings.end();
}

std::vector<std::string> ModelScene::notes_with(const std::vector<std::string>& settings) const {
  // Tells whether a setting gives a value of a table or of a key in it.
  const auto replaces = [](const std::string& setting, const std::string& key) {
    const std::string path = setting.substr(0, setting.find('='));
    return path == key || path.starts_with(key + ".") || key.starts_with(path + ".");
  };
  std::vector<std::string> lines;
  for (const Note& note : notes) {
    const bool is_replaced = std::ranges::any_of(settings, [&](const std::string& setting) {
      return std::ranges::any_of(note.about, [&](const std::string& key) { return replaces(setting, key); });
    });
    if (!is_replaced) lines.push_back(note.text);
  }
  return lines;
}

ModelWish wish_of(const std::vector<std::string>& settings) {
  Config asked = Config::parse("[[body]]\nname = \"model\"\n", "settings", {});
  for (const std::string& setting : settings)
    if (setting.starts_with("body.model.up=") || setting.starts_with("body.model.size=")) asked.set(setting, {});
  ModelWish wish;
  const ConfigTable model = asked.root().tables({"body", "", ""}).front();
  wish.size = model.number_if_given({"size", "m", ""}, Range::above(0, 1e6)).value_or(wish.size);
  if (model.has("up")) wish.up = model.word<UpAxis>({"up", "", ""}, UpAxis::y);
  const bool is_wrong = !asked.complaints().empty();  // which the scene's own reader says
  return is_wrong ? ModelWish() : wish;
}

ModelScene model_scene(const std::filesystem::path& model, const ModelWish& wish) {
  check_regular_file(model);
  const bool is_mesh = is_mesh_file(model);
  const StandingModel standing = is_mesh ? standing_mesh(model, wish) : standing_surface(model, wish);
  const double young = rounded(standing.young);
  const double above = rounded(fall * standing.height);
  const std::string file = quoted(model.filename().string());
  ModelScene scene;
  scene.text = fmt::format(
      "title = {}\nframes = 90\nfps = {:g}\n[[body]]\nname = \"model\"\n{} = {}\n{}size = {:g}\n"
      "position = [0, {:g}, 0]\nmaterial = {{ model = \"neo-hookean\", young = {:g}, poisson = {:g} }}\n"
      "density = {:g}\ncontact = {{ skin = true }}\nmeant = [\"handle\"]\n[[body.handles]]\nname = \"feet\"\n"
      "select = {{ box = [[0, 0, 0], [1, {:g}, 1]] }}\nease = \"linear\"\nkeys = [{}]\n"
      "[[collider]]\nname = \"ground\"\nshape = {{ half_space = {{ normal = [0, 1, 0] }} }}\nfriction = 0.8\n"
      "[camera]\nframes = \"film\"\n[look]\nlabels = false\nsupports = false\n",
      file, frames_a_second, is_mesh ? "mesh" : "surface", file, turning_keys(standing.upright.up, is_mesh), wish.size,
      above, young, model_poisson, model_density, standing.sole, falling_keys(above));
  if (!standing.upright.reason.empty()) {
    scene.notes.push_back(
        {fmt::format("its {} axis is taken to point up, because {}; --set body.model.{} says otherwise",
                     name_of(standing.upright.up), standing.upright.reason, is_mesh ? "turn_deg" : "up"),
         {"body.model.turn_deg"}});
  }
  scene.notes.push_back(
      {fmt::format("it is made {:g} m long, and falls {:g} m", wish.size, above), {"body.model.position"}});
  scene.notes.push_back({fmt::format("it sags by at most some 5 % of its height with young = {:g} Pa; --set "
                                     "body.model.material.young softens or stiffens it",
                                     young),
                         {"body.model.material", "body.model.turn_deg", "body.model.density", "gravity"}});
  scene.notes.push_back({fmt::format("its lowest {:g} % stay where they land, so that it stands; --set "
                                     "body.model.handles=[] lets it topple",
                                     100 * standing.sole),
                         {"body.model.handles"}});
  return scene;
}

Config load_document(const SceneSource& source, const std::filesystem::path& assets) {
  const std::filesystem::path& path = source.path;
  if (source.text) return Config::parse_beside(*source.text, path, assets);
  if (!is_model(path)) return Config::load(path, assets);
  return Config::parse_beside(model_scene(path).text, path, assets);
}

}  // namespace supple
