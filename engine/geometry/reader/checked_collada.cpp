// Implements COLLADA of checked_surface.h: Khronos, "COLLADA 1.4.1 specification". Lists of numbers are checked, word
// by word and by their counts; assimp itself refuses indices that are too large, and files that are no XML.
#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "base/error.h"
#include "geometry/files/number_words.h"
#include "geometry/reader/checked_surface.h"

namespace supple {
namespace {

class ColladaChecker {
 public:
  ColladaChecker(std::string& bytes, const std::string& name) : bytes_(bytes), text_(bytes), name_(name) {}

  // Checks the file and replaces decimal commas, which old exporters wrote, by points. Returns whether there were any.
  bool run() {
    for (std::size_t at = text_.find('<'); at != std::string_view::npos; at = text_.find('<', at + 1)) {
      if (text_.substr(at).starts_with("<!--")) {
        at = std::min(text_.find("-->", at), text_.size() - 1);
        continue;
      }
      const std::size_t end = std::min(text_.find('>', at), text_.size());
      const std::string_view head = text_.substr(at, end - at);
      if (head.starts_with("<accessor")) accessors_.push_back(head);
      if (head.ends_with('/')) continue;
      const std::string_view tag = head.substr(1, head.find_first_of(" \t\r\n") - 1);
      const std::size_t begin = std::min(end + 1, text_.size());
      const std::string_view list = text_.substr(begin, std::min(text_.find('<', begin), text_.size()) - begin);
      if (tag == "float_array") check_floats(head, list);
      if (tag == "p" || tag == "vcount") check_indices(list);
    }
    check_accessors();
    return has_commas_;
  }

 private:
  [[noreturn]] void refuse(std::string_view part, const std::string& message) const {
    const std::string_view before = text_.substr(0, std::size_t(part.data() - text_.data()));
    const std::size_t line_begin = before.rfind('\n') + 1;  // 0 where there is none
    throw InputError(
        {Problem{{name_, 1 + int(std::count(before.begin(), before.end(), '\n')), int(before.size() - line_begin) + 1},
                 message}});
  }

  // Returns the value of a tag's attribute; empty: it has none.
  static std::string_view attribute(std::string_view head, std::string_view name) {
    for (std::size_t at = head.find(name); at != std::string_view::npos; at = head.find(name, at + 1)) {
      const std::size_t quote = at + name.size() + 1;
      if (at == 0 || !is_space(head[at - 1]) || quote >= head.size() || head[quote - 1] != '=') continue;
      const std::string_view rest = head.substr(quote + 1);
      return rest.substr(0, std::min(rest.find(head[quote]), rest.size()));
    }
    return {};
  }
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  template <class Take>
  static void for_each_word(std::string_view list, const Take& take) {
    constexpr std::string_view spaces = " \t\r\n";
    for (std::size_t at = list.find_first_not_of(spaces); at != std::string_view::npos;) {
      const std::size_t end = std::min(list.find_first_of(spaces, at), list.size());
      take(list.substr(at, end - at));
      at = list.find_first_not_of(spaces, end);
    }
  }

  void check_floats(std::string_view head, std::string_view list) {
    long long held = 0;
    for_each_word(list, [&](std::string_view word) {
      ++held;
      if (number_of<double>(word)) return;
      if (why_no_number(word).empty()) refuse(word, fmt::format("'{}' is no number", word.substr(0, 40)));
      bytes_[std::size_t(word.data() - text_.data()) + word.find(',')] = '.';
      has_commas_ = true;
    });
    arrays_[std::string(attribute(head, "id"))] = held;
    const std::string_view count = attribute(head, "count");
    if (!count.empty() && number_of<long long>(count) != held)
      refuse(head, fmt::format("a list announces {} numbers, and holds {}", count.substr(0, 40), held));
  }

  // Refuses an accessor that needs more numbers than its list holds: assimp would read beyond the end of the list.
  void check_accessors() const {
    for (const std::string_view head : accessors_) {
      const auto whole = [&](std::string_view name, long long missing) {
        const std::string_view word = attribute(head, name);
        const auto value = number_of<long long>(word);
        if (!word.empty() && (!value || *value < 0 || *value > 1'000'000'000))
          refuse(head, fmt::format("{} '{}' of an accessor is no whole number from 0 to 1000000000", name,
                                   word.substr(0, 40)));
        return value.value_or(missing);
      };
      const std::string_view source = attribute(head, "source");
      const auto array = arrays_.find(std::string(source.substr(std::min<std::size_t>(1, source.size()))));
      if (array == arrays_.end()) continue;  // a list of names, or in another file
      const long long needed = whole("offset", 0) + whole("count", 0) * whole("stride", 1);
      if (needed > array->second)
        refuse(head, fmt::format("an accessor needs {} numbers, but its list holds {}", needed, array->second));
    }
  }

  void check_indices(std::string_view list) const {
    for_each_word(list, [&](std::string_view word) {
      const auto index = number_of<long long>(word);
      if (!index || *index < 0) refuse(word, fmt::format("'{}' is no whole number from 0", word.substr(0, 40)));
    });
  }

  std::string& bytes_;
  const std::string_view text_;  // the bytes as they are looked at
  const std::string& name_;
  std::map<std::string, long long> arrays_;  // how many numbers each list holds, by its id
  std::vector<std::string_view> accessors_;  // their tags
  bool has_commas_ = false;
};

}  // namespace

CheckedSurface checked_collada(std::string bytes, const std::string& name) {
  CheckedSurface result;
  if (ColladaChecker(bytes, name).run())
    result.remarks.emplace_back("its numbers have decimal commas, which are read as points");
  result.bytes = std::move(bytes);
  return result;
}

}  // namespace supple
