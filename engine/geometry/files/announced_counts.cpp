#include "geometry/files/announced_counts.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <vector>

#include "base/text.h"

namespace supple {
namespace {

// Returns the first six words of a line in small letters; no line of a header needs more.
std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  for (std::size_t at = 0; words.size() < 6;) {
    at = line.find_first_not_of(" \t\r", at);
    if (at == std::string_view::npos) break;
    const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
    words.push_back(lowercase(line.substr(at, end - at)));
    at = end;
  }
  return words;
}

// Reads the digits at the beginning of a word as a count. One that is too large for an integer is infinite, larger than
// any file.
double count_of(std::string_view word) {
  std::uint64_t count = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  if (error == std::errc::result_out_of_range) return HUGE_VAL;
  return error == std::errc() ? double(count) : 0;
}

std::string refusal(double count, std::string_view what, std::uintmax_t bytes) {
  return fmt::format("announces {:.0f} {}, for which its {} bytes have no room", count, what, bytes);
}

int bytes_of_type(std::string_view type) {
  struct Type {
    std::string_view name;
    int bytes;
  };
  constexpr std::array<Type, 11> longer = {{{"short", 2},
                                            {"ushort", 2},
                                            {"int16", 2},
                                            {"uint16", 2},
                                            {"int", 4},
                                            {"uint", 4},
                                            {"int32", 4},
                                            {"uint32", 4},
                                            {"float", 4},
                                            {"float32", 4},
                                            {"double", 8}}};
  const auto* const known = std::find_if(longer.begin(), longer.end(), [&](const Type& t) { return t.name == type; });
  return known != longer.end() ? known->bytes : type == "float64" ? 8 : 1;
}

// Describes a kind of element of a PLY file, with the fewest bytes that one of them takes.
struct PlyElement {
  std::string name;
  double count = 0;
  int bytes = 0;
};

std::string wrong_with_ply(std::string_view text, std::uintmax_t bytes) {
  std::vector<PlyElement> elements;
  bool ascii = true;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find_first_of("\n\r", at), text.size());
    const std::vector<std::string> words = words_of(text.substr(at, end - at));
    at = end + 1;
    if (words.empty()) continue;
    if (words[0] == "format" && words.size() > 1) ascii = words[1] == "ascii";
    if (words[0] == "element" && words.size() > 2) elements.push_back({words[1], count_of(words[2]), 0});
    // In text, a number takes at least a digit and a space, and so does the length of a list. In bytes, a list takes at
    // least its length.
    if (words[0] == "property" && words.size() > 2 && !elements.empty())
      elements.back().bytes += ascii ? 2 : bytes_of_type(words[1] == "list" ? words[2] : words[1]);
    if (words[0] != "end_header") continue;
    for (const PlyElement& element : elements) {
      if (element.count * std::max(element.bytes, 1) > double(bytes) - double(at) + 1)
        return refusal(element.count, "of '" + element.name + "'", bytes);
    }
    return "";
  }
  return "has a header without an end (end_header)";
}

std::string wrong_with_off(std::string_view text, std::uintmax_t bytes) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at < text.size() && words.size() < 3;) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    for (std::string& word : words_of(line.substr(0, line.find('#')))) words.push_back(std::move(word));
    at = end + 1;
  }
  if (words.size() < 3) return "";
  // A vertex takes three numbers, a face at least its length, each with a space.
  const double vertices = count_of(words[1]), faces = count_of(words[2]);
  if (6 * vertices > double(bytes)) return refusal(vertices, "vertices", bytes);
  return 2 * faces > double(bytes) ? refusal(faces, "faces", bytes) : "";
}

}  // namespace

std::string announced_too_much(std::string_view begin, std::uintmax_t bytes) {
  const std::string first = lowercase(begin.substr(0, 5));
  if (first.starts_with("ply")) return wrong_with_ply(begin, bytes);
  const std::size_t off = first.find("off");  // OFF, COFF, NOFF, STOFF and the like
  return off != std::string::npos && off < 3 ? wrong_with_off(begin, bytes) : "";
}

}  // namespace supple
