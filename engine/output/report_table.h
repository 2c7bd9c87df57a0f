// Tables of a report as files for programs: CSV and JSON. Nothing here knows what the numbers mean; the page for
// people is report_page.h.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace supple {

struct ReportTable {
  std::string name;                                 // "table1": file names and anchors; letters, digits, "_" and "-"
  std::string title = {};                           // heading on the page
  std::string note = {};                            // plain text below it; a blank line starts a new paragraph
  std::vector<std::string> columns = {};            // all different, with units in brackets: "time, ours [ms]"
  std::vector<std::vector<std::string>> rows = {};  // cells as they are to be read; a cell may be empty
  std::vector<std::string> page_columns = {};       // which of the columns the page shows, in this order; empty: all
  std::string row_name = "row";                     // what a row is called, above their numbers
  std::size_t first_row = 1;                        // number of the first row
  int page_digits = 0;                              // significant digits of numbers on the page; 0: cells as they are
};

// A number as readers and programs like it: "1.23e-4", "12.3", "33666"; "" for NaN. Whole numbers below a million keep
// all their digits and get no point.
std::string number_text(double value, int digits = 3);

// Whether JSON would take the text for a number that a double holds.
bool reads_as_number(const std::string& cell);

// folder/NAME.csv with RFC 4180's quoting and lines that end in LF. The first column numbers the rows.
void write_csv(const ReportTable& table, const std::filesystem::path& folder);

// folder/NAME.json: a list of objects, the row's number first. Cells that are numbers, true, false or
// lists of these become what they say, empty ones null.
void write_json(const ReportTable& table, const std::filesystem::path& folder);

// All records, the header first; every one has as many fields as the header. Lines end in LF or CRLF. Throws InputError
// with file, line and column where the text is malformed.
std::vector<std::vector<std::string>> read_csv(const std::filesystem::path& path);

// The records as CSV text.
std::string csv_text(const std::vector<std::vector<std::string>>& records);

// Trips a check when a name is not fit for file names and anchors.
void check_report_name(const std::string& name);

}  // namespace supple
