// Hangs bodies with slivers from one end, with each matrix that directions can start from, and prints a row for each:
// error of equation 12 after ten iterations, trials, and the largest stretch of an edge beside that of a solved film.
//   supple_sliver_study [FOLDER_FOR_MESHES]
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "app/bench/subject.h"
#include "baselines/reference.h"
#include "film/plan/shipped_files.h"
#include "geometry/files/mesh_file.h"
#include "geometry/tetrahedra/tetrahedralize.h"
#include "geometry/triangles/surface_thickness.h"

using namespace supple;

namespace {

constexpr int film_frames = 60;
constexpr int measured_every = 3;  // frames
constexpr int solving_iterations = 400;

// Every so many elements, one is cut by a vertex at this share of its height above a face. That leaves an element of
// this share of its volume, flat on the face, and three others. 1 leaves the mesh as it is.
constexpr double shares[] = {1, 4e-3, 1e-6};
constexpr Eigen::Index cut_every = 20;

TetMesh with_slivers(const TetMesh& mesh, double share) {
  if (share == 1) return mesh;
  const Eigen::Index cuts = (mesh.tets.rows() + cut_every - 1) / cut_every;
  TetMesh cut;
  cut.rest.resize(mesh.rest.rows() + cuts, 3);
  cut.rest.topRows(mesh.rest.rows()) = mesh.rest;
  cut.tets.resize(mesh.tets.rows() + 3 * cuts, 4);
  Eigen::Index vertex = mesh.rest.rows(), row = 0;
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    if (e % cut_every != 0) {
      cut.tets.row(row++) = mesh.tets.row(e);
      continue;
    }
    const Eigen::Index above = (e / cut_every) % 4;  // the corner across from the face on which the new vertex lies
    cut.rest.row(vertex).setZero();
    for (Eigen::Index corner = 0; corner < 4; ++corner)
      cut.rest.row(vertex) += (corner == above ? share : (1 - share) / 3) * mesh.rest.row(mesh.tets(e, corner));
    for (Eigen::Index corner = 0; corner < 4; ++corner) {
      cut.tets.row(row) = mesh.tets.row(e);
      cut.tets(row++, corner) = static_cast<int>(vertex);
    }
    ++vertex;
  }
  cut.regions.assign(static_cast<std::size_t>(cut.tets.rows()), 0);
  return cut;
}

struct HangingBody {
  const char* name;
  TetMesh mesh;
};

// Both hang from one end: a bar, and a limb that is one cell thick, so that all of its vertices lie on the surface.
std::array<HangingBody, 2> hanging_bodies() {
  return {{{"bar", box_mesh(Vec3(1, 0.125, 0.125), {24, 3, 3})}, {"limb", box_mesh(Vec3(1, 0.05, 0.05), {20, 1, 1})}}};
}

double largest_edge_stretch(const TetMesh& mesh, const Model& model, const Positions& x) {
  Positions now(x.rows(), 3);
  for (int v = 0; v < model.vertices; ++v) now.row(model.input_of[v]) = x.row(v);
  double largest = 0;
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < i; ++j) {
        const int a = mesh.tets(e, i), b = mesh.tets(e, j);
        largest = std::max(largest, (now.row(a) - now.row(b)).norm() / (mesh.rest.row(a) - mesh.rest.row(b)).norm());
      }
    }
  }
  return largest;
}

struct Hung {
  double log_error = 0, worst_error = 0;
  int measured = 0, iterations = 0, trials = 0;
  double stretch = 0;  // of an edge in any frame
};

// Films the body, and measures the error of every few steps where it is asked for.
Hung hang(Subject& subject, const TetMesh& mesh, int iterations, DirectionStart start, bool with_errors,
          Threads& threads) {
  World world = subject.new_world(solver_instead(Method::quasi_newton, iterations, start), threads);
  const MovingBody& body = world.body(0);
  Reference reference(subject.model());
  OpenWorkspace scratch;
  Hung hung;
  for (int frame = 0; frame < film_frames; ++frame) {
    const State before = body.state();
    const bool made = world.play(frame, {{}, [&](std::size_t, int) {
                                           hung.iterations += body.report().iterations;
                                           hung.trials += body.report().line_search;
                                         }});
    if (!made) {
      hung.worst_error = hung.stretch = std::nan("");
      return hung;
    }
    hung.stretch = std::max(hung.stretch, largest_edge_stretch(mesh, body.model(), body.state().x));
    if (!with_errors || frame % measured_every != 0) continue;
    const auto error = reference.step_error(subject.model(), body.inputs(), before, body.state(), scratch);
    if (!error) continue;
    hung.log_error += std::log(std::max(*error, 1e-15));
    hung.worst_error = std::max(hung.worst_error, *error);
    ++hung.measured;
  }
  return hung;
}

void print_rows(const HangingBody& body, double share, const std::filesystem::path& folder) {
  Threads threads(1);
  const TetMesh mesh = with_slivers(body.mesh, share);
  const MeshQuality found = quality(mesh);
  const auto file = folder / fmt::format("slivers-{}-{:g}.mesh", body.name, share);
  write_mesh(file, mesh);
  for (const char* material :
       {"{ model = 'stable-neo-hookean', young = 1e5, poisson = 0.4 }",
        "{ model = 'corotated', young = 1e5, poisson = 0.3 }", "{ model = 'polynomial', mu = 1e5 }"}) {
    Subject subject({(assets_folder() / "bench" / "hanging-bar.toml").string(),
                     "bar",
                     {"body.bar.mesh=" + file.string(), fmt::format("body.bar.material={}", material),
                      "body.bar.handles.end.select={ box = [[0, 0, 0], [0.03, 1, 1]] }"}});
    const double solved = hang(subject, mesh, solving_iterations, {}, false, threads).stretch;
    for (const StartMatrix matrix : {StartMatrix::system, StartMatrix::tangent, StartMatrix::turned_hessian}) {
      const Hung hung = hang(subject, mesh, 10, {matrix, true}, true, threads);
      fmt::print("| {} | {:.1e} | {:.2g} | {} | {} | {:.1e} | {:.1e} | {:.2f} | {:.3f} | {:.3f} |\n", body.name,
                 found.smallest_volume, found.smallest_dihedral, material, name_of(matrix),
                 std::exp(hung.log_error / std::max(1, hung.measured)), hung.worst_error,
                 static_cast<double>(hung.trials) / std::max(1, hung.iterations), hung.stretch, solved);
      std::fflush(stdout);
    }
  }
}

}  // namespace

int main(int count, char** arguments) {
  const std::filesystem::path folder = count > 1 ? arguments[1] : std::filesystem::temp_directory_path().string();
  fmt::print(
      "| body | smallest volume over the mean | smallest angle [degrees] | material | matrix | error, geometric mean | "
      "error, worst | trials an iteration | largest stretch of an edge | solved |\n");
  for (const HangingBody& body : hanging_bodies()) {
    for (const double share : shares) print_rows(body, share, folder);
  }
  return 0;
}
