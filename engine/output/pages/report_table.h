// Writes the tables of a report as files for programs: CSV and JSON. Nothing here knows what the numbers mean; the page
// for people is report_page.h.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace supple {

struct ReportTable {
  std::string name;                       // "table1"; used in file names and anchors; letters, digits, "_" and "-"
  std::string title = {};                 // heading on the page
  std::string note = {};                  // plain text below it; a blank line starts a new paragraph
  std::vector<std::string> columns = {};  // all different, with units in brackets: "time, ours [ms]"
  std::vector<std::vector<std::string>> rows = {};  // cells as they are shown; a cell may be empty
  std::vector<std::string> page_columns = {};       // the columns that the page shows, in this order; all when empty
  std::string row_name = "row";                     // what a row is called; the heading above the rows' numbers
  std::size_t first_row = 1;                        // number of the first row
  int page_digits = 0;  // significant digits of numbers on the page; 0 leaves cells as they are
};

// Writes a number as people and programs read it well: "1.23e-4", "12.3", "33666"; "" for NaN. Whole numbers below a
// million keep all their digits and get no point.
std::string number_text(double value, int digits = 3);

// Tells whether JSON would take the text for a number that a double holds.
bool reads_as_number(const std::string& cell);

// Writes folder/NAME.csv with the quoting of RFC 4180 and lines that end in LF. The first column numbers the rows.
void write_csv(const ReportTable& table, const std::filesystem::path& folder);

// Writes folder/NAME.json: a list of objects, each with the row's number first. Cells that are numbers, true, false or
// lists of these become these values; empty cells become null.
void write_json(const ReportTable& table, const std::filesystem::path& folder);

// Reads all records, the header first; every record has as many fields as the header. Lines end in LF or CRLF. Throws
// InputError with file, line and column where the text is malformed.
std::vector<std::vector<std::string>> read_csv(const std::filesystem::path& path);

// Writes the records as CSV text.
std::string csv_text(const std::vector<std::vector<std::string>>& records);

// Trips a check when a name is not fit for file names and anchors.
void check_report_name(const std::string& name);

}  // namespace supple
