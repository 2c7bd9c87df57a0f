#include "output/pages/report_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "base/error.h"
#include "output/files/markup.h"
#include "output/files/whole_file.h"
#include "output/pages/page_parts.h"

namespace supple {
namespace {

constexpr std::string_view report_style = R"css(
body { padding: 2.5rem 1.25rem 4rem; max-width: 74rem;
  font: 1.0625rem/1.6 Charter, "Bitstream Charter", "Source Serif 4", "Source Serif Pro", Georgia, "Liberation Serif", serif; }
h1, h2, h3, dt, dd, nav, table, figcaption, .note, .files, .missing { font-family: "Source Sans 3", "Source Sans Pro", "Lato",
  "Helvetica Neue", Helvetica, Arial, "Liberation Sans", sans-serif; }
p, h1, h2, h3, figcaption, .note { overflow-wrap: break-word; }
p { max-width: 44rem; margin: 0 0 1em; }
h1 { font-size: 2.1rem; line-height: 1.2; margin: 0 0 1.2rem; letter-spacing: -0.01em; }
h2 { font-size: 1.5rem; line-height: 1.25; margin: 3.5rem 0 1rem; padding-top: 1.1rem; border-top: 1px solid var(--line); }
h3 { font-size: 1.0625rem; line-height: 1.35; margin: 0; }
a { text-decoration-thickness: 1px; text-underline-offset: 0.15em; }
.lead p { font-size: 1.2rem; line-height: 1.5; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 0.15rem 1.25rem; margin: 1.75rem 0; padding: 0.9rem 1.1rem;
  background: var(--faint); border-radius: 4px; font-size: 0.9rem; line-height: 1.5; }
dt { color: var(--soft); }
dd { margin: 0; overflow-wrap: anywhere; }
nav { margin: 1.75rem 0; font-size: 0.95rem; line-height: 1.5; }
nav h2 { font-size: 1rem; margin: 0 0 0.4rem; padding: 0; border: 0; }
nav ol { margin: 0; padding-left: 1.4rem; }
nav ul { margin: 0 0 0.5rem; padding: 0; list-style: none; font-size: 0.875rem; columns: 22rem auto; column-gap: 2rem; }
nav ul a { color: var(--soft); text-decoration: none; }
nav ul a:hover { text-decoration: underline; }
figure { margin: 2.25rem 0; }
figcaption { max-width: 50rem; margin-bottom: 0.6rem; }
figcaption p, .note p { max-width: 50rem; margin: 0.35rem 0 0; font-size: 0.925rem; line-height: 1.5; }
.plot figcaption, .picture figcaption { margin: 0.4rem 0 0; }
.picture img { display: block; max-width: 100%; height: auto; }
.box { width: fit-content; max-height: 85vh; border: solid var(--line); border-width: 1px 0;
  /* a shadow at the side where there is more to scroll to */
  background: linear-gradient(to right, var(--paper) 40%, var(--clear)) left / 3rem 100% no-repeat local,
    linear-gradient(to left, var(--paper) 40%, var(--clear)) right / 3rem 100% no-repeat local,
    linear-gradient(to right, var(--shade), transparent) left / 0.9rem 100% no-repeat scroll,
    linear-gradient(to left, var(--shade), transparent) right / 0.9rem 100% no-repeat scroll; }
.plot .box { width: auto; max-width: 62rem; border: 0; max-height: none; }
.plot svg { display: block; width: 100%; min-width: 35rem; height: auto; }
.plot svg text { font-family: "Source Sans 3", "Source Sans Pro", "Lato", "Helvetica Neue", Helvetica, Arial, "Liberation Sans",
  sans-serif; }
table { line-height: 1.4; }
th, td { padding: 0.34rem 0.75rem; text-align: left; vertical-align: top; }
th { position: sticky; top: 0; vertical-align: bottom; background: var(--paper); font-weight: 600; box-shadow: inset 0 -1px var(--line); }
th .unit { color: var(--soft); font-weight: 400; white-space: nowrap; }
td { white-space: pre-line; }
td.long { min-width: 15rem; }
tbody tr:nth-child(even) { background: var(--stripe); }
tbody tr:hover { background: var(--over); }
.number { text-align: right; }
td.number, td.short { white-space: nowrap; }
th.row, td.row { color: var(--soft); font-weight: 400; padding-left: 0.4rem; text-align: right; }
.files { margin: 0.45rem 0 0; font-size: 0.8125rem; color: var(--soft); }
.missing { padding: 1rem 1.2rem; background: var(--faint); font-size: 0.925rem; max-width: none; }
@media (max-width: 40rem) {
  body { padding: 1.5rem 1rem 3rem; font-size: 1rem; }
  h1 { font-size: 1.6rem; }
  h2 { font-size: 1.3rem; margin-top: 2.5rem; }
  .lead p { font-size: 1.075rem; }
  dl { grid-template-columns: 1fr; gap: 0; }
  dd { margin-bottom: 0.4rem; }
  nav ul { display: none; }
  th, td { padding: 0.3rem 0.5rem; }
}
/* Plots are drawn for white paper: on a dark screen their lightness is turned round, and their hues stay. */
@media screen and (prefers-color-scheme: dark) { .plot svg { filter: invert(0.92) hue-rotate(180deg); } }
@media print {
  a { color: inherit; }
  nav { display: none; }
  .box { background: none; }
  td.long { min-width: 0; }
  .plot svg { min-width: 0; }
  figure.table { break-inside: auto; }
}
)css";

std::string paragraphs(const std::string& text) {
  std::string html;
  const auto add = [&](const std::string& paragraph) {
    if (paragraph.find_first_not_of(" \t\r\n") != std::string::npos) html += "<p>" + markup_text(paragraph) + "</p>\n";
  };
  std::string paragraph;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    if (line.find_first_not_of(" \t\r") == std::string::npos) {
      add(paragraph);
      paragraph.clear();
    } else {
      paragraph += (paragraph.empty() ? "" : "\n") + line;
    }
    at = end + 1;
  }
  add(paragraph);
  return html;
}

std::vector<std::size_t> shown_columns(const ReportTable& table) {
  std::vector<std::size_t> shown;
  for (const std::string& name : table.page_columns.empty() ? table.columns : table.page_columns) {
    const auto place = std::find(table.columns.begin(), table.columns.end(), name);
    SUPPLE_CHECK(name, ==, (place == table.columns.end() ? "a column of " + table.name : *place));
    shown.push_back(std::size_t(place - table.columns.begin()));
  }
  return shown;
}

// A column holds numbers when most of its cells begin like one: "12.3", "-4 %", "< 1e-9", "~2x".
bool holds_numbers(const ReportTable& table, std::size_t column) {
  std::ptrdiff_t numbers = 0, filled = 0;
  for (const auto& row : table.rows) {
    const std::string& cell = row[column];
    const std::size_t first = cell.find_first_not_of("+-<>~= ");
    filled += first != std::string::npos;
    numbers += first != std::string::npos && ((cell[first] >= '0' && cell[first] <= '9') || cell[first] == '.');
  }
  return 2 * numbers > filled;
}

// Tells how a column's cells are set: numbers to the right, short words on one line, long ones in a paragraph.
const char* column_kind(const ReportTable& table, std::size_t column) {
  if (holds_numbers(table, column)) return "number";
  for (const auto& row : table.rows)
    if (count_code_points(row[column]) > 32) return "long";
  return "short";
}

// Writes "time, ours [ms]" with the unit in a softer colour.
std::string header_text(const std::string& column) {
  const std::size_t unit = column.rfind(" [");
  if (unit == std::string::npos || column.back() != ']') return markup_text(column);
  return markup_text(column.substr(0, unit + 1)) + "<span class=\"unit\">" + markup_text(column.substr(unit + 1)) +
         "</span>";
}

// Rounds numbers with more digits than the page shows; other cells stay as they are.
std::string page_cell(const ReportTable& table, const std::string& cell) {
  if (table.page_digits == 0 || !reads_as_number(cell)) return cell;
  const std::string rounded = number_text(std::stod(cell), table.page_digits);
  return rounded.size() < cell.size() ? rounded : cell;
}

std::string table_grid(const ReportTable& table) {
  const std::vector<std::size_t> shown = shown_columns(table);
  std::string html = "<table>\n<thead><tr><th class=\"row\" scope=\"col\">" + markup_text(table.row_name) + "</th>";
  std::vector<const char*> kinds;
  for (const std::size_t column : shown) {
    kinds.push_back(column_kind(table, column));
    html += fmt::format("<th class=\"{}\" scope=\"col\">{}</th>", kinds.back(), header_text(table.columns[column]));
  }
  html += "</tr></thead>\n<tbody>\n";
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    html += fmt::format("<tr><td class=\"row\">{}</td>", table.first_row + i);
    for (std::size_t k = 0; k < shown.size(); ++k)
      html += fmt::format("<td class=\"{}\">{}</td>", kinds[k], markup_text(page_cell(table, table.rows[i][shown[k]])));
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table>";
}

std::string table_figure(const ReportTable& table) {
  const std::string columns =
      table.page_columns.empty() || table.page_columns.size() == table.columns.size()
          ? ""
          : fmt::format(", {} of {} columns shown", table.page_columns.size(), table.columns.size());
  return fmt::format(
      "<figure id=\"{0}\" class=\"table\">\n<figcaption><h3>{1}</h3></figcaption>\n"
      "<div class=\"box\" tabindex=\"0\">\n{2}\n</div>\n<div class=\"note\">\n{3}</div>\n"
      "<p class=\"files\">Data: <a href=\"{0}.csv\">{0}.csv</a>, <a href=\"{0}.json\">{0}.json</a>{4}</p>\n</figure>\n",
      table.name, markup_text(table.title), table_grid(table), paragraphs(table.note), columns);
}

// Makes the picture's file an element of the page, without its prolog and outer size.
std::string inlined(const std::string& svg, const std::string& title) {
  const std::size_t box = svg.find("viewBox=\""), begin = svg.find("</title>");
  if (box == std::string::npos || begin == std::string::npos) return "";
  const std::string view_box = svg.substr(box, svg.find('"', box + 9) + 1 - box);
  return fmt::format("<svg {} role=\"img\" aria-label=\"{}\">{}", view_box, markup_text(title), svg.substr(begin + 8));
}

std::string plot_figure(const ReportPlot& plot, const std::filesystem::path& folder, const std::string& why) {
  std::ifstream file(folder / (plot.name + ".svg"), std::ios::binary);
  const std::string svg{std::istreambuf_iterator<char>(file), {}};
  std::string picture = why.empty() ? inlined(svg, plot.title) : "";
  if (picture.empty()) picture = "<p class=\"missing\">" + markup_text(why.empty() ? "no picture" : why) + "</p>";
  const std::string link = why.empty() ? fmt::format(", <a href=\"{0}.svg\">{0}.svg</a>", plot.name) : "";
  return fmt::format(
      "<figure id=\"{0}\" class=\"plot\">\n<div class=\"box\" tabindex=\"0\">\n{1}\n</div>\n"
      "<figcaption><h3>{2}</h3>\n{3}</figcaption>\n"
      "<p class=\"files\">Data: <a href=\"{0}.csv\">{0}.csv</a>{4}</p>\n</figure>\n",
      plot.name, picture, markup_text(plot.title), paragraphs(plot.note), link);
}

std::string picture_figure(const ReportPicture& picture, const std::filesystem::path& folder) {
  return fmt::format(
      "<figure id=\"{0}\" class=\"picture\">\n<img alt=\"{1}\" src=\"{2}\">\n"
      "<figcaption><h3>{1}</h3>\n{3}</figcaption>\n<p class=\"files\">File: <a href=\"{0}.png\">{0}.png</a></p>\n"
      "</figure>\n",
      picture.name, markup_text(picture.title), data_address(folder / (picture.name + ".png"), "image/png"),
      paragraphs(picture.note));
}

// Anchors of sections are kept apart from those of tables and plots, whose names are also file names.
std::string anchor(const ReportSection& section) { return "section-" + section.name; }

std::string contents(const ReportPage& page) {
  std::string html = "<nav>\n<h2>Contents</h2>\n<ol>\n";
  const auto link = [](const std::string& name, const std::string& text) {
    return fmt::format("<a href=\"#{}\">{}</a>", name, markup_text(text));
  };
  for (const ReportSection& section : page.sections) {
    html += "<li>" + link(anchor(section), section.heading);
    const bool holds = !section.pictures.empty() || !section.tables.empty() || !section.plots.empty();
    if (holds) html += "\n<ul>\n";
    for (const ReportPicture& picture : section.pictures)
      html += "<li>" + link(picture.name, picture.title) + "</li>\n";
    for (const ReportTable& table : section.tables) html += "<li>" + link(table.name, table.title) + "</li>\n";
    for (const ReportPlot& plot : section.plots) html += "<li>" + link(plot.name, plot.title) + "</li>\n";
    if (holds) html += "</ul>";
    html += "</li>\n";
  }
  return html + "</ol>\n</nav>\n";
}

void check_names(const ReportPage& page) {
  std::size_t count = 1;
  std::set<std::string> names = {"index"};
  const auto add = [&](const std::string& name) {
    check_report_name(name);
    names.insert(name);
    ++count;
    SUPPLE_CHECK(names.size(), ==, count);
  };
  for (const ReportSection& section : page.sections) {
    add(anchor(section));
    for (const ReportTable& table : section.tables) add(table.name);
    for (const ReportPlot& plot : section.plots) add(plot.name);
    for (const ReportPicture& picture : section.pictures) add(picture.name);
  }
}

// A method keeps its look from plot to plot; methods that no plot shows together may look alike.
void assign_looks(ReportPage& page) {
  std::map<std::string, int> looks;
  std::map<std::string, std::set<std::string>> drawn_together;
  std::vector<PlotSeries*> open;
  for (ReportSection& section : page.sections) {
    for (ReportPlot& plot : section.plots) {
      for (PlotSeries& series : plot.series) {
        if (series.thick || series.name.empty()) continue;
        if (series.look >= 0) looks.try_emplace(series.name, series.look);
        if (series.look < 0) open.push_back(&series);
        for (const PlotSeries& other : plot.series) drawn_together[series.name].insert(other.name);
      }
    }
  }
  for (PlotSeries* series : open) {
    if (!looks.count(series->name)) {
      std::set<int> taken;
      for (const std::string& other : drawn_together[series->name])
        if (const auto place = looks.find(other); place != looks.end()) taken.insert(place->second);
      int look = 0;
      while (taken.count(look)) ++look;
      looks[series->name] = look;
    }
    series->look = looks[series->name];
  }
}

}  // namespace

std::vector<std::string> write_page(const ReportPage& given, const std::filesystem::path& folder) {
  check_names(given);
  ReportPage page = given;
  assign_looks(page);
  std::vector<std::string> missing;
  std::string html = page_begin(page.title, report_style);
  html += fmt::format("<header>\n<h1>{}</h1>\n<div class=\"lead\">\n{}</div>\n", markup_text(page.title),
                      paragraphs(page.lead));
  if (!page.facts.empty()) html += "<dl>\n";
  for (const auto& [what, value] : page.facts)
    html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", markup_text(what), markup_text(value));
  if (!page.facts.empty()) html += "</dl>\n";
  html += "</header>\n" + contents(page) + "<main>\n";
  for (const ReportSection& section : page.sections) {
    html += fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}", anchor(section), markup_text(section.heading),
                        paragraphs(section.text));
    for (const ReportPicture& picture : section.pictures) html += picture_figure(picture, folder);
    for (const ReportTable& table : section.tables) {
      write_csv(table, folder);
      write_json(table, folder);
      html += table_figure(table);
    }
    for (const ReportPlot& plot : section.plots) {
      std::string why;
      if (!write_plot(plot, folder, &why)) missing.push_back(why);
      html += plot_figure(plot, folder, why);
    }
    html += "</section>\n";
  }
  write_whole_file(folder / "index.html", html + "</main>\n" + page_end(""));
  return missing;
}

}  // namespace supple
