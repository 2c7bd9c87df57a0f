// Reads .vtu files with code of its own, which is strict although the writer is simple: well-formed XML of the elements
// that unstructured grids have, and arrays of as many numbers as the file says.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace supple::test {

struct XmlElement {
  std::string name;
  std::map<std::string, std::string> attributes;
  std::string text;
  std::vector<XmlElement> children;

  // Returns the only child of this name. When there is none or several, it returns an empty element and the test fails.
  const XmlElement& child(const std::string& wanted) const;
};

// Returns the document's root. Throws std::runtime_error when the document is not well-formed.
XmlElement read_xml(const std::filesystem::path& path);

struct VtuNumbers {
  std::string type;
  int components = 0;
  std::vector<double> values;
};
struct VtuFile {
  int points = 0, cells = 0;
  std::map<std::string, VtuNumbers> point_data, cell_data, cell_arrays;  // the last: connectivity, offsets, types
  VtuNumbers position;
};
// Throws std::runtime_error when the file is not of this kind.
VtuFile read_vtu(const std::filesystem::path& path);

}  // namespace supple::test
