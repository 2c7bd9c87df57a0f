// Writes a report as one HTML page that needs no other file, beside the files with its numbers. What the tables and
// plots are about is the caller's business.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "output/pages/report_plot.h"
#include "output/pages/report_table.h"

namespace supple {

// Refers to folder/NAME.png, which must exist before the page is written.
struct ReportPicture {
  std::string name;
  std::string title = {}, note = {};
};

struct ReportSection {
  std::string name;                     // anchor "section-NAME"
  std::string heading = {}, text = {};  // plain text; a blank line starts a new paragraph
  std::vector<ReportTable> tables = {};
  std::vector<ReportPlot> plots = {};
  std::vector<ReportPicture> pictures = {};
};

struct ReportPage {
  std::string title, lead = {};
  std::vector<std::pair<std::string, std::string>> facts = {};  // the machine, the build and so on
  std::vector<ReportSection> sections = {};
};

// Writes folder/index.html, which contains every picture and loads nothing from elsewhere. Also writes the files to
// which it links: CSV and JSON of all tables, CSV and SVG of all plots. Rows have the same numbers as in the CSV. No
// two tables, plots or pictures may share a name. Returns why plots have no picture, one line each; the page says so in
// their places. Throws RunError when a file cannot be written.
std::vector<std::string> write_page(const ReportPage& page, const std::filesystem::path& folder);

}  // namespace supple
