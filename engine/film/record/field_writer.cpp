#include "film/record/field_writer.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/floats.h"
#include "scene/definition/scene_def.h"
#include "sim/measures/fields.h"

namespace supple {
namespace {

using Floats = std::vector<float>;

template <class T>
VtuArray array_of(const char* name, int components, const std::vector<T>& values) {
  return {name, components, std::span<const T>(values)};
}

}  // namespace

FieldWriter::FieldWriter(const Body& body, const Model& model, const RunFolder& folder, const SceneDef& scene)
    : body_(body), model_(model), folder_(folder), scene_(scene) {
  std::error_code error;
  std::filesystem::create_directories(folder.fields(), error);
  if (error) throw RunError(fmt::format("{}: cannot be made: {}", folder.fields().string(), error.message()));
}

// Finds the frames that a run wrote before it was interrupted.
void FieldWriter::find_earlier(int frame) {
  std::error_code error;
  for (int earlier = 0; earlier < frame; ++earlier) {
    if (std::filesystem::exists(folder_.fields(body_.def.name, earlier), error)) written_.push_back(earlier);
  }
}

void FieldWriter::write_collection() const {
  std::vector<PvdEntry> entries;
  for (const int frame : written_)
    entries.push_back({scene_.time_after(frame), folder_.fields(body_.def.name, frame).filename().string()});
  write_pvd(folder_.field_collection(body_.def.name), entries);
}

void FieldWriter::add(int frame, const State& state, const OpenWorkspace& workspace) {
  const TetMesh& mesh = body_.description.mesh;
  const bool cloth = mesh.tets.rows() == 0;
  const Positions x = in_input_order(model_, state.x);
  const ElementFields fields = element_fields(model_, state.x);
  const Floats displacement = as_floats(x - mesh.rest), velocity = as_floats(in_input_order(model_, state.v));
  VtuGrid grid;
  grid.points = {x.data(), std::size_t(x.size())};
  grid.point_data = {array_of("displacement", 3, displacement), array_of("velocity", 3, velocity)};
  Floats force, stretch, von_mises, kept;
  if (scene_.may_touch()) {
    force = as_floats(contact_forces(model_, workspace, state.x));
    grid.point_data.push_back(array_of("contact_force", 3, force));
  }
  if (!fields.spring_energy.empty()) grid.point_data.push_back(array_of("spring_energy", 1, fields.spring_energy));
  if (cloth) {
    for (const auto& pair : triangle_stretches(mesh.rest, x, body_.cloth.surface.triangles))
      stretch.insert(stretch.end(), pair.begin(), pair.end());
    grid.corners = {body_.cloth.surface.triangles.data(), std::size_t(body_.cloth.surface.triangles.size())};
    grid.corners_a_cell = 3;
    grid.cell_data = {array_of("stretch", 2, stretch)};
    if (!fields.cloth_energy.empty()) grid.cell_data.push_back(array_of("energy_density", 1, fields.cloth_energy));
  } else {
    stretch = as_floats(fields.stretch);
    von_mises = as_floats(fields.von_mises);
    grid.corners = {mesh.tets.data(), std::size_t(mesh.tets.size())};
    grid.cell_data = {array_of("stretch", 3, stretch), array_of("von_mises", 1, von_mises),
                      array_of("energy_density", 1, fields.energy)};
  }
  if (!state.flow.hardened.empty()) {
    kept = as_floats(state.flow.hardened);
    grid.cell_data.push_back(array_of("plastic_strain", 1, kept));
  }
  write_vtu(folder_.fields(body_.def.name, frame), grid);
  if (written_.empty()) find_earlier(frame);
  written_.push_back(frame);
  write_collection();
}

}  // namespace supple
