#include "app/sweep/sweep_tables.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/hash.h"
#include "output/files/json_text.h"

namespace supple {
namespace {

// Holds the rows of one body in one point, in the order of the frames.
using BodyRows = std::vector<const BodyRow*>;

struct Measure {
  const char* name;
  std::function<std::optional<double>(const BodyRows&)> of;
};

template <class Get>
std::optional<double> largest(const BodyRows& rows, const Get& get) {
  std::optional<double> most;
  for (const BodyRow* row : rows) {
    const std::optional<double> value = get(*row);
    if (value) most = std::max(most.value_or(*value), *value);
  }
  return most;
}

std::optional<double> mean(const BodyRows& rows, std::optional<double> BodyRow::*value) {
  double sum = 0;
  int count = 0;
  for (const BodyRow* row : rows) {
    if (!(row->*value)) continue;
    sum += *(row->*value);
    ++count;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

template <class Get>
double total(const BodyRows& rows, const Get& get) {
  double sum = 0;
  for (const BodyRow* row : rows) sum += get(*row);
  return sum;
}

const std::vector<Measure>& measures() {
  using Value = std::optional<double>;
  static const std::vector<Measure> list = {
      {"stretch", [](const BodyRows& r) { return largest(r, [](const BodyRow& b) { return Value(b.stretch); }); }},
      {"jiggle", [](const BodyRows& r) { return largest(r, [](const BodyRow& b) { return b.jiggle; }); }},
      {"inverted",
       [](const BodyRows& r) {
         return largest(r, [](const BodyRow& b) { return b.inverted ? Value(*b.inverted) : Value(); });
       }},
      {"penetration",
       [](const BodyRows& r) {
         return largest(r, [](const BodyRow& b) { return b.contact ? Value(b.contact->penetration) : Value(); });
       }},
      {"iterations", [](const BodyRows& r) { return Value(total(r, [](const BodyRow& b) { return b.iterations; })); }},
      {"trials", [](const BodyRows& r) { return Value(total(r, [](const BodyRow& b) { return b.line_search; })); }},
      {"objective_end [J]", [](const BodyRows& r) { return Value(r.back()->objective_end); }},
      {"error_mean", [](const BodyRows& r) { return mean(r, &BodyRow::error); }},
      {"error_max", [](const BodyRows& r) { return largest(r, [](const BodyRow& b) { return b.error; }); }},
      {"motion_error_mean", [](const BodyRows& r) { return mean(r, &BodyRow::motion_error); }},
      {"motion_error_max",
       [](const BodyRows& r) { return largest(r, [](const BodyRow& b) { return b.motion_error; }); }}};
  return list;
}

std::vector<std::string> body_names(const std::vector<PointResult>& results) {
  std::vector<std::string> names;
  for (const PointResult& result : results) {
    for (const PointResult::BodyMeasures& body : result.bodies)
      if (std::ranges::find(names, body.name) == names.end()) names.push_back(body.name);
  }
  return names;
}

// Writes a number with all its digits; empty where there is none.
std::string exact_text(const std::optional<double>& value) { return value ? fmt::format("{}", *value) : ""; }

// Adds a column. A name that a path of the sweep already has gets one more word.
void add_column(ReportTable& table, std::string name, const std::vector<std::string>& cells) {
  while (std::ranges::find(table.columns, name) != table.columns.end()) name += " (result)";
  table.columns.push_back(std::move(name));
  for (std::size_t i = 0; i < cells.size(); ++i) table.rows[i].push_back(cells[i]);
}

template <class Get>
std::vector<std::string> cells_of(const std::vector<PointResult>& results, const Get& get) {
  std::vector<std::string> cells;
  for (const PointResult& result : results) cells.push_back(get(result));
  return cells;
}

void add_measures(ReportTable& table, const std::vector<PointResult>& results, const std::string& name) {
  for (std::size_t m = 0; m < measures().size(); ++m) {
    const std::vector<std::string> cells = cells_of(results, [&](const PointResult& result) {
      const auto body = std::ranges::find(result.bodies, name, &PointResult::BodyMeasures::name);
      return body == result.bodies.end() ? std::string() : exact_text(body->values[m]);
    });
    if (std::ranges::any_of(cells, [](const std::string& cell) { return !cell.empty(); }))
      add_column(table, name + "." + measures()[m].name, cells);
  }
}

ReportTable empty_table(const std::string& name, const std::string& title, const std::string& note,
                        std::size_t points) {
  ReportTable table{name, title, note};
  table.row_name = "point";
  table.first_row = 0;
  table.rows.resize(points);
  return table;
}

std::string json_word(const nlohmann::json& json, const char* table, const char* key) {
  if (!json.is_object() || !json.contains(table) || !json[table].is_object()) return "";
  const nlohmann::json& word = json[table].value(key, nlohmann::json());
  return word.is_string() ? word.get<std::string>() : "";
}

void add_rows(PointResult& result, const std::vector<FrameRow>& rows) {
  if (rows.empty()) return;
  result.frames = rows.size();
  result.state_hash = rows.back().state_hash;
  result.step_ms = summarize(rows).front().rest;
  for (std::size_t b = 0; b < rows.front().bodies.size(); ++b) {
    BodyRows of_body;
    for (const FrameRow& row : rows) of_body.push_back(&row.bodies.at(b));
    result.bodies.push_back({rows.front().bodies[b].name, {}});
    for (const Measure& measure : measures()) result.bodies.back().values.push_back(measure.of(of_body));
  }
}

PointResult read_result(const SweepRequest& request, std::size_t point) {
  PointResult result;
  result.outcome = outcome_of(request, point);
  if (result.outcome.end != PointEnd::done && result.outcome.end != PointEnd::failed) return result;
  const std::filesystem::path folder = request.folder(point);
  const auto run = json_object_in<nlohmann::json>(folder / "run.json");
  result.cpu = json_word(run, "machine", "cpu");
  result.kernels = json_word(run, "program", "kernels");
  if (std::filesystem::exists(folder / "profile.json")) add_rows(result, read_profile(folder / "profile.json"));
  return result;
}

}  // namespace

std::vector<PointResult> read_results(const SweepRequest& request) {
  std::vector<PointResult> results;
  for (std::size_t point = 0; point < request.sweep.points(); ++point) results.push_back(read_result(request, point));
  return results;
}

ReportTable sweep_table(const SweepDef& sweep, const std::vector<PointResult>& results) {
  ReportTable table = empty_table(
      "sweep", "What the points gave",
      "Stretch, jiggle, inverted elements and penetration are the largest of all frames; iterations and trials their "
      "sum; the objective is the last frame's; state_hash is of the last whole frame's positions and velocities.",
      results.size());
  table.page_digits = 4;
  for (std::size_t a = 0; a < sweep.axes.size(); ++a) {
    std::vector<std::string> values;
    for (std::size_t point = 0; point < results.size(); ++point) values.push_back(sweep.values(point)[a]);
    add_column(table, sweep.axes[a].path, values);
  }
  add_column(table, "outcome", cells_of(results, [](const PointResult& r) { return end_text(r.outcome.end); }));
  add_column(table, "exit_status", cells_of(results, [](const PointResult& r) { return r.outcome.exit_status; }));
  add_column(table, "message", cells_of(results, [](const PointResult& r) { return r.outcome.message; }));
  add_column(table, "frames_done", cells_of(results, [](const PointResult& r) { return fmt::format("{}", r.frames); }));
  // The prefix "0x" keeps other programs from reading a hash that has only digits as a number.
  add_column(table, "state_hash", cells_of(results, [](const PointResult& r) {
               return r.frames == 0 ? "" : "0x" + hash_text_form(r.state_hash);
             }));
  for (const std::string& body : body_names(results)) add_measures(table, results, body);
  return table;
}

ReportTable times_table(const std::vector<PointResult>& results) {
  ReportTable table =
      empty_table("times", "What the clock said",
                  "The first frame is left out of the steps; wall is the whole run of the point.", results.size());
  table.page_digits = 4;
  const auto text = [](const PointResult& r, double value) {
    return r.frames == 0 ? "" : fmt::format("{:.3f}", value);
  };
  add_column(table, "step, median [ms]", cells_of(results, [&](const auto& r) { return text(r, r.step_ms.p50); }));
  add_column(table, "step, 95 % [ms]", cells_of(results, [&](const auto& r) { return text(r, r.step_ms.p95); }));
  add_column(table, "wall [s]", cells_of(results, [&](const auto& r) { return text(r, r.outcome.wall_s); }));
  add_column(table, "processor", cells_of(results, [](const PointResult& r) { return r.cpu; }));
  return table;
}

}  // namespace supple
