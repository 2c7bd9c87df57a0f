// Provides small bodies and states that many tests share.
#pragma once

#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "sim/solver/step.h"
#include "support/places.h"

namespace supple::test {

// Finds the paper's mesh of this name. When there is none, the calling test is skipped with that name (with
// SUPPLE_REQUIRE_PAPER=1 it fails).
std::optional<std::filesystem::path> paper_mesh(const std::string& name);

// Returns at least one material of each model, with moduli of the same size. A new one goes to the end: some tests take
// the first one, or the third for a corotated body with fibres.
std::vector<Material> all_materials();

// Returns the names of all materials, as scene files spell them.
std::vector<std::string> model_names();

// Makes a bar of 4 x 1 x 1 cells, 0.4 m long; its left end can be held.
enum class Held { nothing, hard_end, spring_end };
BodyDescription bar(const Material& material, Held held, Precision precision = Precision::double_precision,
                    int cells = 1);

// Makes a free square of cells x cells springs, 0.4 m wide, in the plane z = 0.
BodyDescription spring_net(int cells);

// Returns one membrane of each kind, with and without the whole stiffness against compression. [about 1000 N/m]
std::vector<Membrane> all_membranes();

// Makes a free sheet of cells x cells squares with alternating diagonals, in the plane z = 0, with its lower left
// corner at the origin. extent: of its sides [m]; density [kg/m^2].
BodyDescription sheet(const Eigen::Vector2d& extent, const Eigen::Vector2i& cells, const Fabric& fabric,
                      double density = 0.2);

// Makes cloth of any flat triangles in the plane z = 0.
BodyDescription sheet_of(const TriMesh& surface, const Fabric& fabric, double density = 0.2);

// Makes inputs for a body whose handles stay where they rest.
StepInputs still_inputs(const Model& model);

// Returns the state of a body from rest some steps into its motion.
State moving_state(const Model& model, const StepInputs& inputs, int steps);

// Returns rest positions with every coordinate moved by up to `amount`.
Positions shaken(const Positions& rest, double amount, unsigned seed);

std::string read_file(const std::filesystem::path& path);

// Owns a folder that is removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  std::filesystem::path path;
};

}  // namespace supple::test
