#include "output/pages/run_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "output/files/json_text.h"
#include "output/files/markup.h"
#include "output/pages/run_graphs.h"
#include "output/run/run_folder.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view style_sheet = R"css(
:root { --ink: #1d1f21; --soft: #63686e; --line: #d9dbde; --faint: #f5f6f7; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1.5rem 1rem 3rem; max-width: 62rem; color: var(--ink); background: #fff;
  font: 1rem/1.5 "Source Sans 3", "Source Sans Pro", Lato, "Helvetica Neue", Helvetica, Arial, "Liberation Sans", sans-serif; }
h1 { font-size: 1.6rem; line-height: 1.2; margin: 0 0 0.3rem; }
h2 { font-size: 1.1rem; margin: 2rem 0 0.5rem; }
p { margin: 0 0 0.6rem; }
.soft { color: var(--soft); }
.warning { padding: 0.5rem 0.8rem; border-left: 4px solid #d55e00; background: #fdf3ec; overflow-wrap: anywhere; }
video, .picture { display: block; width: 100%; height: auto; border-radius: 4px; background: var(--faint); margin: 1rem 0; }
.graph { margin: 0 0 1.4rem; }
.legend { display: flex; flex-wrap: wrap; gap: 0.1rem 1rem; font-size: 0.85rem; margin: 0 0 0.3rem 3.6rem; }
.legend b { font-weight: 600; }
.legend i { display: inline-block; width: 0.9rem; height: 3px; margin-right: 0.35rem; vertical-align: middle; }
.legend output { display: inline-block; min-width: 4.2rem; font-variant-numeric: tabular-nums; }
.area { position: relative; height: 9rem; margin-left: 3.6rem; border-left: 1px solid var(--line); border-bottom: 1px solid var(--line);
  cursor: crosshair; touch-action: pan-y; }
.area svg { position: absolute; inset: 0; width: 100%; height: 100%; overflow: visible; }
.area path { fill: none; stroke-width: 1.6; vector-effect: non-scaling-stroke; }
.tick { position: absolute; right: 100%; width: 3.4rem; margin-right: 0.3rem; text-align: right; font-size: 0.75rem; line-height: 1;
  transform: translateY(-50%); color: var(--soft); font-variant-numeric: tabular-nums; }
.rule { position: absolute; left: 0; right: 0; border-top: 1px solid #eceef0; }
.cursor { position: absolute; top: 0; bottom: 0; width: 0; border-left: 1.5px solid #1d1f21; pointer-events: none; }
.times { display: flex; justify-content: space-between; margin-left: 3.6rem; font-size: 0.75rem; color: var(--soft); }
.box { overflow-x: auto; }
table { border-collapse: collapse; font-size: 0.875rem; font-variant-numeric: tabular-nums; }
th, td { padding: 0.25rem 0.7rem; text-align: right; white-space: nowrap; border-bottom: 1px solid var(--line); }
tbody tr[data-frame] { cursor: pointer; }
tbody tr[data-frame]:hover { background: var(--faint); }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 0.1rem 1rem; font-size: 0.9rem; margin: 0; }
dt { color: var(--soft); }
dd { margin: 0; overflow-wrap: anywhere; }
pre { white-space: pre-wrap; overflow-wrap: anywhere; font-size: 0.8rem; background: var(--faint); padding: 0.8rem; border-radius: 4px; }
@media (max-width: 36rem) {
  dl { grid-template-columns: 1fr; }
  dd { margin-bottom: 0.3rem; }
  .legend, .times { margin-left: 2.9rem; }
  .area { margin-left: 2.9rem; height: 7rem; }
  .tick { width: 2.7rem; }
}
)css";

// The film's time moves the cursors; a click on a graph or on a row of the table moves the film.
constexpr std::string_view script = R"js(
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const film = document.querySelector("video");
const areas = [...document.querySelectorAll(".area")];
const last = data.frames - 1;
let shown = 0;
function text(value) {
  if (value === null) return "–";
  const size = Math.abs(value);
  return size !== 0 && (size < 0.01 || size >= 1e5) ? value.toExponential(1) : String(+value.toPrecision(3));
}
function show(frame) {
  shown = Math.min(last, Math.max(0, frame));
  for (const area of areas) area.querySelector(".cursor").style.left = 100 * (last ? shown / last : 0) + "%";
  for (const out of document.querySelectorAll(".legend output")) out.value = text(data.series[out.dataset.series][shown]);
  for (const out of document.querySelectorAll("output.frame")) out.value = "Shown: frame " + shown + ", " + data.times[shown].toFixed(2) + " s.";
}
function seek(frame) {
  if (film) { film.pause(); film.currentTime = (frame + 0.5) / data.rate; }
  show(frame);
}
for (const area of areas) {
  const move = event => {
    const box = area.getBoundingClientRect();
    seek(Math.min(last, Math.max(0, Math.round((event.clientX - box.left) / box.width * last))));
  };
  area.addEventListener("pointerdown", event => { area.setPointerCapture(event.pointerId); move(event); });
  area.addEventListener("pointermove", event => { if (event.buttons) move(event); });
}
for (const row of document.querySelectorAll("tr[data-frame]")) row.addEventListener("click", () => seek(+row.dataset.frame));
document.addEventListener("keydown", event => {
  if (event.target === film || (event.key !== "ArrowLeft" && event.key !== "ArrowRight")) return;
  event.preventDefault();
  seek(shown + (event.key === "ArrowLeft" ? -1 : 1));
});
function follow() {
  if (film && !film.paused) show(Math.floor(film.currentTime * data.rate + 1e-6));
  requestAnimationFrame(follow);
}
if (film) film.addEventListener("seeked", () => { if (film.paused) show(Math.floor(film.currentTime * data.rate + 1e-6)); });
show(0);
follow();
)js";

std::string file_as_base64(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  return base64_text({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

std::string film_html(const RunRecord& run) {
  std::error_code error;
  const auto picture_of = [&](std::size_t frame) {
    return picture_file(run.folder / "frames", static_cast<int>(frame));
  };
  const bool poster = std::filesystem::exists(picture_of(0), error);
  for (const char* kind : {"mp4", "webm"}) {
    const std::filesystem::path film = run.folder / (std::string("video.") + kind);
    if (!std::filesystem::exists(film, error)) continue;
    return fmt::format(
        "<video controls loop muted playsinline preload=\"auto\" {} src=\"data:video/{};base64,{}\"></video>\n",
        poster ? "poster=\"data:image/png;base64," + file_as_base64(picture_of(0)) + "\"" : "", kind,
        file_as_base64(film));
  }
  if (std::filesystem::exists(run.folder / "video.gif", error))
    return fmt::format("<img class=\"picture\" alt=\"the film\" src=\"data:image/gif;base64,{}\">\n",
                       file_as_base64(run.folder / "video.gif"));
  if (run.rows.empty() || !std::filesystem::exists(picture_of(run.rows.size() - 1), error))
    return "<p class=\"soft\">This run has no film.</p>\n";
  return fmt::format(
      "<img class=\"picture\" alt=\"the last frame\" src=\"data:image/png;base64,{}\">\n"
      "<p class=\"soft\">This run has no film; this is its last picture.</p>\n",
      file_as_base64(picture_of(run.rows.size() - 1)));
}

constexpr std::array slowest_heads = {"all stages [ms]", "solving", "of it evaluating", "of it linear solves",
                                      "of it contacts",  "changes", "drawing",          "compressing",
                                      "iterations",      "trials"};
constexpr std::size_t first_count = 8;  // of the heads: those before it are milliseconds

double of_all_stages(const FrameRow& row) {
  return row.step_ms + row.change_ms.value_or(0) + row.draw_ms.value_or(0) + row.render_ms.value_or(0) +
         row.compress_ms.value_or(0);
}

// Returns the values of a frame below those heads.
std::vector<std::optional<double>> slowest_cells(const FrameRow& row) {
  double evaluating = 0, solving = 0;
  std::optional<double> colliding, drawing;
  int iterations = 0, trials = 0;
  for (const BodyRow& body : row.bodies) {
    evaluating += body.evaluate_ms;
    solving += body.solve_ms;
    iterations += body.iterations;
    trials += body.line_search;
    if (body.contact) colliding = colliding.value_or(0) + body.contact->collide_ms;
  }
  if (row.render_ms) drawing = row.draw_ms.value_or(0) + *row.render_ms;
  return {of_all_stages(row), row.step_ms, evaluating,      solving,    colliding,
          row.change_ms,      drawing,     row.compress_ms, iterations, trials};
}

std::string slowest_html(const std::vector<FrameRow>& rows) {
  std::vector<const FrameRow*> slowest;
  for (const FrameRow& row : rows) slowest.push_back(&row);
  std::ranges::stable_sort(slowest,
                           [](const FrameRow* a, const FrameRow* b) { return of_all_stages(*a) > of_all_stages(*b); });
  slowest.resize(std::min<std::size_t>(slowest.size(), 10));
  std::vector<std::vector<std::optional<double>>> values;
  for (const FrameRow* row : slowest) values.push_back(slowest_cells(*row));
  std::string html = "<h2>Slowest frames</h2><div class=\"box\"><table><thead><tr><th>frame</th>";
  std::vector<std::size_t> columns;  // that have a value in some row
  for (std::size_t c = 0; c < slowest_heads.size(); ++c) {
    if (std::ranges::none_of(values, [c](const auto& row) { return row[c].has_value(); })) continue;
    columns.push_back(c);
    html += fmt::format("<th>{}</th>", slowest_heads[c]);
  }
  html += "</tr></thead><tbody>\n";
  for (std::size_t r = 0; r < slowest.size(); ++r) {
    html += fmt::format("<tr data-frame=\"{0}\"><td>{0}</td>", slowest[r]->frame);
    for (const std::size_t c : columns) {
      const int digits = c < first_count ? 1 : 0;
      html += values[r][c] ? fmt::format("<td>{:.{}f}</td>", *values[r][c], digits) : std::string("<td>–</td>");
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string text_at(const Json& json, const char* key) {
  if (!json.contains(key)) return "";
  return json[key].is_string() ? json[key].get<std::string>() : json_text(json[key]);
}

std::string facts_html(const Json& info) {
  std::string html = "<h2>What was run</h2><dl>\n";
  const auto add = [&html](const std::string& name, const std::string& value) {
    if (!value.empty()) html += "<dt>" + markup_text(name) + "</dt><dd>" + markup_text(value) + "</dd>\n";
  };
  std::string command;
  for (const Json& word : info.value("command", Json::array()))
    command += (command.empty() ? "" : " ") + word.get<std::string>();
  add("command", command);
  add("scene", text_at(info, "scene_file"));
  for (const Json& mesh : info.value("meshes", Json::array()))
    add("body " + text_at(mesh, "body"), fmt::format("{} vertices, {} elements ({})", text_at(mesh, "vertices"),
                                                     text_at(mesh, "elements"), text_at(mesh, "source")));
  const Json program = info.value("program", Json::object()), machine = info.value("machine", Json::object());
  add("program", fmt::format("supple {}, {} kernels, {}", text_at(program, "version"), text_at(program, "kernels"),
                             text_at(program, "build")));
  add("machine", fmt::format("{}, {} threads", text_at(machine, "cpu"), text_at(machine, "threads")));
  if (info.contains("gl")) add("drawn by", text_at(info["gl"], "renderer"));
  html += "</dl>\n";
  for (const char* part : {"scene", "replay"}) {
    if (info.contains(part))
      html += fmt::format("<details><summary>The {} as it was read</summary><pre>{}</pre></details>\n", part,
                          markup_text(json_text(info[part], 1)));
  }
  return html;
}

// Everything in a JSON text that a page's script reads must not end the element that holds it.
std::string data_html(const std::vector<FrameGraph>& graphs, const std::vector<FrameRow>& rows, double rate) {
  Json times = Json::array();
  for (const FrameRow& row : rows) times.push_back(row.time_s);
  Json series = Json::array();
  for (const FrameGraph& graph : graphs) {
    for (const FrameSeries& one : graph.series) {
      Json values = Json::array();
      for (const double value : one.values) values.push_back(std::isfinite(value) ? Json(value) : Json(nullptr));
      series.push_back(std::move(values));
    }
  }
  const Json data = {{"frames", rows.size()}, {"rate", rate}, {"times", times}, {"series", series}};
  return "<script type=\"application/json\" id=\"data\">" + json_text(data) + "</script>\n";
}

// Tells whether the frames but the first took longer to make than they last. Only then it is worth saying what helps.
bool is_slower_than_asked(const std::vector<FrameRow>& rows) {
  double sum_ms = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) sum_ms += of_all_stages(rows[i]);
  return rows.size() > 1 && sum_ms > 1000 * (rows.back().time_s - rows.front().time_s);
}

std::string warnings_html(const RunRecord& run) {
  const auto profile = json_object_in<Json>(run.folder / "profile.json");
  std::string html;
  if (is_slower_than_asked(run.rows) && profile.is_object() && profile.contains("summary") &&
      profile["summary"].contains("verdict"))
    html += "<p class=\"soft\">" + markup_text(text_at(profile["summary"], "verdict")) + "</p>\n";
  for (const std::string& warning : warnings_of(run.rows))
    html += "<p class=\"warning\">" + markup_text(warning) + "</p>\n";
  return html;
}

}  // namespace

std::string run_page(const RunRecord& run) {
  const Json info = parsed_json<Json>(run.info_json);
  const Json scene = info.value("scene", Json::object());
  std::string title = scene.is_object() ? text_at(scene, "title") : "";
  if (title.empty()) title = std::filesystem::path(text_at(info, "scene_file")).stem().string();
  const std::size_t frames = run.rows.size();
  const double rate = frames > 0 && run.rows.front().time_s > 0 ? 1 / run.rows.front().time_s : 30;
  const double seconds = static_cast<double>(frames) / rate;
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<title>" +
      markup_text(title) + "</title>\n<style>" + std::string(style_sheet) + "</style></head><body>\n";
  html += "<h1>" + markup_text(title) + "</h1>\n";
  html += fmt::format("<p class=\"soft\">{} frames, {:.3g} s of film; {}. <output class=\"frame\"></output></p>\n",
                      frames, seconds, markup_text(run.ended()));
  html += warnings_html(run) + film_html(run);
  std::vector<FrameGraph> graphs;
  if (frames > 0) {
    graphs = graphs_of(run.rows);
    std::size_t first = 0;
    for (const FrameGraph& graph : graphs) {
      html += graph_html(graph, first, run.rows.front().time_s, run.rows.back().time_s);
      first += graph.series.size();
    }
    html += slowest_html(run.rows);
  }
  html += facts_html(info);
  html += data_html(graphs, run.rows, rate) + "<script>" + std::string(script) + "</script></body></html>\n";
  return html;
}

}  // namespace supple
