#include "app/bench/section_file.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "output/files/json_text.h"
#include "output/files/whole_file.h"

namespace supple {
namespace {

using SortedJson = nlohmann::json;

SortedJson numbers(const std::vector<double>& values) {
  // JSON has no infinities, so they are stored as text.
  SortedJson list = SortedJson::array();
  for (const double v : values) std::isfinite(v) ? list.push_back(v) : list.push_back(std::to_string(v));
  return list;
}

std::vector<double> numbers(const SortedJson& list) {
  std::vector<double> values;
  for (const SortedJson& v : list) values.push_back(v.is_number() ? v.get<double>() : std::stod(v.get<std::string>()));
  return values;
}

SortedJson json_of(const ReportPlot& plot) {
  SortedJson series = SortedJson::array();
  for (const PlotSeries& s : plot.series) {
    series.push_back({{"name", s.name},
                      {"x", numbers(s.x)},
                      {"y", numbers(s.y)},
                      {"thick", s.thick},
                      {"dashed", s.dashed},
                      {"look", s.look}});
  }
  return {{"name", plot.name},
          {"title", plot.title},
          {"note", plot.note},
          {"x_label", plot.x_label},
          {"y_label", plot.y_label},
          {"log_x", plot.log_x},
          {"log_y", plot.log_y},
          {"style", static_cast<int>(plot.style)},
          {"limits", {plot.x_min, plot.x_max, plot.y_min, plot.y_max}},
          {"series", series}};
}

ReportPlot plot_of(const SortedJson& json) {
  ReportPlot plot{json.at("name"), json.at("title"), json.at("note")};
  plot.x_label = json.at("x_label");
  plot.y_label = json.at("y_label");
  plot.log_x = json.at("log_x");
  plot.log_y = json.at("log_y");
  plot.style = static_cast<ReportPlot::Style>(json.at("style").get<int>());
  plot.x_min = json.at("limits")[0];
  plot.x_max = json.at("limits")[1];
  plot.y_min = json.at("limits")[2];
  plot.y_max = json.at("limits")[3];
  for (const SortedJson& s : json.at("series")) {
    plot.series.push_back(
        {s.at("name"), numbers(s.at("x")), numbers(s.at("y")), s.at("thick"), s.at("dashed"), s.at("look")});
  }
  return plot;
}

}  // namespace

void write_section(const ReportSection& section, const std::string& made_with, const std::filesystem::path& file) {
  SortedJson json = {{"made_with", made_with}, {"name", section.name},          {"heading", section.heading},
                     {"text", section.text},   {"tables", SortedJson::array()}, {"plots", SortedJson::array()}};
  for (const ReportTable& table : section.tables) {
    json["tables"].push_back({{"name", table.name},
                              {"title", table.title},
                              {"note", table.note},
                              {"columns", table.columns},
                              {"rows", table.rows},
                              {"page_columns", table.page_columns}});
  }
  for (const ReportPlot& plot : section.plots) json["plots"].push_back(json_of(plot));
  write_whole_file(file, exact_json_text(json));
}

std::optional<ReportSection> read_section(const std::filesystem::path& file, const std::string& made_with) {
  std::ifstream stream(file);
  if (!stream) return std::nullopt;
  try {
    const SortedJson json = parsed_json<SortedJson>(std::string{std::istreambuf_iterator<char>(stream), {}});
    if (json.at("made_with") != made_with) return std::nullopt;
    ReportSection section{json.at("name"), json.at("heading"), json.at("text")};
    for (const SortedJson& table : json.at("tables")) {
      section.tables.push_back({table.at("name"), table.at("title"), table.at("note"), table.at("columns"),
                                table.at("rows"), table.at("page_columns")});
    }
    for (const SortedJson& plot : json.at("plots")) section.plots.push_back(plot_of(plot));
    return section;
  } catch (const std::exception&) {  // damaged: it is made again
    return std::nullopt;
  }
}

}  // namespace supple
