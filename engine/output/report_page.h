// A report as one HTML page that needs nothing but itself, beside the files with its numbers. What the tables and plots
// are about is the caller's business.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "output/report_plot.h"
#include "output/report_table.h"

namespace supple {

// folder/NAME.png, which stands there before the page is written.
struct ReportPicture {
  std::string name;
  std::string title = {}, note = {};
};

struct ReportSection {
  std::string name;                     // anchor "section-NAME"
  std::string heading = {}, text = {};  // plain; a blank line starts a new paragraph
  std::vector<ReportTable> tables = {};
  std::vector<ReportPlot> plots = {};
  std::vector<ReportPicture> pictures = {};
};

struct ReportPage {
  std::string title, lead = {};
  std::vector<std::pair<std::string, std::string>> facts = {};  // machine, build ...
  std::vector<ReportSection> sections = {};
};

// folder/index.html with every picture inside, no script and nothing from elsewhere; and what it names: CSV and JSON of
// all tables, CSV and SVG of all plots. Rows show their number in the CSV. No two tables, plots or pictures share a
// name. Returns why plots have no picture, a line each; the page says so in their places. Throws RunError when a file
// cannot be written.
std::vector<std::string> write_page(const ReportPage& page, const std::filesystem::path& folder);

}  // namespace supple
