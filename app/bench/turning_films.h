// Plays a body that turns in several ways, and tabulates how far each film comes from the one whose steps are solved.
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
  std::string scene;  // its text, with one body
  Observe observe;
  Vec3 spin = Vec3::Zero();  // angular velocity at the start, of a body that nothing holds [rad/s]
};

struct TurningFilm {
  std::vector<Vec3> seen;     // what was observed before the first frame and after each; NaN once a step has failed
  double trials = 0;          // evaluations by iteration
  double step_ms = 0;         // mean
  double error_estimate = 0;  // the largest of all steps
  int vertices = 0;
};

struct TurningFilms {
  TurningFilm ours, papers, solved;
  TurningFilm again;  // solved with twice the iterations: how well the film of the body is determined at all
};

TurningFilms play_films(const TurningCase& turning, const std::string& name, const BenchSetting& setting);

// Returns the mean of rows by vertex (n x 3), weighted with the vertices' masses.
Vec3 mass_mean(const Model& model, const Positions& rows);

// Holds a number by frame; the first is that before the first frame.
using MotionCurve = Eigen::ArrayXd;

struct MotionCurves {
  MotionCurve ours, papers, solved, again;
};

// Returns a coordinate of what was observed.
MotionCurves curves_of(const TurningFilms& films, int coordinate);

// Makes angles that are known up to whole turns go on from frame to frame without jumps [degrees].
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

// Makes an empty table: these columns, those of each quantity, and those of the costs.
ReportTable table_of(const std::string& name, const std::string& title, TableCells columns,
                     const std::vector<MotionQuantity>& quantities);

// Returns the cells of a quantity. unit: that of the differences, by frame.
TableCells cells_of(const MotionCurves& curves, const MotionCurve& unit);

TableCells costs_of(const TurningFilms& films);

}  // namespace supple
