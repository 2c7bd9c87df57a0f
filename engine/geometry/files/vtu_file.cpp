// Implements VTK's XML format of mesh_formats.h for unstructured grids: docs.vtk.org, "VTK XML formats". Arrays are
// read as text, or as base64 that is not compressed; XML is taken apart only as far as these files need it.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/error.h"
#include "geometry/files/mesh_formats.h"
#include "geometry/files/number_words.h"
#include "geometry/files/vtk_cells.h"

namespace supple {
namespace {

class Vtu {
 public:
  Vtu(std::string text, std::string name) : text_(std::move(text)), name_(std::move(name)) {}

  [[noreturn]] void refuse(const std::string& message) const { throw InputError(name_, message); }
  // Refuses the file, with the line at which a part of the text begins.
  [[noreturn]] void refuse(std::string_view part, const std::string& message) const {
    const auto line = 1 + std::count(text_.data(), part.data(), '\n');
    throw InputError({Problem{{name_, int(line)}, message}});
  }

  // Returns the first place in the range [from, before) at which a tag of this name opens; npos where there is none.
  std::size_t tag(std::string_view tag_name, std::size_t from, std::size_t before) const {
    for (std::size_t i = text_.find('<', from); i < before; i = text_.find('<', i + 1)) {
      if (text_.compare(i + 1, tag_name.size(), tag_name) != 0) continue;
      const char next = i + 1 + tag_name.size() < text_.size() ? text_[i + 1 + tag_name.size()] : ' ';
      if (next == '>' || next == '/' || next == ' ' || next == '\n' || next == '\t' || next == '\r') return i;
    }
    return std::string::npos;
  }

  std::size_t tag_end(std::size_t at) const {
    const std::size_t end = text_.find('>', at);
    if (end == std::string::npos) refuse("the file ends within a tag");
    return end;
  }

  std::string attribute(std::size_t at, std::string_view attribute_name) const {
    const std::string_view head(text_.data() + at, tag_end(at) - at);
    for (std::size_t i = head.find(attribute_name); i != std::string_view::npos; i = head.find(attribute_name, i + 1)) {
      const std::size_t quote = i + attribute_name.size() + 1;
      if (i == 0 || (head[i - 1] != ' ' && head[i - 1] != '\n' && head[i - 1] != '\t')) continue;
      if (quote >= head.size() || head[quote - 1] != '=' || (head[quote] != '"' && head[quote] != '\'')) continue;
      const std::size_t end = head.find(head[quote], quote + 1);
      if (end != std::string_view::npos) return std::string(head.substr(quote + 1, end - quote - 1));
    }
    return "";
  }

  std::string_view content(std::size_t at) const {
    const std::size_t begin = tag_end(at) + 1, end = text_.find('<', begin);
    return std::string_view(text_).substr(begin, end == std::string::npos ? end : end - begin);
  }

  std::size_t size() const { return text_.size(); }
  std::size_t closing(std::string_view tag_name, std::size_t from) const {
    const std::size_t end = text_.find(fmt::format("</{}", tag_name), from);
    if (end == std::string::npos) refuse(fmt::format("<{}> does not end", tag_name));
    return end;
  }

 private:
  std::string text_, name_;
};

std::string from_base64(const Vtu& file, std::string_view text) {
  std::string bytes;
  unsigned block = 0;
  int count = 0;
  for (const char c : text) {
    int value = -1;
    if (c >= 'A' && c <= 'Z') value = c - 'A';
    if (c >= 'a' && c <= 'z') value = c - 'a' + 26;
    if (c >= '0' && c <= '9') value = c - '0' + 52;
    if (c == '+') value = 62;
    if (c == '/') value = 63;
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    if (c == '=') {  // the padding; more may follow, as the count of bytes may be encoded on its own
      if (count == 2) bytes.push_back(char(block >> 4));
      if (count == 3) bytes.append({char(block >> 10), char(block >> 2)});
      block = 0, count = 0;
      continue;
    }
    if (value < 0) file.refuse("an array has a character that is not base64");
    block = block << 6 | unsigned(value);
    if (++count < 4) continue;
    bytes.append({char(block >> 16), char(block >> 8), char(block)});
    block = 0, count = 0;
  }
  return bytes;
}

template <class From, class To>
std::vector<To> cast_bytes(std::string_view bytes) {
  std::vector<To> result(bytes.size() / sizeof(From));
  for (std::size_t i = 0; i < result.size(); ++i) {
    From value;
    std::memcpy(&value, bytes.data() + i * sizeof(From), sizeof(From));
    result[i] = static_cast<To>(value);
  }
  return result;
}

template <class To>
std::vector<To> binary_array(const Vtu& file, std::size_t at, const std::string& header) {
  const std::string bytes = from_base64(file, file.content(at));
  const std::size_t skipped = header == "UInt64" ? 8 : 4;
  if (bytes.size() < skipped) file.refuse("an array without its length");
  std::uint64_t announced = 0;
  std::memcpy(&announced, bytes.data(), skipped);  // the least byte first, as on this machine
  const std::string_view rest = std::string_view(bytes).substr(skipped);
  if (announced != rest.size())
    file.refuse(fmt::format("{} bytes announced, but an array holds {}", announced, rest.size()));
  const std::string type = file.attribute(at, "type");
  if (type == "Float64") return cast_bytes<double, To>(rest);
  if (type == "Float32") return cast_bytes<float, To>(rest);
  if (type == "Int64" || type == "UInt64") return cast_bytes<std::int64_t, To>(rest);
  if (type == "Int32") return cast_bytes<std::int32_t, To>(rest);
  if (type == "UInt32") return cast_bytes<std::uint32_t, To>(rest);
  if (type == "UInt8") return cast_bytes<std::uint8_t, To>(rest);
  if (type == "Int8") return cast_bytes<std::int8_t, To>(rest);
  file.refuse(fmt::format("type '{}' of an array is not known", type.substr(0, 40)));
}

template <class To>
std::vector<To> text_array(const Vtu& file, std::string_view text) {
  std::vector<To> values;
  for (std::size_t i = 0; i < text.size();) {
    i = text.find_first_not_of(" \t\r\n", i);
    if (i == std::string_view::npos) break;
    const std::size_t end = std::min(text.find_first_of(" \t\r\n", i), text.size());
    const std::string_view word = text.substr(i, end - i);
    const auto value = number_of<To>(word);
    if (!value)
      file.refuse(word, fmt::format("'{}' in an array is no number{}", word.substr(0, 40), why_no_number(word)));
    values.push_back(*value);
    i = end;
  }
  return values;
}

template <class To>
std::vector<To> array_at(const Vtu& file, std::size_t at, const std::string& header) {
  const std::string format = file.attribute(at, "format");
  if (format == "ascii") return text_array<To>(file, file.content(at));
  if (format == "binary") return binary_array<To>(file, at, header);
  file.refuse(fmt::format("arrays as '{}' are not read; 'ascii' and 'binary' are", format.substr(0, 40)));
}

// Returns the place of the array of a name within a part of the file; npos where there is none.
std::size_t array_named(const Vtu& file, const char* section, const char* name) {
  const std::size_t start = file.tag(section, 0, file.size());
  if (start == std::string::npos) return start;
  const std::size_t end = file.closing(section, start);
  for (std::size_t at = file.tag("DataArray", start, end); at != std::string::npos;
       at = file.tag("DataArray", at + 1, end))
    if (*name == 0 || file.attribute(at, "Name") == name) return at;
  return std::string::npos;
}

std::size_t required(const Vtu& file, const char* section, const char* name) {
  const std::size_t at = array_named(file, section, name);
  if (at == std::string::npos) file.refuse(fmt::format("the file has no array '{}' in <{}>", name, section));
  return at;
}

void check_announced(const Vtu& file, std::size_t piece, const char* attribute, std::size_t found) {
  const std::string announced = file.attribute(piece, attribute);
  if (announced != fmt::format("{}", found))
    file.refuse(fmt::format("{} = {} announced, but the file holds {}", attribute, announced.substr(0, 40), found));
}

}  // namespace

RawMesh read_vtu(std::string text, const std::string& name) {
  const Vtu file(std::move(text), name);
  const std::size_t head = file.tag("VTKFile", 0, file.size());
  if (head == std::string::npos || file.attribute(head, "type") != "UnstructuredGrid")
    file.refuse("not a VTK XML file of an UnstructuredGrid");
  if (!file.attribute(head, "compressor").empty()) file.refuse("compressed arrays are not read; 'ascii' ones are");
  if (file.attribute(head, "byte_order") == "BigEndian") file.refuse("arrays in big-endian order are not read");
  const std::string header = file.attribute(head, "header_type");
  const std::size_t piece = file.tag("Piece", head, file.size());
  if (piece == std::string::npos) file.refuse("the file has no <Piece>");
  if (file.tag("Piece", piece + 1, file.size()) != std::string::npos)
    file.refuse("files with several pieces are not read");
  VtkCells cells;
  const std::size_t points = required(file, "Points", "");
  const std::string components = file.attribute(points, "NumberOfComponents");
  if (!components.empty() && components != "3")
    file.refuse(fmt::format("points have {} components, and 3 are read", components.substr(0, 40)));
  const auto coordinates = array_at<double>(file, points, header);
  cells.points = array_at<long long>(file, required(file, "Cells", "connectivity"), header);
  cells.ends = array_at<long long>(file, required(file, "Cells", "offsets"), header);
  cells.types = array_at<long long>(file, required(file, "Cells", "types"), header);
  const std::size_t regions = array_named(file, "CellData", "region");
  if (regions != std::string::npos) cells.regions = array_at<long long>(file, regions, header);
  if (coordinates.size() % 3 != 0) file.refuse(fmt::format("{} coordinates are no multiple of 3", coordinates.size()));
  check_announced(file, piece, "NumberOfPoints", coordinates.size() / 3);
  check_announced(file, piece, "NumberOfCells", cells.ends.size());
  cells.rest.resize(Eigen::Index(coordinates.size() / 3), 3);
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    if (!std::isfinite(coordinates[i])) file.refuse(fmt::format("a coordinate of point {} is not finite", i / 3));
    cells.rest(Eigen::Index(i / 3), Eigen::Index(i % 3)) = coordinates[i];
  }
  return tetrahedra_of(std::move(cells), name);
}

std::string vtu_text(const TetMesh& mesh) {
  const Eigen::Index count = mesh.tets.rows();
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n"
      "<Points>\n<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n",
      mesh.rest.rows(), count);
  for (Eigen::Index v = 0; v < mesh.rest.rows(); ++v)
    text += fmt::format("{:.17g} {:.17g} {:.17g}\n", mesh.rest(v, 0), mesh.rest(v, 1), mesh.rest(v, 2));
  const auto begin = [&](const char* type, const char* name) {
    text += fmt::format("<DataArray type=\"{}\" Name=\"{}\" format=\"ascii\">\n", type, name);
  };
  const std::string end = "</DataArray>\n";
  text += end + "</Points>\n<Cells>\n";
  begin("Int64", "connectivity");
  for (Eigen::Index e = 0; e < count; ++e)
    text += fmt::format("{} {} {} {}\n", mesh.tets(e, 0), mesh.tets(e, 1), mesh.tets(e, 2), mesh.tets(e, 3));
  text += end;
  begin("Int64", "offsets");
  for (Eigen::Index e = 0; e < count; ++e) text += fmt::format("{}\n", 4 * (e + 1));
  text += end;
  begin("UInt8", "types");
  for (Eigen::Index e = 0; e < count; ++e) text += "10\n";
  text += end + "</Cells>\n<CellData>\n";
  begin("Int32", "region");
  for (Eigen::Index e = 0; e < count; ++e)
    text += fmt::format("{}\n", mesh.regions.empty() ? 0 : mesh.regions[std::size_t(e)]);
  return text + end + "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

}  // namespace supple
