#include "scene/reading/scene_reader.h"

#include <algorithm>
#include <set>

#include "base/text.h"
#include "scene/reading/body_pieces.h"
#include "scene/reading/meeting_check.h"
#include "scene/reading/model_scene.h"
#include "scene/reading/picture_size.h"
#include "scene/reading/scatter.h"
#include "scene/reading/sweep.h"
#include "scene/reading/table_readers.h"

namespace supple {

const std::vector<std::set<std::string>>& exclusive_keys() {
  static const std::vector<std::set<std::string>> groups = {{"shape", "surface", "mesh", "box", "cloth"},
                                                            {"density", "total_mass"},
                                                            {"position", "azimuth"},
                                                            {"position", "elevation"},
                                                            {"position", "distance"},
                                                            {"position", "orbit"},
                                                            {"target", "follow"}};
  return groups;
}

namespace {

// Reads `size`, which replaces width and height. The aspect for which the camera was placed remains that of the
// replaced ones.
void read_size(const ConfigTable& table, OutputDef& output) {
  const std::string text = table.text({"size", "",
                                       "portrait, square, 720p, 1080p, 4k or WIDTHxHEIGHT, over width and height: a "
                                       "camera that the scene places keeps in "
                                       "the picture what it has there at width and height"},
                                      "");
  if (text.empty()) return;
  const std::optional<PictureSize> size = picture_size(text);
  if (!size) return table.complain("size", fmt::format("size: '{}' is none of {}", text, picture_size_words()));
  output.aspect = static_cast<double>(output.width) / output.height;
  output.width = size->width;
  output.height = size->height;
}

// Refuses handles that are attached to what is not there, or to the body that they hold.
void check_attached(const SceneDef& scene, Config& config, const std::set<std::string>& bodies,
                    const std::set<std::string>& colliders) {
  for (const BodyDef& body : scene.bodies) {
    for (const HandleDef& handle : body.handles) {
      if (!handle.attach) continue;
      const bool to_body = handle.attach->collider.empty();
      const std::string& name = to_body ? handle.attach->body : handle.attach->collider;
      const std::set<std::string>& all = to_body ? bodies : colliders;
      if (to_body && name == body.name)
        config.complain({handle.attach->place, fmt::format("attach: body '{}' cannot hold itself", name)});
      else if (!name.empty() && !all.contains(name))
        config.complain(
            {handle.attach->place, fmt::format("attach: no {} is called '{}'{}", to_body ? "body" : "collider", name,
                                               did_you_mean(name, std::vector<std::string>(all.begin(), all.end())))});
    }
  }
}

// Reads frames a second: a number, or a fraction in words.
FrameRate read_rate(const ConfigTable& root, const FrameRate& usual) {
  const Range range = Range::between(1, 100000);
  const auto given = root.text_or_number_if_given(
      {"fps", "1/s", "frames a second; 23.976, 29.97 and 59.94 mean 24000/1001, 30000/1001 and 60000/1001"},
      "a fraction such as \"30000/1001\"", range, "30");
  if (!given) return usual;
  if (const double* number = std::get_if<double>(&*given)) return *number;
  const auto& text = std::get<std::string>(*given);
  const std::optional<FrameRate> rate = FrameRate::parse(text);
  if (rate && range.contains(*rate)) return *rate;
  root.complain("fps", fmt::format("fps: '{}' must be a number or a fraction of two whole numbers, such as "
                                   "\"30000/1001\", of {}",
                                   text, range.text()));
  return usual;
}

// Holds the names of a kind of tables, each of which may be given once.
class GivenNames {
 public:
  explicit GivenNames(std::string kind) : kind_(std::move(kind)) {}

  // Complains in the table where another one has the name.
  void add(const ConfigTable& table, const std::string& name) {
    if (!names_.insert(name).second) table.complain("name", fmt::format("two {} named '{}'", kind_, name));
  }
  const std::set<std::string>& all() const { return names_; }

 private:
  std::string kind_;
  std::set<std::string> names_;
};

// Reads how long the film is, and what holds for all that is in it.
void read_film(const ConfigTable& root, SceneDef& scene) {
  scene.title = root.text({"title", "", "for people; pictures show it where `text.title` asks for it"}, "");
  scene.frames = root.integer({"frames", "", "length of the film"}, scene.frames, Range::between(1, 1000000));
  scene.fps = read_rate(root, scene.fps);
  scene.substeps =
      root.integer({"substeps", "", "steps a frame: h = 1 / (fps substeps)"}, scene.substeps, Range::between(1, 1000));
  scene.gravity = root.vector({"gravity", "m/s^2", "acceleration of free fall"}, scene.gravity);
  scene.seed = static_cast<std::uint64_t>(
      root.integer({"seed", "", "of random start states and of gusts"}, 1, Range::between(0, 2e9)));
  scene.from = read_from(root, scene.fps);
  scene.wind = read_wind(root, scene.seed);
}

// Reads the bodies, with the copies that are scattered and those of several pieces.
void read_bodies(Config& config, const ConfigTable& root, SceneDef& scene, GivenNames& names) {
  SolverDef defaults;
  if (const auto solver = root.table({"solver", "", "for all bodies"})) defaults = read_solver(*solver, defaults);
  const std::vector<Scattering> scatterings = read_scatterings(root, scene.seed);
  std::vector<std::string> tables;
  for (const ConfigTable& table : root.tables({"body", "", "what moves"})) {
    BodyDef read = read_body(table, defaults);
    tables.push_back(read.name);
    for (BodyDef& copy : copies_of(scatterings, table, std::move(read))) {
      for (BodyDef& body : bodies_of(table, std::move(copy))) {
        names.add(table, body.name);
        scene.bodies.push_back(std::move(body));
      }
    }
  }
  check_scattered(root, scatterings, tables);
  check_meetings(scene, config);
  // The only body of a file that gives it no name needs no caption, nor do its pieces and copies.
  const std::vector<ConfigTable> given = root.tables({"body", "", "what moves"});
  if (given.size() == 1 && !given.front().has("name") && !given.front().has("label")) {
    for (BodyDef& body : scene.bodies) body.label.clear();
  }
}

void read_colliders(const ConfigTable& root, SceneDef& scene, GivenNames& names) {
  for (const ConfigTable& table :
       root.tables({"collider", "", "what is in the way of bodies: rigid, unless a motion deforms it"})) {
    scene.colliders.push_back(read_collider(table));
    names.add(table, scene.colliders.back().name);
  }
}

// Reads the camera, which may name what the scene has.
void read_view(const ConfigTable& root, const std::set<std::string>& bodies, const std::set<std::string>& colliders,
               SceneDef& scene) {
  const auto camera = root.table({"camera", "", "where the film is seen from"});
  if (!camera) return;
  scene.camera = read_camera(*camera, scene.camera);
  std::vector<std::string> all(bodies.begin(), bodies.end());
  all.insert(all.end(), colliders.begin(), colliders.end());
  for (const auto& [key, name] : {std::pair{"follow", scene.camera.follow}, {"focus", scene.camera.focus_on}}) {
    if (name.empty() || bodies.contains(name) || colliders.contains(name)) continue;
    camera->complain(key, fmt::format("{}: no body or collider is called '{}'{}", key, name, did_you_mean(name, all)));
  }
}

void read_output(const ConfigTable& root, OutputDef& output) {
  const auto table = root.table({"output", "", "the pictures"});
  if (!table) return;
  output.width =
      table->integer({"width", "pixels", "even, for the film's encoder"}, output.width, Range::between(16, 8192));
  output.height =
      table->integer({"height", "pixels", "even, for the film's encoder"}, output.height, Range::between(16, 8192));
  read_size(*table, output);
  if (output.width % 2 != 0) table->complain("width", "width: must be even");
  if (output.height % 2 != 0) table->complain("height", "height: must be even");
  output.samples = table->integer({"samples", "", "antialiasing samples a pixel: 1, 2, 4 or 8"}, output.samples,
                                  Range::between(1, 8));
  if ((output.samples & (output.samples - 1)) != 0) table->complain("samples", "samples: must be 1, 2, 4 or 8");
  output.blur_samples = table->integer({"blur_samples", "",
                                        "pictures of which one is the mean where camera.shutter or aperture "
                                        "blur it; 0: 16 to 128, as the blur asks for"},
                                       output.blur_samples, Range::between(0, 8192));
  output.energy = table->boolean(
      {"energy", "", "kinetic, elastic and gravitational energy of each body, each frame, in profile.json"}, false);
  output.passes = table->words<PicturePass>(
      {"passes", "", "pictures in numbers beside those of the film, for compositors: passes/NAME/NNNNNN.exr"});
  std::ranges::sort(output.passes);
  output.passes.erase(std::unique(output.passes.begin(), output.passes.end()), output.passes.end());
}

}  // namespace

SceneDef read_scene(Config& config) {
  SceneDef scene;
  scene.assets = config.assets();
  scene.name = std::filesystem::path(config.name()).stem().string();
  const ConfigTable root = config.root();
  (void)root.integer({"version", "", "of this format"}, 1, Range::between(1, 1));
  read_film(root, scene);
  GivenNames bodies("bodies"), colliders("colliders");
  read_bodies(config, root, scene, bodies);
  read_colliders(root, scene, colliders);
  if (scene.bodies.empty()) root.complain("a scene needs at least one [[body]]");
  check_attached(scene, config, bodies.all(), colliders.all());
  read_view(root, bodies.all(), colliders.all(), scene);
  scene.look = read_look(root, scene.look);
  scene.field = read_field(root);
  scene.text = read_text(root);
  read_output(root, scene.output);
  scene.sweep_points = read_sweep(root).points();
  return scene;
}

SceneDef load_scene(const std::filesystem::path& path, const std::filesystem::path& assets,
                    const std::vector<std::string>& settings, std::string* resolved_json) {
  Config config = load_document(path, assets);
  if (config.root().has("scene"))
    throw InputError(path.string(), "is a replay of a scene, not a scene: supple replay runs it");
  for (const std::string& setting : settings) config.set(setting, exclusive_keys());
  SceneDef scene = read_scene(config);
  config.finish();
  if (resolved_json != nullptr) *resolved_json = config.as_json();
  return scene;
}

}  // namespace supple
