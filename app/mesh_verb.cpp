#include <fmt/core.h>

#include "app/summary.h"
#include "app/verbs.h"
#include "base/console.h"
#include "base/error.h"
#include "base/near_files.h"
#include "base/text.h"
#include "base/timing.h"
#include "film/plan/shipped_files.h"
#include "film/plan/slow_work_line.h"
#include "geometry/files/mesh_file.h"
#include "scene/building/unplaced_body.h"
#include "scene/definition/scene_def.h"
#include "scene/reading/model_scene.h"

namespace supple {
namespace {

std::filesystem::path shape_file(const std::string& name) {
  std::error_code error;
  if (std::filesystem::exists(name, error)) return name;
  const std::filesystem::path shipped = assets_folder() / "shapes" / (name + ".toml");
  if (std::filesystem::exists(shipped, error)) return shipped;
  const auto is_shape = [](const std::filesystem::path& file) { return file.extension() == ".toml" || is_model(file); };
  throw InputError(name, "no such file" + meant_file(near_file(name, is_shape, shipped_names("shapes"))));
}

int make_mesh(const std::string& input, const std::string& output, int vertices, const SurfaceOptions& options) {
  const Stopwatch watch;
  check_writable(output);
  const std::filesystem::path path = shape_file(input);
  TetMesh mesh;
  std::vector<std::string> notes;
  SlowWorkLine line(false);
  if (is_mesh_file(path)) {
    MeshFile file = read_mesh(path);
    mesh = std::move(file.mesh);
    notes = std::move(file.notes);
  } else {
    SceneDef scene;
    scene.assets = assets_folder();
    BodyDef body;
    body.vertices = vertices;
    body.surface_options = options;
    body.pieces = Pieces::largest;
    (path.extension() == ".toml" ? body.shape : body.surface) = path;
    UnplacedBodies unplaced({{}, [&](const std::string& what) { line.show(what); }});
    Body made = unplaced.get(scene, body);
    mesh = std::move(made.description.mesh);
    notes = std::move(made.notes);
  }
  line.end();
  for (const std::string& note : notes) say(stdout, fmt::format("note: {}\n", note));
  write_mesh(output, mesh);
  say(stdout, mesh_summary(mesh));
  say(stdout, fmt::format("written         {} ({:.2f} s)\n", output, watch.elapsed_ms() / 1000));
  return 0;
}

}  // namespace

void add_mesh(CommandLine& line) {
  struct MeshOptions {
    std::string input, output;
    int vertices = 4000;
    SurfaceOptions surface;
    std::optional<double> thickness;
  };
  auto options = std::make_shared<MeshOptions>();
  Verb verb = line.verb("mesh", "Make tetrahedra of a shape or a surface, or check and rewrite a mesh.");
  verb.footer("Example: supple mesh squirrel -o squirrel.mesh --vertices 8395");
  verb.option(
          "SHAPE", options->input,
          "shape file (.toml), the name of a shape that ships, a surface (OBJ, PLY, STL, glTF, OFF), or a mesh (as -o)")
      .required();
  verb.option("-o,--output", options->output, fmt::format("mesh to write: {}", mesh_formats)).required();
  verb.option("--vertices", options->vertices, "wanted (within 3 %; up to 50 % where parts are thin)")
      .between(50, 500000);
  SurfaceOptions& surface = options->surface;
  verb.option(
          "--close", [&surface](const std::string& word) { surface.close = *value_named<Closing>(word); },
          "what makes a solid of a surface that is not closed: " + word_list(all_names<Closing>()))
      .one_of(all_names<Closing>());
  verb.option("--thicken", options->thickness, "thickness of parts with a rim, in the file's units").between(0.0, 1e6);
  verb.runs([options] {
    options->surface.thickness = options->thickness.value_or(0);
    return make_mesh(options->input, options->output, options->vertices, options->surface);
  });
}

}  // namespace supple
