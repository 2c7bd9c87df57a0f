#include "support/vtu.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>

#include "support/bodies.h"

namespace supple::test {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw std::runtime_error(what); }

// Reads by recursive descent the parts of XML that such files have: there are no comments, and no references except the
// five named ones.
class XmlReader {
 public:
  explicit XmlReader(std::string text) : text_(std::move(text)) {}

  XmlElement document() {
    skip("<?xml");
    at_ = text_.find("?>", at_) + 2;
    XmlElement root = element();
    space();
    if (at_ != text_.size()) refuse("something stands behind the root");
    return root;
  }

 private:
  void space() { at_ = std::min(text_.find_first_not_of(" \n\t", at_), text_.size()); }
  bool next_is(const std::string& word) const { return text_.compare(at_, word.size(), word) == 0; }
  void skip(const std::string& word) {
    space();
    if (!next_is(word)) refuse(fmt::format("'{}' expected at byte {}", word, at_));
    at_ += word.size();
  }
  std::string until(const char* ends) {
    const std::size_t end = text_.find_first_of(ends, at_);
    if (end == std::string::npos) refuse("the file ends too early");
    const std::size_t begin = std::exchange(at_, end);
    return text_.substr(begin, end - begin);
  }

  XmlElement element() {
    XmlElement result;
    skip("<");
    result.name = until(" />\n");
    for (space(); !next_is("/") && !next_is(">"); space()) {
      const std::string key = until("=");
      skip("=\"");
      if (!result.attributes.emplace(key, until("\"")).second) refuse("an attribute twice: " + key);
      skip("\"");
    }
    if (next_is("/")) {
      skip("/>");
      return result;
    }
    skip(">");
    result.text = until("<");
    while (!next_is("</")) {
      result.children.push_back(element());
      (void)until("<");
    }
    skip("</" + result.name + ">");
    return result;
  }

  std::string text_;
  std::size_t at_ = 0;
};

std::vector<std::uint8_t> from_base64(const std::string& text) {
  std::vector<std::uint8_t> bytes;
  std::uint32_t group = 0;
  int digits = 0, padding = 0;
  for (const char c : text) {
    if (c == '\n') continue;
    int value = 0;
    if (c >= 'A' && c <= 'Z')
      value = c - 'A';
    else if (c >= 'a' && c <= 'z')
      value = c - 'a' + 26;
    else if (c >= '0' && c <= '9')
      value = c - '0' + 52;
    else if (c == '+')
      value = 62;
    else if (c == '/')
      value = 63;
    else if (c == '=')
      ++padding;
    else
      refuse("not a digit of base64");
    if (padding > 0 && c != '=') refuse("a digit behind the padding");
    group = group << 6 | std::uint32_t(value);
    if (++digits % 4 != 0) continue;
    for (int i = 0; i < 3 - padding; ++i) bytes.push_back(std::uint8_t(group >> (16 - 8 * i)));
    group = 0;
  }
  if (digits % 4 != 0) refuse("base64 that stops between groups");
  return bytes;
}

template <class T>
void take(const std::vector<std::uint8_t>& bytes, std::vector<double>& values) {
  std::vector<T> numbers(bytes.size() / sizeof(T));
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(T));
  values.assign(numbers.begin(), numbers.end());
}

VtuNumbers numbers_of(const XmlElement& array, int rows) {
  if (array.name != "DataArray" || array.attributes.at("format") != "binary") refuse("not a binary DataArray");
  std::vector<std::uint8_t> bytes = from_base64(array.text);
  std::uint64_t length = 0;
  if (bytes.size() < sizeof length) refuse("an array without its length");
  std::memcpy(&length, bytes.data(), sizeof length);
  bytes.erase(bytes.begin(), bytes.begin() + sizeof length);
  if (length != bytes.size()) refuse("an array of another length than it says");
  VtuNumbers result{array.attributes.at("type"), std::stoi(array.attributes.at("NumberOfComponents")), {}};
  if (result.type == "Float64")
    take<double>(bytes, result.values);
  else if (result.type == "Float32")
    take<float>(bytes, result.values);
  else if (result.type == "Int32")
    take<std::int32_t>(bytes, result.values);
  else if (result.type == "UInt8")
    take<std::uint8_t>(bytes, result.values);
  else
    refuse("a type that is not written: " + result.type);
  if (rows >= 0 && result.values.size() != std::size_t(rows) * std::size_t(result.components))
    refuse(array.attributes.at("Name") + " has another number of rows");
  return result;
}

std::map<std::string, VtuNumbers> arrays_of(const XmlElement& parent, int rows) {
  std::map<std::string, VtuNumbers> arrays;
  for (const XmlElement& array : parent.children) arrays.emplace(array.attributes.at("Name"), numbers_of(array, rows));
  return arrays;
}

}  // namespace

const XmlElement& XmlElement::child(const std::string& wanted) const {
  static const XmlElement nothing;
  const XmlElement* found = nullptr;
  for (const XmlElement& element : children) {
    if (element.name != wanted) continue;
    EXPECT_EQ(found, nullptr) << wanted << " twice";
    found = &element;
  }
  EXPECT_NE(found, nullptr) << name << " has no " << wanted;
  return found != nullptr ? *found : nothing;
}

XmlElement read_xml(const std::filesystem::path& path) { return XmlReader(read_file(path)).document(); }

VtuFile read_vtu(const std::filesystem::path& path) {
  const XmlElement root = read_xml(path);
  EXPECT_EQ(root.name, "VTKFile");
  EXPECT_EQ(root.attributes.at("type"), "UnstructuredGrid");
  EXPECT_EQ(root.attributes.at("byte_order"), "LittleEndian");
  EXPECT_EQ(root.attributes.at("header_type"), "UInt64");
  const XmlElement& piece = root.child("UnstructuredGrid").child("Piece");
  VtuFile file;
  file.points = std::stoi(piece.attributes.at("NumberOfPoints"));
  file.cells = std::stoi(piece.attributes.at("NumberOfCells"));
  file.point_data = arrays_of(piece.child("PointData"), file.points);
  file.cell_data = arrays_of(piece.child("CellData"), file.cells);
  file.cell_arrays = arrays_of(piece.child("Cells"), -1);
  file.position = numbers_of(piece.child("Points").child("DataArray"), file.points);
  return file;
}

}  // namespace supple::test
