#include "film/record/state_file.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <type_traits>

#include "base/error.h"
#include "base/hash.h"
#include "base/read_file.h"
#include "output/files/json_text.h"
#include "output/files/npy.h"
#include "output/files/whole_file.h"
#include "output/run/run_folder.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Vec3& vector) { return {vector.x(), vector.y(), vector.z()}; }

template <class M>
Json json_of_model(const M& material) {
  Json json = {{"model", M::name}};
  for (const auto& parameter : M::parameters()) json[parameter.name] = material.*parameter.value;
  if constexpr (requires { M::curves(); }) {
    for (const auto& curve : M::curves()) {
      const SplineCurve& spline = material.*curve.value;
      if (spline.empty()) continue;
      json[curve.name] = Json::array();
      for (const ControlPoint& point : spline.points()) json[curve.name].push_back({point.at, point.value});
    }
  }
  return json;
}

Json regions_json(const StepProblem& problem) {
  Json regions = Json::array();
  for (std::size_t r = 0; r < problem.body.materials.size(); ++r) {
    Json region = {{"material", std::visit([](const auto& m) { return json_of_model(m); }, problem.body.materials[r])},
                   {"system_stiffness", problem.stiffness[r]}};
    if (r < problem.body.fibres.size() && problem.body.fibres[r].kappa > 0) {
      const Fibre& fibre = problem.body.fibres[r];
      region["fibre"] = {{"kappa", fibre.kappa},
                         {"direction", {fibre.direction[0], fibre.direction[1], fibre.direction[2]}}};
    }
    regions.push_back(std::move(region));
  }
  return regions;
}

// Returns those settings of a StepProblem that scenes have in [solver], as far as files of states keep them
// (docs/states.md). Integrator and damping are written one level up.
Json solver_json(const StepProblem& problem) {
  const SolverSettings& s = problem.solver;
  const ContactSettings& c = s.contact;
  return {{"iterations", s.iterations},
          {"history", s.history},
          {"matrix", name_of(s.matrix)},
          {"line_search", name_of(s.line_search)},
          {"armijo", s.armijo},
          {"target_error", s.target_error},
          {"elements", name_of(s.elements)},
          {"fit_from", problem.body.fit.start},
          {"fit_to", problem.body.fit.end},
          {"factor", name_of(problem.body.precision)},
          {"contact",
           {{"stiffness", c.stiffness},
            {"push_out", c.push_out},
            {"stick", c.stick},
            {"direction", name_of(c.direction)},
            {"points", name_of(c.points)}}}};
}

Json json_of(const Eigen::Isometry3d& pose) {
  Json rows = Json::array();
  for (int i = 0; i < 4; ++i)
    rows.push_back({pose.matrix()(i, 0), pose.matrix()(i, 1), pose.matrix()(i, 2), pose.matrix()(i, 3)});
  return rows;
}

Json fabric_json(const Fabric& fabric) {
  Json json = std::visit(
      []<class M>(const M& m) -> Json {
        if constexpr (M::isotropic) {
          return {{"model", M::name}, {"mu", m.mu}, {"lambda", m.lambda}, {"compression", m.compression}};
        } else {
          return {{"model", M::name},
                  {"warp", m.warp},
                  {"weft", m.weft},
                  {"shear", m.shear},
                  {"compression", m.compression},
                  {"limit", m.limit}};
        }
      },
      fabric.membrane);
  json["bending"] = fabric.bending;
  return json;
}

Json state_json(const StepLabel& label, const StepProblem& problem) {
  const BodyDescription& body = problem.body;
  Json json = {{"format", "supple-state"},
               {"version", state_file_version},
               {"program", program_version()},
               {"scene", label.scene},
               {"title", label.title},
               {"body", body.name},
               {"frame", label.frame},
               {"step", label.step},
               {"time", problem.time},
               {"time_step", body.time_step},
               {"integrator", name_of(body.integrator)},
               {"damping", body.damping},
               {"gravity", json_of(problem.gravity)},
               {"vertices", body.mesh.rest.rows()},
               {"tets", body.mesh.tets.rows()},
               {"springs", body.springs.size()},
               {"triangles", body.cloth.size()},
               {"handled", problem.handled.size()},
               {"regions", regions_json(problem)},
               {"solver", solver_json(problem)},
               {"began_in_single", problem.began_in_single},
               {"colliders", Json::array()},
               {"state_hash", hash_text_form(problem.hash)}};
  if (!body.cloth.empty()) json["fabric"] = fabric_json(body.fabric);
  if (body.curved) json["fabric"]["curved"] = true;
  for (const StepProblem::Obstacle& collider : problem.colliders) {
    json["colliders"].push_back({{"name", collider.name},
                                 {"thickness", collider.thickness},
                                 {"friction", collider.friction},
                                 {"start", json_of(collider.motion.start)},
                                 {"end", json_of(collider.motion.end)}});
  }
  return json;
}

template <class T, int columns>
void write_table(const std::filesystem::path& path,
                 const Eigen::Matrix<T, Eigen::Dynamic, columns, Eigen::RowMajor>& table) {
  write_npy(path, npy_table(table.rows(), columns), std::span<const T>(table.data(), std::size_t(table.size())));
}

template <class T>
void write_list(const std::filesystem::path& path, const std::vector<T>& list) {
  write_npy(path, npy_list(std::int64_t(list.size())), std::span<const T>(list));
}

void write_triangles(const std::filesystem::path& folder, const std::vector<FlatTriangle>& triangles) {
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3, Eigen::RowMajor> corners(triangles.size(), 3);
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> edges(triangles.size(), 4);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) corners(Eigen::Index(t), k) = triangles[t].corner[std::size_t(k)];
    for (int i = 0; i < 4; ++i) edges(Eigen::Index(t), i) = triangles[t].edges[i];
  }
  write_table(folder / "triangles.npy", corners);
  write_table(folder / "flat_edges.npy", edges);
}

void write_springs(const std::filesystem::path& folder, const std::vector<Spring>& springs) {
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, 2, Eigen::RowMajor> ends(springs.size(), 2);
  Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor> values(springs.size(), 2);
  for (std::size_t s = 0; s < springs.size(); ++s) {
    ends.row(s) << springs[s].from, springs[s].to;
    values.row(s) << springs[s].length, springs[s].stiffness;
  }
  write_table(folder / "springs.npy", ends);
  write_table(folder / "spring_values.npy", values);
}

void write_seams(const std::filesystem::path& folder, const std::vector<SeamPair>& seams) {
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3, Eigen::RowMajor> vertices(seams.size(), 3);
  Eigen::Matrix<double, Eigen::Dynamic, 7, Eigen::RowMajor> values(seams.size(), 7);
  for (Eigen::Index p = 0; p < vertices.rows(); ++p) {
    const SeamPair& pair = seams[std::size_t(p)];
    vertices.row(p) << pair.vertex[0], pair.vertex[1], pair.vertex[2];
    values.row(p) << pair.factor[0], pair.factor[1], pair.factor[2], pair.gap.transpose(), pair.stiffness;
  }
  write_table(folder / "seams.npy", vertices);
  write_table(folder / "seam_values.npy", values);
}

// Reads a value of state.json.
template <class T>
T value_of(const nlohmann::json& json, const std::string& file, const char* key) {
  const auto found = json.find(key);
  if (found == json.end()) throw InputError(file, fmt::format("'{}' is missing", key));
  const bool right = std::is_same_v<T, bool>       ? found->is_boolean()
                     : std::is_integral_v<T>       ? found->is_number_integer()
                     : std::is_floating_point_v<T> ? found->is_number()
                                                   : found->is_string();
  if (!right) throw InputError(file, fmt::format("'{}' cannot be {}", key, found->dump()));
  return found->get<T>();
}

nlohmann::json read_json(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(path, "no such file: this is not the folder of a state");
  nlohmann::json json = json_if_valid<nlohmann::json>(read_file(path));
  if (!json.is_object() || json.value("format", nlohmann::json()) != "supple-state")
    throw InputError(path, "is not the description of a state (\"format\": \"supple-state\")");
  return json;
}

Positions read_positions(const std::filesystem::path& path, std::int64_t vertices) {
  const NpyArray<double> array = read_npy_doubles(path);
  if (array.shape.dimensions != 2 || array.shape.rows != vertices || array.shape.columns != 3) {
    throw InputError(path.string(), fmt::format("is {} x {} where state.json has {} vertices: {} x 3 belongs there",
                                                array.shape.rows, array.shape.columns, vertices, vertices));
  }
  return Eigen::Map<const Positions>(array.values.data(), vertices, 3);
}

}  // namespace

void write_state(const std::filesystem::path& folder, const StepLabel& label, const StepProblem& problem) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw RunError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  std::filesystem::remove(folder / "state.json", error);
  const TetMesh& mesh = problem.body.mesh;
  write_table(folder / "q.npy", problem.q);
  write_table(folder / "v.npy", problem.v);
  write_table(folder / "y.npy", problem.y);
  write_table(folder / "rest.npy", mesh.rest);
  write_table(folder / "tets.npy", mesh.tets);
  std::vector<std::int32_t> regions(mesh.regions.begin(), mesh.regions.end());
  if (regions.empty()) regions.resize(mesh.tets.rows(), 0);
  SUPPLE_CHECK(Eigen::Index(regions.size()), ==, mesh.tets.rows());
  write_list(folder / "regions.npy", regions);
  write_list(folder / "mass.npy", problem.mass);
  if (!problem.body.springs.empty()) write_springs(folder, problem.body.springs);
  if (!problem.body.cloth.empty()) write_triangles(folder, problem.body.cloth);
  if (!problem.seams.empty()) write_seams(folder, problem.seams);
  std::vector<std::int32_t> handled;
  std::vector<double> stiffness;
  for (const StepProblem::Handled& each : problem.handled) {
    handled.push_back(each.vertex);
    stiffness.push_back(each.stiffness);
  }
  write_list(folder / "handled.npy", handled);
  write_list(folder / "handle_stiffness.npy", stiffness);
  write_table(folder / "targets.npy", problem.targets);
  if (problem.middle_targets.rows() > 0) write_table(folder / "middle_targets.npy", problem.middle_targets);
  // Names need not be UTF-8, but JSON must be.
  write_whole_file(folder / "state.json", json_text(state_json(label, problem), 1) + "\n");
}

StoredState read_state(const std::filesystem::path& folder) {
  const std::string file = (folder / "state.json").string();
  const nlohmann::json json = read_json(file);
  const int version = value_of<int>(json, file, "version");
  if (version != state_file_version) {
    throw InputError(file, fmt::format("is of version {}; version {} is the one that this program reads", version,
                                       state_file_version));
  }
  const auto vertices = value_of<std::int64_t>(json, file, "vertices");
  StoredState stored{folder,
                     value_of<std::string>(json, file, "body"),
                     value_of<int>(json, file, "frame"),
                     value_of<double>(json, file, "time"),
                     read_positions(folder / "q.npy", vertices),
                     read_positions(folder / "v.npy", vertices),
                     value_of<bool>(json, file, "began_in_single")};
  Positions both(2 * vertices, 3);
  both << stored.q, stored.v;
  const std::string hash = hash_text_form(hash_bytes(both.data(), sizeof(double) * std::size_t(both.size())));
  const auto expected = value_of<std::string>(json, file, "state_hash");
  if (hash != expected) {
    throw InputError(
        file, fmt::format("state_hash is {}, but q.npy and v.npy have {}: one of them was changed", expected, hash));
  }
  return stored;
}

State state_for(const Model& model, const StoredState& stored) {
  if (stored.q.rows() != model.vertices) {
    throw InputError(stored.folder.string(),
                     fmt::format("has {} vertices; body '{}' has {}", stored.q.rows(), model.name, model.vertices));
  }
  State state = rest_state(model);
  for (int i = 0; i < model.vertices; ++i) {
    state.x.row(i) = stored.q.row(model.input_of[i]);
    state.v.row(i) = stored.v.row(model.input_of[i]);
  }
  state.time = stored.time;
  state.memory.began_in_single = stored.began_in_single;
  return state;
}

}  // namespace supple
