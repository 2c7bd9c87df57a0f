#include "support/bodies.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <fstream>
#include <sstream>

#include "geometry/meshes/cloth.h"
#include "geometry/tetrahedra/tetrahedralize.h"

namespace supple::test {

std::optional<std::filesystem::path> paper_mesh(const std::string& name) {
  const char* folder = std::getenv("SUPPLE_PAPER_MESHES");
  if (folder != nullptr) {
    const std::filesystem::path path = std::filesystem::path(folder) / (name + ".mesh");
    if (std::filesystem::exists(path)) return path;
  }
  const char* required = std::getenv("SUPPLE_REQUIRE_PAPER");
  if (required != nullptr && std::string(required) == "1")
    ADD_FAILURE() << "the paper's mesh " << name << " is required and missing";
  return std::nullopt;
}

std::vector<Material> all_materials() {
  const Lame lame{1e4, 3e4};
  return {AsRigidAsPossible{1e4},
          Polynomial{4e4},
          Corotated{1e4, 3e4},
          StVenantKirchhoff{1e4, 3e4},
          NeoHookean{1e4, 3e4},
          MooneyRivlin{8e3, 2e3, 2.6e4},
          FixedCorotated{1e4, 3e4},
          StableNeoHookean{1e4, 4e4},
          Spline::preset_a(lame),
          Spline::preset_b(lame),
          StrainLimiting{1e4, 0.9, 1.1, 1e4, 0.7, 1.3}};
}

namespace {
template <std::size_t... I>
std::vector<std::string> names_of(std::index_sequence<I...>) {
  return {std::string(std::variant_alternative_t<I, Material>::name)...};
}
}  // namespace

std::vector<std::string> model_names() { return names_of(std::make_index_sequence<std::variant_size_v<Material>>()); }

BodyDescription bar(const Material& material, Held held, Precision precision, int cells) {
  BodyDescription body;
  body.name = "bar";
  body.mesh = box_mesh(Vec3(0.4, 0.1, 0.1), Eigen::Vector3i(4 * cells, cells, cells));
  body.materials = {material};
  body.precision = precision;
  if (held != Held::nothing) {
    Handle end{"end", {}, held == Held::spring_end ? 500.0 : 0.0};
    for (std::int32_t v = 0; v < body.mesh.rest.rows(); ++v) {
      if (body.mesh.rest(v, 0) < 1e-9) end.vertices.push_back(v);
    }
    body.handles.push_back(end);
  }
  return body;
}

BodyDescription spring_net(int cells) {
  const ClothMesh cloth = cloth_grid({0.4, 0.4}, {cells, cells});
  BodyDescription body;
  body.name = "net";
  body.mesh.rest = cloth.surface.points;
  body.mesh.tets.resize(0, 4);
  body.precision = Precision::double_precision;
  for (const auto* pairs : {&cloth.edges, &cloth.diagonals, &cloth.bends}) {
    for (const auto& [from, to] : *pairs)
      body.springs.push_back({from, to, (body.mesh.rest.row(from) - body.mesh.rest.row(to)).norm(), 50});
  }
  body.point_mass = vertex_areas(cloth.surface);
  return body;
}

std::vector<Membrane> all_membranes() {
  const PlaneLame lame = PlaneLame::from_young(1e6, 0.3, 1e-3);
  return {PlaneNeoHookean::from(lame, 1), PlaneNeoHookean::from(lame, 0.1), PlaneStVenantKirchhoff::from(lame, 1),
          PlaneStVenantKirchhoff::from(lame, 0.1), Woven{900, 700, 60, 0.1, 1.2}};
}

BodyDescription sheet_of(const TriMesh& surface, const Fabric& fabric, double density) {
  BodyDescription body;
  body.name = "sheet";
  body.mesh.rest = surface.points;
  body.mesh.tets.resize(0, 4);
  body.precision = Precision::double_precision;
  body.surface = surface.triangles;
  body.fabric = fabric;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto corner = [&](int k) -> Eigen::Vector2d {
      return surface.points.row(surface.triangles(t, k)).head<2>().transpose();
    };
    const Eigen::Vector2d a = corner(1) - corner(0), b = corner(2) - corner(0);
    body.cloth.push_back(
        {{surface.triangles(t, 0), surface.triangles(t, 1), surface.triangles(t, 2)}, {a.x(), b.x(), a.y(), b.y()}});
  }
  body.point_mass = vertex_areas(surface);
  for (double& mass : body.point_mass) mass *= density;
  return body;
}

BodyDescription sheet(const Eigen::Vector2d& extent, const Eigen::Vector2i& cells, const Fabric& fabric,
                      double density) {
  return sheet_of(cloth_grid(extent, cells).surface, fabric, density);
}

StepInputs still_inputs(const Model& model) {
  StepInputs inputs;
  inputs.targets.resize(model.handled.size(), 3);
  for (std::size_t i = 0; i < model.handled.size(); ++i)
    inputs.targets.row(i) = model.rest.row(model.handled[i].vertex);
  return inputs;
}

State moving_state(const Model& model, const StepInputs& inputs, int steps) {
  State state = rest_state(model);
  OpenWorkspace workspace;
  for (int i = 0; i < steps; ++i) step(model, inputs, state, workspace);
  return state;
}

Positions shaken(const Positions& rest, double amount, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-amount, amount);
  Positions x = rest;
  for (double& value : x.reshaped()) value += uniform(random);
  return x;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "supple-test-XXXXXX").string();
  path = mkdtemp(pattern.data());
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path, ignored);
}

}  // namespace supple::test
