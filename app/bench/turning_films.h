// Plays films of a body that turns, by several solvers, and tabulates how far each film comes from the one whose steps
// are solved.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "app/bench/bench.h"
#include "output/pages/report_page.h"
#include "sim/model/model.h"
#include "sim/model/state.h"

namespace supple {

// Returns up to three numbers that tell how far a body has come.
using Observe = std::function<Vec3(const Model& model, const State& state)>;

struct TurningCase {
  std::string scene;  // text of a scene with one body
  Observe observe;
  Vec3 spin = Vec3::Zero();  // angular velocity at the start, of a body that nothing holds [rad/s]
};

struct TurningFilm {
  std::vector<Vec3> seen;     // what was observed before the first frame and after each; NaN once a step has failed
  double trials = 0;          // evaluations an iteration
  double step_ms = 0;         // mean
  double error_estimate = 0;  // the largest of all steps
  int vertices = 0;
};

struct TurningFilms {
  TurningFilm ours, papers, solved;
  TurningFilm again;  // the film solved with twice the iterations, which tells how well the motion is determined at all
};

TurningFilms play_films(const TurningCase& turning, const std::string& name, const BenchSetting& setting);

// Returns the mean of rows by vertex (n x 3), weighted with the vertices' masses.
Vec3 mass_mean(const Model& model, const Positions& rows);

// Holds one number before the first frame, and one for each frame.
using MotionCurve = Eigen::ArrayXd;

struct MotionCurves {
  MotionCurve ours, papers, solved, again;
};

// Returns the curves of one coordinate of the observed numbers.
MotionCurves curves_of(const TurningFilms& films, int coordinate);

// Adds whole turns to angles so that they go on from frame to frame without jumps [degrees].
MotionCurves without_jumps(const MotionCurves& angles);

// Divides every curve by its first number.
MotionCurves over_first(const MotionCurves& curves);

double last_of(const MotionCurve& curve);

MotionCurve constant_unit(const MotionCurves& curves, double unit);

struct MotionQuantity {
  std::string name, unit, unit_of_difference;
};

using TableCells = std::vector<std::string>;

void append(TableCells& cells, const TableCells& more);

// Makes an empty table with these columns, the columns of each quantity, and the columns of the costs.
ReportTable table_of(const std::string& name, const std::string& title, TableCells columns,
                     const std::vector<MotionQuantity>& quantities);

// Returns the cells of a quantity. unit: the unit of the differences, for each frame.
TableCells cells_of(const MotionCurves& curves, const MotionCurve& unit);

TableCells costs_of(const TurningFilms& films);

}  // namespace supple
