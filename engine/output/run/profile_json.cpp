#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/hash.h"
#include "base/read_file.h"
#include "base/unsolved_step.h"
#include "output/files/json_text.h"
#include "output/run/frame_rows.h"
#include "output/run/profile.h"
#include "output/run/row_tally.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

// The functions add_...() put keys into the row of a body. Four digits after the point are plenty for times; numbers
// that may be compared keep all seventeen.
void add_step(const StepRow& step, Json& row) {
  row.update({{"step_ms", rounded_ms(step.step_ms)},
              {"evaluate_ms", rounded_ms(step.evaluate_ms)},
              {"solve_ms", rounded_ms(step.solve_ms)},
              {"lbfgs_ms", rounded_ms(step.lbfgs_ms)},
              {"matrix_ms", rounded_ms(step.matrix_ms)},
              {"other_ms", rounded_ms(step.other_ms)},
              {"iterations", step.iterations},
              {"newton_iterations", step.newton_iterations},
              {"line_search", step.line_search},
              {"objective_start", step.objective_start},
              {"objective_end", step.objective_end},
              {"error_estimate", step.error_estimate},
              {"motion_estimate", step.motion_estimate},
              {"unsolved", step.unsolved}});
  if (step.error_measured) row["error"] = step.error ? Json(*step.error) : Json(nullptr);
  if (step.motion_error) row["motion_error"] = *step.motion_error;
  if (!step.reference_converged) row["reference_converged"] = false;
}

void add_contact(const ContactRow& contact, Json& row) {
  row["collide_ms"] = rounded_ms(contact.collide_ms);
  row["contacts"] = contact.contacts;
  row["contact_changes"] = contact.changes;
  row["contact_cycles"] = contact.cycles;
  row["penetration"] = contact.penetration;
  row["colliders"] = Json::array();
  for (const ColliderRow& c : contact.colliders) {
    row["colliders"].push_back({{"name", c.name}, {"penetration", c.penetration}, {"force", c.force}});
    if (c.far_side > 0) row["colliders"].back()["far_side"] = c.far_side;
  }
}

void add_energy(const BodyRow& body, Json& row) {
  if (body.energy) {
    row["kinetic_energy"] = (*body.energy)[0];
    row["elastic_energy"] = (*body.energy)[1];
    row["gravitational_energy"] = (*body.energy)[2];
    row["spring_energy"] = (*body.energy)[3];
    row["contact_energy"] = (*body.energy)[4];
  }
  if (!body.balance) return;
  row["energy"] = {{"total", body.balance->total},
                   {"put_in", body.balance->put_in},
                   {"from_nothing", body.balance->from_nothing},
                   {"exchanged", body.balance->exchanged()},
                   {"held", body.balance->held},
                   {"worked", body.balance->worked}};
  if (body.balance->flowed) row["energy"]["lost_to_flow"] = *body.balance->flowed;
}

Json json_of(const BodyRow& body) {
  Json row = {{"name", body.name}};
  add_step(body, row);
  if (body.contact) add_contact(*body.contact, row);
  row["stretch"] = body.stretch;
  add_energy(body, row);
  if (body.inverted) row["inverted"] = *body.inverted;
  if (body.collapsed) row["collapsed"] = *body.collapsed;
  if (body.skin_excess) row["skin_excess"] = *body.skin_excess;
  if (body.in_picture) row["in_picture"] = *body.in_picture;
  if (body.jiggle) row["jiggle"] = *body.jiggle;
  if (body.open_seam) row["open_seam"] = *body.open_seam;
  row["stop_reason"] = body.stop_reason;
  if (!body.budget_cuts.empty()) row["budget_cuts"] = body.budget_cuts;
  return row;
}

Json json_of(const Distribution& d) {
  return {{"p50", rounded_ms(d.p50)}, {"p95", rounded_ms(d.p95)},   {"p99", rounded_ms(d.p99)},
          {"max", rounded_ms(d.max)}, {"mean", rounded_ms(d.mean)}, {"total", rounded_ms(d.total)}};
}

Json json_of(const PairRow& pair) {
  Json row = {
      {"bodies", pair.bodies}, {"contacts", pair.contacts}, {"penetration", pair.penetration}, {"force", pair.force}};
  if (pair.expected) row["expected"] = true;
  if (pair.coming_apart) row["coming_apart"] = true;
  return row;
}

Json json_of(const DeepRow& pair) { return {{"bodies", pair.bodies}, {"share", pair.share}, {"place", pair.place}}; }

Json json_of(const FrameRow& row) {
  Json frame = {{"frame", row.frame}, {"time_s", row.time_s}, {"step_ms", rounded_ms(row.step_ms)}};
  if (row.change_ms) frame["change_ms"] = rounded_ms(*row.change_ms);
  if (row.draw_ms) frame["draw_ms"] = rounded_ms(*row.draw_ms);
  if (row.render_ms) frame["render_ms"] = rounded_ms(*row.render_ms);
  if (row.compress_ms) frame["compress_ms"] = rounded_ms(*row.compress_ms);
  frame["state_hash"] = hash_text_form(row.state_hash);
  if (row.as_in_session) frame["as_in_session"] = *row.as_in_session;
  if (!row.passing.empty()) frame["met"] = row.passing;
  for (const DeepRow& pair : row.deep) frame["deep"].push_back(json_of(pair));
  for (const PairRow& pair : row.pairs) frame["pairs"].push_back(json_of(pair));
  frame["bodies"] = Json::array();
  for (const BodyRow& body : row.bodies) frame["bodies"].push_back(json_of(body));
  return frame;
}

template <class Number>
void read_if_there(const Json& json, const char* key, std::optional<Number>& value) {
  if (json.contains(key)) value = json.at(key).get<Number>();
}

// The functions read_...() and ..._row() read these keys. Keys with a default were not written by earlier programs.
void read_step(const Json& json, StepRow& row) {
  json.at("step_ms").get_to(row.step_ms);
  json.at("evaluate_ms").get_to(row.evaluate_ms);
  json.at("solve_ms").get_to(row.solve_ms);
  json.at("lbfgs_ms").get_to(row.lbfgs_ms);
  row.matrix_ms = json.value("matrix_ms", 0.0);
  json.at("other_ms").get_to(row.other_ms);
  json.at("iterations").get_to(row.iterations);
  row.newton_iterations = json.value("newton_iterations", 0);
  json.at("line_search").get_to(row.line_search);
  json.at("objective_start").get_to(row.objective_start);
  json.at("objective_end").get_to(row.objective_end);
  json.at("error_estimate").get_to(row.error_estimate);
  row.motion_estimate = json.value("motion_estimate", 0.0);
  read_if_there(json, "motion_error", row.motion_error);
  row.reference_converged = json.value("reference_converged", true);
  const int trials = row.newton_iterations > 0 ? 0 : row.line_search;
  row.unsolved = json.value("unsolved", is_unsolved(row.error_estimate, row.iterations, trials));
  row.error_measured = json.contains("error");
  if (row.error_measured && !json.at("error").is_null()) row.error = json.at("error").get<double>();
  json.at("stop_reason").get_to(row.stop_reason);
  if (json.contains("budget_cuts")) json.at("budget_cuts").get_to(row.budget_cuts);
}

ContactRow contact_row(const Json& json) {
  ContactRow row = {json.at("collide_ms").get<double>(), json.at("contacts").get<int>(),
                    json.at("contact_changes").get<int>(), json.at("contact_cycles").get<int>(),
                    json.at("penetration").get<double>()};
  for (const Json& c : json.value("colliders", Json::array())) {
    row.colliders.push_back({c.at("name").get<std::string>(), c.at("penetration").get<double>(),
                             c.at("force").get<double>(), c.value("far_side", 0.0)});
  }
  return row;
}

BodyRow body_row(const Json& json) {
  BodyRow row;
  read_step(json, row);
  json.at("name").get_to(row.name);
  if (json.contains("collide_ms")) row.contact = contact_row(json);
  json.at("stretch").get_to(row.stretch);
  if (json.contains("kinetic_energy")) {
    row.energy = {json.at("kinetic_energy").get<double>(), json.at("elastic_energy").get<double>(),
                  json.at("gravitational_energy").get<double>(), json.value("spring_energy", 0.0),
                  json.value("contact_energy", 0.0)};
  }
  if (json.contains("energy")) {
    const Json& energy = json.at("energy");
    row.balance = {energy.at("total").get<double>(), energy.at("put_in").get<double>(),
                   energy.at("from_nothing").get<double>(), energy.value("held", energy.at("exchanged").get<double>()),
                   energy.value("worked", 0.0)};
    if (energy.contains("lost_to_flow")) row.balance->flowed = energy.at("lost_to_flow").get<double>();
  }
  read_if_there(json, "inverted", row.inverted);
  read_if_there(json, "collapsed", row.collapsed);
  read_if_there(json, "skin_excess", row.skin_excess);
  read_if_there(json, "in_picture", row.in_picture);
  read_if_there(json, "jiggle", row.jiggle);
  read_if_there(json, "open_seam", row.open_seam);
  return row;
}

PairRow pair_row(const Json& json) {
  PairRow row;
  json.at("bodies").get_to(row.bodies);
  json.at("contacts").get_to(row.contacts);
  json.at("penetration").get_to(row.penetration);
  json.at("force").get_to(row.force);
  row.expected = json.value("expected", false);
  row.coming_apart = json.value("coming_apart", false);
  return row;
}

DeepRow deep_row(const Json& json) {
  DeepRow row;
  json.at("bodies").get_to(row.bodies);
  json.at("share").get_to(row.share);
  json.at("place").get_to(row.place);
  return row;
}

FrameRow frame_row(const Json& json) {
  FrameRow row;
  json.at("frame").get_to(row.frame);
  json.at("time_s").get_to(row.time_s);
  json.at("step_ms").get_to(row.step_ms);
  read_if_there(json, "change_ms", row.change_ms);
  read_if_there(json, "draw_ms", row.draw_ms);
  read_if_there(json, "render_ms", row.render_ms);
  read_if_there(json, "compress_ms", row.compress_ms);
  row.state_hash = std::stoull(json.at("state_hash").get<std::string>(), nullptr, 16);
  if (json.contains("as_in_session")) row.as_in_session = json.at("as_in_session").get<bool>();
  if (json.contains("met")) json.at("met").get_to(row.passing);
  for (const Json& pair : json.value("deep", Json::array())) row.deep.push_back(deep_row(pair));
  for (const Json& pair : json.value("pairs", Json::array())) row.pairs.push_back(pair_row(pair));
  for (const Json& body : json.at("bodies")) row.bodies.push_back(body_row(body));
  return row;
}

// Turns what the parsers of JSON and of numbers throw into a message about the file.
template <class Read>
auto as_input_errors(const std::string& source, const Read& read) {
  try {
    return read();
  } catch (const nlohmann::json::exception&) {
    throw InputError(source, "is not a profile as this version writes it");
  } catch (const std::logic_error&) {
    throw InputError(source, "is not a profile: a state_hash is not sixteen hexadecimal digits");
  }
}

// Puts spaces before each line.
std::string indented(const std::string& text, int spaces) {
  const std::string indent(std::size_t(spaces), ' ');
  std::string result = indent;
  for (const char c : text) {
    result += c;
    if (c == '\n') result += indent;
  }
  return result;
}

Json summary_json(const RowTally& tally, const std::string& verdict) {
  Json first, rest;
  for (const StageSummary& stage : tally.stages()) {
    first[stage.stage + "_ms"] = rounded_ms(stage.first);
    rest[stage.stage + "_ms"] = json_of(stage.rest);
  }
  Json summary = {{"frames", tally.frames()}, {"first_frame", first}, {"without_first_frame", rest}};
  for (const UnsolvedStep& step : tally.unsolved()) {
    summary["unsolved"].push_back({{"frame", step.frame},
                                   {"body", step.body},
                                   {"error_estimate", step.error_estimate},
                                   {"motion_estimate", step.motion_estimate},
                                   {"trials_per_iteration", step.trials}});
  }
  if (!verdict.empty()) summary["verdict"] = verdict;
  summary["warnings"] = tally.remarks();
  for (std::string& warning : tally.warnings()) summary["warnings"].push_back(std::move(warning));
  return summary;
}

}  // namespace

std::string row_line(const FrameRow& row) { return exact_json_text(json_of(row)); }

FrameRow row_of_line(const std::string& line, const std::string& source) {
  return as_input_errors(source, [&] { return frame_row(parsed_json<Json>(line)); });
}

std::vector<FrameRow> read_profile(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  return as_input_errors(path.string(), [&] {
    std::vector<FrameRow> rows;
    const Json document = parsed_json<Json>(text);
    for (const Json& frame : document.at("frames")) rows.push_back(frame_row(frame));
    return rows;
  });
}

void write_profile(const FrameRows& rows, const RowTally& tally, const std::string& verdict, const TakesText& take) {
  // A document of all rows would need many times the memory of the rows, so each frame is written by itself.
  take("{\n \"frames\": [");
  const char* before = "\n";
  rows.each([&](const FrameRow& row) {
    take(before);
    take(indented(exact_json_text(json_of(row), 1), 2));
    before = ",\n";
  });
  take(rows.empty() ? "],\n" : "\n ],\n");
  take(" \"summary\": " + indented(exact_json_text(summary_json(tally, verdict), 1), 1).substr(1) + "\n}\n");
}

std::string profile_json(const std::vector<FrameRow>& rows, const std::string& verdict) {
  std::string text;
  write_profile(FrameRows(rows), RowTally(rows), verdict, [&text](std::string_view piece) { text += piece; });
  return text;
}

}  // namespace supple
