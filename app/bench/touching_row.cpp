// Measures how the time of a step grows with what touches in one island: a row of cubes that lean on each other.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>

#include "app/bench/fitted_exponent.h"
#include "app/bench/sections.h"
#include "app/bench/touching_film.h"
#include "app/bench/touching_tables.h"

namespace supple {
namespace {

constexpr int settling_frames = 15, timed_frames = 10;
constexpr double leaning_deg = 2;

// Returns the scene of a row of cubes on ground that slopes down, without friction, to a wall: each leans on the next.
// The ground is level, and gravity is turned. solver: the text of its table, if it has one.
std::string leaning_row(int count, const char* solver) {
  constexpr double edge = 0.1, gap_between = 1e-4;
  const double angle = leaning_deg * std::numbers::pi / 180;
  std::string text = fmt::format("frames = {}\ngravity = [{:.17g}, {:.17g}, 0]\n{}", settling_frames + timed_frames,
                                 -9.81 * std::sin(angle), -9.81 * std::cos(angle), solver);
  for (int i = 0; i < count; ++i) {
    text += fmt::format(
        "[[body]]\nname = \"cube-{}\"\nbox = {{ extent = [{:g}, {:g}, {:g}], cells = [2, 2, 2] }}\n"
        "position = [{:.17g}, {:g}, 0]\nmaterial = {{ model = \"stable-neo-hookean\", young = 1e5, poisson = 0.4 }}\n"
        "density = 1000\n",
        i + 1, edge, edge, edge, (edge + gap_between) * (i + 0.5), gap_between);
  }
  return text + ground_text(0) + "[[collider]]\nname = \"wall\"\nshape = { half_space = { normal = [1, 0, 0] } }\n";
}

// Holds what was measured of one row.
struct LeaningRow {
  int bodies = 0, vertices = 0, contacts = 0, collider_contacts = 0;
  std::size_t island = 0;  // bodies of the largest one
  double ms = 0;           // of a step, median
  double film_ms = 0;      // of a step that may end early
  double trials = 0;       // an iteration

  int all_contacts() const { return contacts + collider_contacts; }
};

// Plays a row until it has settled, and returns the times of the frames after that [ms]. look: sees each of them.
std::vector<double> settled_times(TouchingFilm& film, const std::function<void(const TouchingWork&)>& look = {}) {
  std::vector<double> ms;
  if (!film.play_until(settling_frames)) return ms;
  while (film.frames() < settling_frames + timed_frames && film.play()) {
    ms.push_back(film.work().ms);
    if (look) look(film.work());
  }
  return ms;
}

LeaningRow measure_row(int count, const BenchSetting& setting) {
  TouchingFilm film(leaning_row(count, "[solver]\nstill = 0\n"), *setting.threads);
  LeaningRow row;
  row.bodies = count;
  for (std::size_t b = 0; b < film.world().size(); ++b) row.vertices += film.world().body(b).model().vertices;
  int iterations = 0, trials = 0;
  row.ms = rank_of(settled_times(film,
                                 [&](const TouchingWork& work) {
                                   iterations += work.iterations;
                                   trials += work.trials;
                                   row.contacts = std::max(row.contacts, work.contacts);
                                   row.collider_contacts = std::max(row.collider_contacts, work.collider_contacts);
                                   row.island = std::max(row.island, work.largest_island);
                                 }),
                   0.5);
  row.trials = double(trials) / std::max(1, iterations);
  TouchingFilm shipped(leaning_row(count, ""), *setting.threads);
  row.film_ms = rank_of(settled_times(shipped), 0.5);
  return row;
}

}  // namespace

RowOfBodies row_of_bodies(const BenchSetting& setting) {
  std::vector<LeaningRow> rows;
  for (const int count : {1, 5, 20, 80}) {
    say_doing(setting, fmt::format("a row of {} cubes", count));
    rows.push_back(measure_row(count, setting));
  }
  RowOfBodies result{{"touching-row", "A row of cubes, each of which leans on the next"}, {}};
  ReportTable& table = result.table;
  table.note = fmt::format(
      "Each step makes all its ten iterations (still = 0): in a film a short row lies still after fewer, as the second "
      "time shows. Cubes of 0.1 m with 27 vertices, stable Neo-Hookean with 1e5 Pa, without friction on ground that "
      "slopes by {:g} degrees towards a wall. The time is the median of {} frames of one step, after {} in which the "
      "row settles. The exponents are the p of bodies^p, and of contacts^p, to which this row and those above it fit "
      "best, by least squares of logarithms; the contacts are those with bodies and with colliders. A cube in the "
      "middle of a long "
      "row has more contacts than one alone, which touches colliders only.",
      leaning_deg, timed_frames, settling_frames);
  table.columns = {"bodies",
                   "bodies of the largest island",
                   "vertices",
                   "contacts between bodies, most",
                   "contacts with colliders, most",
                   "a step [ms]",
                   "a step and body [ms]",
                   "a step of a film [ms]",
                   "trials an iteration",
                   "exponent, of bodies",
                   "exponent, of contacts",
                   "exponents, aim: below"};
  PlotSeries series{"a step"};
  series.thick = true;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const LeaningRow& row = rows[i];
    const std::span<const LeaningRow> so_far(rows.data(), i + 1);
    const double of_bodies = fitted_exponent(so_far, std::mem_fn(&LeaningRow::bodies), std::mem_fn(&LeaningRow::ms));
    const double of_contacts =
        fitted_exponent(so_far, std::mem_fn(&LeaningRow::all_contacts), std::mem_fn(&LeaningRow::ms));
    table.rows.push_back({std::to_string(row.bodies), std::to_string(row.island), std::to_string(row.vertices),
                          std::to_string(row.contacts), std::to_string(row.collider_contacts), number_text(row.ms),
                          number_text(row.ms / row.bodies), number_text(row.film_ms), number_text(row.trials),
                          number_text(of_bodies), number_text(of_contacts), i == 0 ? "" : "1.2"});
    series.x.push_back(row.bodies);
    series.y.push_back(row.ms);
  }
  result.plot = {"touching-row-ms", "A step against the number of bodies that lean on each other"};
  result.plot.x_label = "bodies";
  result.plot.y_label = "time [ms]";
  result.plot.log_x = true;
  result.plot.series.push_back(std::move(series));
  return result;
}

}  // namespace supple
