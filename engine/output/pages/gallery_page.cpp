#include "output/pages/gallery_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "output/files/json_text.h"
#include "output/files/markup.h"
#include "output/pages/page_parts.h"
#include "output/run/profile.h"
#include "output/run/run_record.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view gallery_style = R"css(
body { padding: 1.5rem 1rem 3rem; max-width: 84rem; }
h1 { font-size: 1.6rem; line-height: 1.2; margin: 0 0 0.3rem; }
h2 { font-size: 1.1rem; margin: 2.5rem 0 0.5rem; }
p { margin: 0 0 1rem; }
.cards { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(22rem, 100%), 1fr)); gap: 1.6rem 1.2rem; }
.card { display: flex; flex-direction: column; min-width: 0; scroll-margin-top: 1rem; }
.view { position: relative; aspect-ratio: 16 / 9; background: var(--faint); border-radius: 6px; overflow: hidden; display: flex;
  align-items: center; justify-content: center; }
.view.film { cursor: pointer; }
.view.film::after { content: "▶"; position: absolute; right: 0.6rem; top: 0.6rem; width: 1.9rem; height: 1.9rem; border-radius: 50%;
  background: rgba(29, 31, 33, 0.62); color: #fff; font-size: 0.75rem; line-height: 1.9rem; text-align: center; text-indent: 0.12em;
  transition: opacity 0.2s; pointer-events: none; }
.view.playing::after { opacity: 0; }
.view video:focus-visible { outline-offset: -3px; }
.view video, .view img { width: 100%; height: 100%; object-fit: contain; }
.view span { color: var(--soft); }
.card h3 { font-size: 1rem; line-height: 1.3; font-weight: 600; margin: 0.6rem 0 0.15rem; }
.card code { font-size: 0.8rem; color: var(--soft); }
.figures { display: flex; flex-wrap: wrap; gap: 0 1rem; margin: 0.15rem 0 0; font-size: 0.85rem; color: var(--soft);
  font-variant-numeric: tabular-nums; }
.figures b { font-weight: 600; color: var(--ink); }
.trouble { margin: 0.3rem 0 0; padding: 0.35rem 0.6rem; border-left: 4px solid var(--bad); background: var(--warm);
  font-size: 0.85rem; overflow-wrap: anywhere; }
th, td { padding: 0.25rem 0.8rem; text-align: right; white-space: nowrap; border-bottom: 1px solid var(--line); }
th:first-child, td:first-child { text-align: left; padding-left: 0; position: sticky; left: 0; background: var(--paper); }
th { font-weight: 600; vertical-align: bottom; }
td a { color: inherit; }
.bad { color: var(--bad); }
@media print {
  .cards { grid-template-columns: 1fr 1fr; gap: 0.5cm; }
  .view.film::after { display: none; }
}
)css";

// A film plays while the pointer is over it. A click, a tap or the keys for buttons start and stop it for good, and a
// double click fills the screen with it. The keys of a film's own page step it.
constexpr std::string_view gallery_script = R"js(
for (const film of document.querySelectorAll("video")) {
  const view = film.parentElement, still = view.querySelector("img"), rate = +film.dataset.rate;
  let byHand = false;
  const toggle = () => { byHand = film.paused || !byHand; byHand ? film.play() : film.pause(); };
  const seek = frame => {
    const last = Math.round(film.duration * rate) - 1;
    byHand = false;
    film.pause();
    film.loop = false;  // one that loops would begin again at its end, even while it stands
    film.currentTime = (Math.min(last, Math.max(0, frame(Math.floor(film.currentTime * rate + 1e-6), last))) + 0.5) / rate;
  };
  const keys = {
    Enter: toggle, " ": toggle, Home: () => seek(() => 0), End: () => seek((now, last) => last),
    ArrowLeft: () => seek(now => now - 1), ArrowRight: () => seek(now => now + 1),
  };
  if (still) film.poster = still.src;
  film.addEventListener("play", () => { film.loop = true; view.classList.add("playing"); });
  film.addEventListener("pause", () => view.classList.remove("playing"));
  film.addEventListener("pointerenter", event => { if (event.pointerType === "mouse" && film.paused) film.play(); });
  film.addEventListener("pointerleave", event => { if (event.pointerType === "mouse" && !byHand) film.pause(); });
  film.addEventListener("click", toggle);
  film.addEventListener("dblclick", () => film.requestFullscreen());
  film.addEventListener("keydown", event => {
    if (!(event.key in keys) || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    keys[event.key]();
  });
}
)js";

// Holds what is known of a scene's run.
struct Figures {
  RunRecord run;
  int bodies = 0, vertices = 0, elements = 0;
  double fps = 30;
  Distribution solving;                       // [ms]
  std::optional<double> error, motion_error;  // the largest estimates
};

std::optional<Figures> figures_of(const GalleryScene& scene) {
  std::error_code error;
  if (scene.folder.empty() || !std::filesystem::exists(scene.folder / "run.json", error)) return std::nullopt;
  Figures figures;
  figures.run = read_run(scene.folder);
  const Json info = parsed_json<Json>(figures.run.info_json);
  for (const Json& mesh : info.value("meshes", Json::array())) {
    ++figures.bodies;
    figures.vertices += mesh.value("vertices", 0);
    figures.elements += mesh.value("elements", 0);
  }
  std::vector<double> times;
  for (const FrameRow& row : figures.run.rows) {
    times.push_back(row.step_ms);
    for (const BodyRow& body : row.bodies) {
      figures.error = std::max(figures.error.value_or(0), body.error_estimate);
      figures.motion_error = std::max(figures.motion_error.value_or(0), body.motion_estimate);
    }
  }
  figures.fps = figures.run.frame_rate().value_or(figures.fps);
  figures.solving = distribution_of(times);
  return figures;
}

std::optional<PageFilm> film_of(const GalleryScene& scene) {
  return scene.folder.empty() ? std::nullopt : page_film(scene.folder);
}

// fps: of the film.
std::string view_html(const GalleryScene& scene, double fps) {
  std::error_code error;
  const std::filesystem::path poster = scene.folder / "poster.png";
  const bool has_poster = !scene.folder.empty() && std::filesystem::exists(poster, error);
  if (const std::optional<PageFilm> film = film_of(scene))
    return fmt::format(
        "<video tabindex=\"0\" aria-label=\"{}\" data-rate=\"{}\" loop muted playsinline preload=\"metadata\" "
        "src=\"{}\"></video>{}",
        markup_text(scene.name), fps, data_address(film->file, film->type),
        has_poster ? "<img class=\"paper\" alt=\"\" src=\"" + data_address(poster, "image/png") + "\">" : "");
  if (has_poster)
    return fmt::format("<img alt=\"{}\" src=\"{}\">", markup_text(scene.name), data_address(poster, "image/png"));
  return "<span>no picture</span>";
}

std::string card_html(const GalleryScene& scene, const std::optional<Figures>& figures) {
  std::string html =
      fmt::format("<section class=\"card\" id=\"{0}\"><div class=\"view{3}\">{1}</div>\n<h3>{2}</h3><code>{0}</code>\n",
                  markup_text(scene.name), view_html(scene, figures ? figures->fps : 30),
                  markup_text(scene.title.empty() ? scene.name : scene.title), film_of(scene) ? " film" : "");
  if (figures && !figures->run.rows.empty())
    html += fmt::format(
        "<p class=\"figures\"><span><b>{:.3g} ms</b> of solving a frame</span><span><b>{}</b> vertices</span>"
        "<span><b>{:.3g} s</b> of film</span></p>\n",
        figures->solving.p50, figures->vertices, static_cast<double>(figures->run.rows.size()) / figures->fps);
  if (!scene.trouble.empty()) html += "<p class=\"trouble\">" + markup_text(scene.trouble) + "</p>\n";
  return html + "</section>\n";
}

// Returns a cell with a number, which sorts by its value.
std::string cell(const std::optional<double>& value, const char* format) {
  if (!value) return "<td data-value=\"\">–</td>";
  return fmt::format("<td data-value=\"{}\">{}</td>", *value, fmt::format(fmt::runtime(format), *value));
}

std::string row_html(const GalleryScene& scene, const std::optional<Figures>& figures) {
  std::string html = fmt::format("<tr><td data-value=\"{0}\"><a href=\"#{0}\">{0}</a></td>", markup_text(scene.name));
  const bool filmed = figures && !figures->run.rows.empty();
  const auto if_filmed = [filmed](double value) { return filmed ? std::optional(value) : std::nullopt; };
  const Figures none;
  const Figures& f = figures ? *figures : none;
  const auto frames = static_cast<double>(f.run.rows.size());
  html += cell(if_filmed(f.bodies), "{:.0f}") + cell(if_filmed(f.vertices), "{:.0f}") +
          cell(if_filmed(f.elements), "{:.0f}") + cell(if_filmed(frames), "{:.0f}") +
          cell(if_filmed(f.solving.p50), "{:.2f}") + cell(if_filmed(f.solving.p95), "{:.2f}") +
          cell(if_filmed(f.solving.max), "{:.2f}") + cell(filmed ? f.error : std::nullopt, "{:.1e}") +
          cell(filmed ? f.motion_error : std::nullopt, "{:.1e}");
  return html + fmt::format("<td data-value=\"{0}\"{1}>{2}</td></tr>\n", scene.trouble.empty() ? 0 : 1,
                            scene.trouble.empty() ? "" : " class=\"bad\"",
                            scene.trouble.empty() ? "whole" : "not whole");
}

}  // namespace

std::string gallery_page(const std::string& heading, const std::string& note, const std::vector<GalleryScene>& scenes) {
  std::string html = page_begin(heading, gallery_style) + "<h1>" + markup_text(heading) + "</h1>\n<p class=\"soft\">" +
                     markup_text(note) + " <a href=\"#figures\">All figures</a></p>\n<main class=\"cards\">\n";
  std::string rows;
  for (const GalleryScene& scene : scenes) {
    const std::optional<Figures> figures = figures_of(scene);
    html += card_html(scene, figures);
    rows += row_html(scene, figures);
  }
  html += "</main>\n<h2 id=\"figures\">Figures</h2>\n<div class=\"box\"><table><thead><tr>";
  for (const char* head : {"scene", "bodies", "vertices", "elements", "frames", "solving, median [ms]", "95 % [ms]",
                           "slowest [ms]", "largest estimated error", "of motion", "film"})
    html += fmt::format("<th scope=\"col\">{}</th>", head);
  return html + "</tr></thead><tbody>\n" + rows + "</tbody></table></div>\n" + page_end(gallery_script);
}

}  // namespace supple
