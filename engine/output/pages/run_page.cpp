#include "output/pages/run_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "output/files/json_text.h"
#include "output/files/markup.h"
#include "output/pages/page_parts.h"
#include "output/pages/run_graphs.h"
#include "output/run/run_folder.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view style_sheet = R"css(
body { padding: 1rem 1rem 3rem; max-width: 62rem; }
h1 { font-size: 1.6rem; line-height: 1.2; margin: 0 0 0.3rem; }
h2 { font-size: 1.1rem; margin: 2rem 0 0.5rem; }
p { margin: 0 0 0.6rem; }
.warning { padding: 0.5rem 0.8rem; border-left: 4px solid var(--mark); background: var(--warm); overflow-wrap: anywhere; }
video, .picture { display: block; max-width: 100%; max-height: 80vh; height: auto; border-radius: 4px; background: var(--faint);
  margin: 0 auto 0.5rem; }
video { width: 100%; object-fit: contain; }
.keys { font-size: 0.85rem; text-align: center; margin-bottom: 1.2rem; }
kbd { font: inherit; padding: 0 0.35em; border: 1px solid var(--line); border-radius: 3px; background: var(--faint); }
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
.rule { position: absolute; left: 0; right: 0; border-top: 1px solid var(--rule); }
.cursor { position: absolute; top: 0; bottom: 0; width: 0; border-left: 1.5px solid var(--ink); pointer-events: none; }
.times { display: flex; justify-content: space-between; margin-left: 3.6rem; font-size: 0.75rem; color: var(--soft); }
th, td { padding: 0.25rem 0.7rem; text-align: right; white-space: nowrap; border-bottom: 1px solid var(--line); }
tbody tr[data-frame] { cursor: pointer; }
tbody tr[data-frame]:hover { background: var(--over); }
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
@media print {
  .picture { max-height: 10cm; }
  .area { height: 3.2cm; }
}
)css";

// The film's time moves the cursors; a click on a graph or on a row of the table moves the film. Keys move it wherever
// the focus is, but where they mean something else: in a table that they scroll, on a button, in the closed part of the
// page. On the film they mean the same as elsewhere, in place of what the browser would do with them there. On paper
// stands the picture that the film shows.
constexpr std::string_view script = R"js(
const data = JSON.parse(document.getElementById("data").textContent);
const film = document.querySelector("video");
const still = document.querySelector("img.paper");
const areas = [...document.querySelectorAll(".area")];
const last = data.frames - 1;
let shown = 0;
if (film && still) film.poster = still.src;
function text(value) {
  if (value === null) return "–";
  const size = Math.abs(value);
  return size !== 0 && (size < 0.01 || size >= 1e5) ? value.toExponential(1) : String(+value.toPrecision(3));
}
function show(frame) {
  if (last < 0) return;
  shown = Math.min(last, Math.max(0, frame));
  for (const area of areas) area.querySelector(".cursor").style.left = 100 * (last ? shown / last : 0) + "%";
  for (const out of document.querySelectorAll(".legend output")) out.value = text(data.series[out.dataset.series][shown]);
  for (const out of document.querySelectorAll("output.frame")) out.value = "Shown: frame " + shown + ", " + data.times[shown].toFixed(2) + " s.";
}
function seek(frame) {
  const to = Math.min(last, Math.max(0, frame));
  // A film that is at its end begins again where it loops, even while it stands: so it loops only while it plays.
  if (film) { film.pause(); film.loop = false; film.currentTime = (to + 0.5) / data.rate; }
  show(to);
}
for (const area of areas) {
  const move = event => {
    const box = area.getBoundingClientRect();
    seek(Math.min(last, Math.max(0, Math.round((event.clientX - box.left) / box.width * last))));
  };
  area.addEventListener("pointerdown", event => { area.setPointerCapture(event.pointerId); move(event); });
  area.addEventListener("pointermove", event => { if (event.buttons) move(event); });
}
for (const row of document.querySelectorAll("tr[data-frame]")) {
  row.tabIndex = 0;
  row.addEventListener("click", () => seek(+row.dataset.frame));
}
const keys = {
  " ": () => { if (film) film.paused ? film.play() : film.pause(); },
  ArrowLeft: () => seek(shown - 1), ArrowRight: () => seek(shown + 1), Home: () => seek(0), End: () => seek(last),
};
document.addEventListener("keydown", event => {
  if (event.ctrlKey || event.altKey || event.metaKey || last < 0) return;
  const row = event.target.closest("tr[data-frame]");
  if (row && (event.key === "Enter" || event.key === " ")) {
    event.preventDefault();
    return seek(+row.dataset.frame);
  }
  const own = event.key === " " ? "button, summary, a, .box" : ".box";
  if (!(event.key in keys) || event.target.closest(own)) return;
  event.preventDefault();
  event.stopPropagation();
  keys[event.key]();
}, true);
function follow() {
  if (film && !film.paused) show(Math.floor(film.currentTime * data.rate + 1e-6));
  requestAnimationFrame(follow);
}
if (film) film.addEventListener("play", () => { film.loop = true; });
if (film) film.addEventListener("seeked", () => { if (film.paused) show(Math.floor(film.currentTime * data.rate + 1e-6)); });
window.addEventListener("beforeprint", () => {
  if (!film || !still || film.readyState < 2) return;
  const canvas = document.createElement("canvas");
  canvas.width = film.videoWidth;
  canvas.height = film.videoHeight;
  canvas.getContext("2d").drawImage(film, 0, 0);
  still.src = canvas.toDataURL("image/jpeg", 0.92);
});
show(0);
follow();
)js";

std::string film_html(const RunRecord& run) {
  std::error_code error;
  const auto picture_of = [&](std::size_t frame) {
    return picture_file(run.folder / "frames", static_cast<int>(frame));
  };
  const bool poster = std::filesystem::exists(picture_of(0), error);
  if (const std::optional<PageFilm> film = page_film(run.folder)) {
    // The still is the film's poster, and what paper shows of it.
    return fmt::format(
        "<video controls loop muted playsinline preload=\"auto\" src=\"{}\"></video>\n"
        "<img class=\"picture paper\" alt=\"a picture of the film\"{}>\n"
        "<p class=\"soft keys screen\"><kbd>Space</kbd> plays and stops, <kbd>←</kbd> <kbd>→</kbd> step by one frame, "
        "<kbd>Home</kbd> <kbd>End</kbd> go to the first and the last.</p>\n",
        data_address(film->file, film->type),
        poster ? " src=\"" + data_address(picture_of(0), "image/png") + "\"" : "");
  }
  if (std::filesystem::exists(run.folder / "video.gif", error))
    return fmt::format("<img class=\"picture\" alt=\"the film\" src=\"{}\">\n",
                       data_address(run.folder / "video.gif", "image/gif"));
  const std::string why = std::filesystem::exists(run.folder / "video.mov", error)
                              ? "Browsers do not play the film of this run, video.mov"
                              : "This run has no film";
  if (run.rows.empty() || !std::filesystem::exists(picture_of(run.rows.size() - 1), error))
    return fmt::format("<p class=\"soft\">{}.</p>\n", why);
  return fmt::format(
      "<img class=\"picture\" alt=\"the last frame\" src=\"{}\">\n"
      "<p class=\"soft\">{}; this is its last picture.</p>\n",
      data_address(picture_of(run.rows.size() - 1), "image/png"), why);
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

// Writes the warnings that the profile has. A run that was killed has rows and no profile.
std::string warnings_html(const RunRecord& run) {
  const auto profile = json_object_in<Json>(run.folder / "profile.json");
  const Json summary = profile.is_object() ? profile.value("summary", Json::object()) : Json::object();
  std::string html;
  if (is_slower_than_asked(run.rows) && summary.contains("verdict"))
    html += "<p class=\"soft\">" + markup_text(text_at(summary, "verdict")) + "</p>\n";
  std::vector<std::string> warnings;
  if (summary.contains("warnings") && summary["warnings"].is_array()) {
    for (const Json& warning : summary["warnings"])
      if (warning.is_string()) warnings.push_back(warning);
  } else {
    warnings = warnings_of(run.rows);
  }
  for (const std::string& warning : warnings) html += "<p class=\"warning\">" + markup_text(warning) + "</p>\n";
  return html;
}

}  // namespace

std::string run_page(const RunRecord& run) {
  const Json info = parsed_json<Json>(run.info_json);
  const Json scene = info.value("scene", Json::object());
  std::string title = scene.is_object() ? text_at(scene, "title") : "";
  if (title.empty()) title = std::filesystem::path(text_at(info, "scene_file")).stem().string();
  const std::size_t frames = run.rows.size();
  const double rate = run.frame_rate().value_or(30);
  const double seconds = static_cast<double>(frames) / rate;
  std::string html = page_begin(title, style_sheet) + film_html(run);
  html += "<h1>" + markup_text(title) + "</h1>\n";
  html += fmt::format("<p class=\"soft\">{} frames, {:.3g} s of film; {}. <output class=\"frame\"></output></p>\n",
                      frames, seconds, markup_text(run.ended()));
  html += warnings_html(run);
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
  return html + data_html(graphs, run.rows, rate) + page_end(script);
}

}  // namespace supple
