#include <fmt/core.h>

#include "app/summary.h"
#include "app/verbs.h"
#include "base/console.h"
#include "base/error.h"
#include "base/timing.h"
#include "film/places.h"
#include "film/progress.h"
#include "geometry/mesh_file.h"
#include "geometry/tetrahedralize.h"
#include "scene/shape_reader.h"

namespace supple {
namespace {

std::filesystem::path shape_file(const std::string& name) {
  std::error_code error;
  if (std::filesystem::exists(name, error)) return name;
  const std::filesystem::path shipped = assets_folder() / "shapes" / (name + ".toml");
  return std::filesystem::exists(shipped, error) ? shipped : std::filesystem::path(name);
}

int make_mesh(const std::string& input, const std::string& output, int vertices) {
  const Stopwatch watch;
  const std::filesystem::path path = shape_file(input);
  TetMesh mesh;
  MakingLine line(false);
  const auto heard = [&](int attempt, double share) {
    line.show(fmt::format("meshing {}: attempt {}, {:.0f} %", path.string(), attempt, 100 * share));
  };
  if (path.extension() == ".mesh") {
    MeshFile file = read_mesh(path);
    for (const std::string& note : file.notes) say(stdout, fmt::format("note: {}\n", note));
    mesh = std::move(file.mesh);
  } else if (path.extension() == ".toml") {
    mesh = tetrahedralize(load_shape(path, assets_folder()), vertices, path.string(), heard);
  } else {
    const Shape shape = load_surface(path);
    for (const std::string& note : shape.notes) say(stdout, fmt::format("note: {}\n", note));
    mesh = tetrahedralize(shape, vertices, path.string(), heard);
  }
  line.end();
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
  };
  auto options = std::make_shared<MeshOptions>();
  Verb verb = line.verb("mesh", "Make tetrahedra of a shape or a closed surface, or check and rewrite a mesh.");
  verb.footer("Example: supple mesh squirrel -o squirrel.mesh --vertices 8395");
  verb.option("SHAPE", options->input,
              "shape file (.toml), the name of a shape that ships, a closed surface (OBJ, PLY, STL, glTF, OFF), "
              "or a .mesh file")
      .required();
  verb.option("-o,--output", options->output, "MEDIT .mesh file to write").required();
  verb.option("--vertices", options->vertices, "wanted (within 3 %)").between(50, 500000);
  verb.runs([options] { return make_mesh(options->input, options->output, options->vertices); });
}

}  // namespace supple
