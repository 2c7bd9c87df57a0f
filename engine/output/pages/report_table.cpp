#include "output/pages/report_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"
#include "base/read_file.h"
#include "output/files/json_text.h"
#include "output/files/whole_file.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

void check_table(const ReportTable& table) {
  check_report_name(table.name);
  std::set<std::string> names = {table.row_name};
  for (const std::string& column : table.columns) names.insert(column);
  SUPPLE_CHECK(names.size(), ==, table.columns.size() + 1);
  for (const auto& row : table.rows) SUPPLE_CHECK(row.size(), ==, table.columns.size());
}

std::string csv_field(const std::string& field) {
  if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
  std::string quoted = "\"";
  for (const char c : field) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

// Reads records from a text and keeps track of the line and column.
class CsvReader {
 public:
  CsvReader(std::string text, std::string name) : text_(std::move(text)), name_(std::move(name)) {}

  bool done() const { return at_ == text_.size(); }

  std::vector<std::string> record() {
    std::vector<std::string> fields = {field()};
    while (peek() == ',') {
      take();
      fields.push_back(field());
    }
    if (peek() == '\r') take();
    if (!done() && peek() != '\n') refuse(line_, column_, "a carriage return that no line feed follows");
    if (!done()) take();
    return fields;
  }

  int line() const { return line_; }
  [[noreturn]] void refuse(int line, int column, const std::string& message) const {
    throw InputError({Problem{{name_, line, column}, message}});
  }

 private:
  char peek() const { return done() ? '\0' : text_[at_]; }

  char take() {
    const char c = text_[at_++];
    column_ = c == '\n' ? 1 : column_ + 1;
    line_ += c == '\n';
    return c;
  }

  bool at_end_of_field() const { return done() || peek() == ',' || peek() == '\r' || peek() == '\n'; }

  std::string field() {
    if (peek() == '"') return quoted_field();
    std::string value;
    while (!at_end_of_field()) {
      if (peek() == '"') refuse(line_, column_, "a quote inside a field that does not begin with one");
      value += take();
    }
    return value;
  }

  std::string quoted_field() {
    const int first_line = line_, first_column = column_;
    take();
    std::string value;
    for (;;) {
      if (done()) refuse(first_line, first_column, "this quote is never closed");
      const char c = take();
      if (c == '"' && peek() != '"') break;
      if (c == '"') take();
      value += c;
    }
    if (!at_end_of_field()) refuse(line_, column_, "text after the quote that closes the field");
    return value;
  }

  std::string text_, name_;
  std::size_t at_ = 0;
  int line_ = 1, column_ = 1;
};

// Converts a cell: a number, true, false or a list of them becomes that value, an empty cell becomes null, and anything
// else stays text.
Json json_of(const std::string& cell) {
  if (cell.empty()) return nullptr;
  const bool may_say_more = reads_as_number(cell) || cell == "true" || cell == "false" || cell.front() == '[';
  Json value = may_say_more ? json_if_valid<Json>(cell) : Json(Json::value_t::discarded);
  return value.is_discarded() ? Json(cell) : value;
}

}  // namespace

std::string number_text(double value, int digits) {
  if (std::isnan(value)) return "";
  if (std::isinf(value)) return value < 0 ? "-inf" : "inf";
  if (std::abs(value) < 1e6 && value == std::trunc(value)) return fmt::format("{:.0f}", value == 0 ? 0.0 : value);
  const int decimals = std::max(digits, 1) - 1;
  const std::string scientific = fmt::format("{:.{}e}", value, decimals);
  const std::size_t e = scientific.find('e');
  const int exponent = std::stoi(scientific.substr(e + 1));  // the exponent of the rounded value: 9.996 counts as 10.0
  if (exponent < -3 || exponent > 5) return fmt::format("{}e{}", scientific.substr(0, e), exponent);
  return fmt::format("{:.{}f}", value, std::max(0, decimals - exponent));
}

bool reads_as_number(const std::string& cell) {
  const std::size_t ends_in_digit = cell.find_last_of("0123456789");
  if (cell.empty() || ends_in_digit + 1 != cell.size() || cell.find_first_of("-0123456789") != 0) return false;
  return json_if_valid<Json>(cell).is_number();
}

void check_report_name(const std::string& name) {
  std::string fit = name.empty() ? "_" : name;
  for (char& c : fit)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-') c = '_';
  SUPPLE_CHECK(name, ==, fit);
}

std::string csv_text(const std::vector<std::vector<std::string>>& records) {
  std::string text;
  for (const auto& record : records) {
    for (std::size_t i = 0; i < record.size(); ++i) text += (i > 0 ? "," : "") + csv_field(record[i]);
    text += '\n';
  }
  return text;
}

void write_csv(const ReportTable& table, const std::filesystem::path& folder) {
  check_table(table);
  std::vector<std::vector<std::string>> records = {{table.row_name}};
  for (std::size_t i = 0; i < table.rows.size(); ++i) records.push_back({fmt::format("{}", table.first_row + i)});
  records[0].insert(records[0].end(), table.columns.begin(), table.columns.end());
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    records[i + 1].insert(records[i + 1].end(), table.rows[i].begin(), table.rows[i].end());
  write_whole_file(folder / (table.name + ".csv"), csv_text(records));
}

void write_json(const ReportTable& table, const std::filesystem::path& folder) {
  check_table(table);
  Json list = Json::array();
  for (const auto& cells : table.rows) {
    Json row = {{table.row_name, table.first_row + list.size()}};
    for (std::size_t i = 0; i < cells.size(); ++i) row[table.columns[i]] = json_of(cells[i]);
    list.push_back(std::move(row));
  }
  write_whole_file(folder / (table.name + ".json"), json_text(list, 1) + "\n");
}

std::vector<std::vector<std::string>> read_csv(const std::filesystem::path& path) {
  CsvReader reader(read_file(path), path.string());
  if (reader.done()) throw InputError(path.string(), "is empty; a table has at least a header");
  std::vector<std::vector<std::string>> records;
  while (!reader.done()) {
    const int line = reader.line();
    records.push_back(reader.record());
    if (records.back().size() != records[0].size())
      reader.refuse(line, 0, fmt::format("{} fields; the header has {}", records.back().size(), records[0].size()));
  }
  return records;
}

}  // namespace supple
