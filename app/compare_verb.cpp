#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "app/verbs.h"
#include "base/console.h"
#include "base/error.h"
#include "base/text.h"
#include "output/files/json_text.h"
#include "output/files/whole_file.h"
#include "output/pages/report_table.h"
#include "output/run/run_comparison.h"

namespace supple {
namespace {

struct CompareOptions {
  std::string a, b, csv;
  bool json = false;
};

constexpr std::size_t most_differences = 24;  // in the text; --json has all

std::string states_text(const RunComparison& c) {
  std::string text;
  if (c.first_difference) {
    text = fmt::format("differ from frame {} on", *c.first_difference);
  } else {
    text = fmt::format("the same in {}", c.frames == 1 ? "the one frame" : fmt::format("all {} frames", c.frames));
  }
  if (c.frames_a != c.frames_b)
    text += fmt::format("; A has {} frames and B {}: the first {} are compared", c.frames_a, c.frames_b, c.frames);
  return text;
}

// Lists the bodies whose saved motion differs although their states do not; empty where there are none.
std::string motion_text(const RunComparison& c) {
  std::string text;
  for (const BodyComparison& body : c.bodies) {
    if (!c.only_motion_differs(body)) continue;
    const std::string what = body.first_difference
                                 ? fmt::format("differs from frame {} on", *body.first_difference)
                                 : fmt::format("has {} frames in A and {} in B", body.saved_a, body.saved_b);
    text +=
        fmt::format("  motion          motion/{}.pc2 {}, though the states do not differ there: a file was changed\n",
                    body.name, what);
  }
  return text;
}

std::string distance_table(const RunComparison& c) {
  std::string text = fmt::format("  {:<16}{:>12}{:>12}{:>8}{:>14}\n", "distance", "largest [m]", "over size", "frame",
                                 "rms there [m]");
  for (const BodyComparison& body : c.bodies) {
    if (body.distance.empty()) {
      text += fmt::format("  {:<16}{} vertices in A and {} in B: no distances\n", body.name, body.vertices_a,
                          body.vertices_b);
      continue;
    }
    const FrameDistance& worst = body.distance[body.worst_frame];
    text += fmt::format("  {:<16}{:>12.4g}{:>12.3g}{:>8}{:>14.4g}\n", body.name, worst.largest,
                        worst.largest / body.size, body.worst_frame, worst.rms);
  }
  for (const std::string& name : c.only_a) text += fmt::format("  {:<16}only in A\n", name);
  for (const std::string& name : c.only_b) text += fmt::format("  {:<16}only in B\n", name);
  return text;
}

std::string differences_text(const RunComparison& c) {
  if (c.differences.empty()) return "  run.json        the same program, machine and scene\n";
  std::string text = "  run.json        A and B differ in\n";
  for (std::size_t i = 0; i < std::min(c.differences.size(), most_differences); ++i) {
    const JsonDifference& d = c.differences[i];
    text += fmt::format("    {}: {} and {}\n", d.path, d.a, d.b);
  }
  if (c.differences.size() > most_differences)
    text += fmt::format("    and {} more (--json has all)\n", c.differences.size() - most_differences);
  return text;
}

// Compares the times of steps: those of all bodies together where both runs have the same bodies, and otherwise those
// of each body that both have.
std::string times_text(const RunComparison& c) {
  const auto line = [](const std::string& what, double a, double b) {
    return fmt::format("  {:<16}{:.3f} ms in A, {:.3f} ms in B: B takes {:.3f} times as long\n", what, a, b, b / a);
  };
  if (c.only_a.empty() && c.only_b.empty()) return line("median step", c.step_ms_a, c.step_ms_b);
  std::string text = "  median step     of the bodies that both have; the others' times cannot be compared\n";
  for (const BodyComparison& body : c.bodies) text += line("  " + body.name, body.step_ms_a, body.step_ms_b);
  return text;
}

// Returns the line about clocks that do not agree, as those of a run and of one that goes on from its middle; empty
// where they do.
std::string clock_text(const RunRecord& a, const RunRecord& b) {
  if (a.rows.empty() || b.rows.empty() || a.rows.front().time_s == b.rows.front().time_s) return "";
  return fmt::format(
      "  clock           frame 0 is at {:.4g} s in A and at {:.4g} s in B: frames are compared by their numbers\n",
      a.rows.front().time_s, b.rows.front().time_s);
}

std::string text_of(const RunRecord& a, const RunRecord& b, const RunComparison& c) {
  std::string text =
      fmt::format("  A               {} ({}, {})\n", a.folder.string(), count_text(c.frames_a, "frame"), a.ended());
  text += fmt::format("  B               {} ({}, {})\n", b.folder.string(), count_text(c.frames_b, "frame"), b.ended());
  text += clock_text(a, b);
  text += fmt::format("  states          {}\n{}\n{}\n", states_text(c), motion_text(c), distance_table(c));
  text += times_text(c) + "\n";
  return text + differences_text(c);
}

std::string json_of(const RunRecord& a, const RunRecord& b, const RunComparison& c) {
  using Json = nlohmann::ordered_json;
  Json json = {{"a", a.folder.string()},
               {"b", b.folder.string()},
               {"same_states", c.same_states()},
               {"same_motion", c.same_motion()}};
  json["frames"] = {{"a", c.frames_a}, {"b", c.frames_b}, {"compared", c.frames}};
  json["first_difference"] = c.first_difference ? Json(*c.first_difference) : Json(nullptr);
  json["bodies"] = Json::array();
  for (const BodyComparison& body : c.bodies) {
    Json row = {
        {"name", body.name}, {"vertices", {{"a", body.vertices_a}, {"b", body.vertices_b}}}, {"size_m", body.size}};
    row["median_step_ms"] = {{"a", body.step_ms_a}, {"b", body.step_ms_b}};
    row["saved_frames"] = {{"a", body.saved_a}, {"b", body.saved_b}};
    if (!body.distance.empty()) {
      const FrameDistance& worst = body.distance[body.worst_frame];
      row["first_difference"] = body.first_difference ? Json(*body.first_difference) : Json(nullptr);
      row["frame"] = body.worst_frame;
      row["largest_m"] = worst.largest;
      row["rms_m"] = worst.rms;
    }
    json["bodies"].push_back(row);
  }
  json["only_a"] = c.only_a;
  json["only_b"] = c.only_b;
  json["median_step_ms"] = {{"a", c.step_ms_a}, {"b", c.step_ms_b}, {"ratio", c.step_ms_b / c.step_ms_a}};
  json["differences"] = Json::array();
  for (const JsonDifference& d : c.differences)
    json["differences"].push_back({{"path", d.path}, {"a", d.a}, {"b", d.b}});
  return json_text(json) + "\n";
}

std::string csv_of(const RunComparison& c) {
  std::vector<std::vector<std::string>> records = {
      {"frame", "time_s", "body", "largest_m", "rms_m", "largest_over_size", "rms_over_size"}};
  for (int frame = 0; frame < c.frames; ++frame) {
    for (const BodyComparison& body : c.bodies) {
      if (body.distance.empty()) continue;
      const FrameDistance& d = body.distance[frame];
      records.push_back({fmt::format("{}", frame), fmt::format("{}", c.time_s[frame]), body.name,
                         fmt::format("{}", d.largest), fmt::format("{}", d.rms),
                         fmt::format("{}", d.largest / body.size), fmt::format("{}", d.rms / body.size)});
    }
  }
  return csv_text(records);
}

// Writes the distances. A file that cannot be written is reported as wrong input, because exit status 1 means that the
// runs differ.
void write_csv(const std::string& file, const RunComparison& comparison) {
  try {
    write_whole_file(file, csv_of(comparison));
  } catch (const RunError& error) {
    throw InputError("--csv", error.what());
  }
}

int compare(const CompareOptions& options) {
  const RunRecord a = read_run(options.a), b = read_run(options.b);
  const RunComparison comparison = compare_runs(a, b);
  if (!options.csv.empty()) write_csv(options.csv, comparison);
  say(stdout, options.json ? json_of(a, b, comparison) : text_of(a, b, comparison));
  return comparison.same_states() && comparison.same_motion() ? 0 : 1;
}

}  // namespace

void add_compare(CommandLine& line) {
  auto options = std::make_shared<CompareOptions>();
  Verb verb = line.verb("compare", "Two runs: the first frame that differs, distances, timing.");
  verb.footer(
      "Example: supple compare out/squirrel out/squirrel-2 --csv distances.csv\n"
      "Distances are between equal vertices of the saved motion (single precision); size is the diagonal of the box "
      "around a body in A's first frame.\n"
      "Exit status: 0 the same bodies, frames, states and saved motion; 1 they differ; 2 a folder cannot be read as a "
      "run's.");
  verb.option("RUN_A", options->a, "folder that supple render left").required();
  verb.option("RUN_B", options->b, "the other one").required();
  verb.option("--csv", options->csv, "file for the distances, a row a frame and body");
  verb.flag("--json", options->json, "the result as one line of JSON");
  verb.runs([options] { return compare(*options); });
}

}  // namespace supple
