// Makes a document of a text, and finds the errors that the parser does not refuse by itself, or not in clear words.
#include "scene/config/toml_document.h"

#include <algorithm>

namespace supple {

void toml_assertion_failed() { throw TomlAssertion{}; }

namespace {

[[noreturn]] void refuse(std::string_view text, std::size_t at, const std::string& name, const std::string& message) {
  const std::string_view before = text.substr(0, at);
  const std::size_t line_begin = before.rfind('\n') + 1;  // 0 without a line feed
  // Columns count characters; the bytes 10xxxxxx continue a character of UTF-8.
  const auto column = std::count_if(before.begin() + std::ptrdiff_t(line_begin), before.end(),
                                    [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; });
  const auto line = std::count(before.begin(), before.end(), '\n');
  throw InputError({Problem{{name, int(line) + 1, int(column) + 1}, "not TOML: " + message}});
}

// Returns where a string that begins at `at` ends, or the text's end. A string that is not closed ends with its line;
// the parser refuses it there.
std::size_t end_of_string(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string three(3, quote);
  const bool many_lines = text.substr(at).starts_with(three);
  for (std::size_t i = at + (many_lines ? 3 : 1); i < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\') {
      ++i;
    } else if (many_lines ? text.substr(i).starts_with(three) : text[i] == quote) {
      return i + (many_lines ? 3 : 1);
    } else if (!many_lines && text[i] == '\n') {
      return i;
    }
  }
  return text.size();
}

// Refuses keys with more than most_words words between dots: they make tables in tables, whose depth the parser does
// not bound.
void check_words_of_keys(std::string_view text, const std::string& name) {
  std::size_t words = 1;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
    } else if (c == '"' || c == '\'') {
      i = end_of_string(text, i);
    } else {
      if (c == '.') {
        ++words;
      } else if (std::string_view("=,[]{}\n").find(c) != std::string_view::npos) {
        words = 1;
      }
      if (words > most_words) refuse(text, i, name, fmt::format("a key has more than {} words", most_words));
      ++i;
    }
  }
}

bool trips_assertion(std::string_view text) {
  try {
    (void)toml::parse(text);
  } catch (const TomlAssertion&) {
    return true;
  } catch (const toml::parse_error&) {
  }
  return false;
}

// Returns the place of the character at which an assertion of the parser fails, which does not say where. The parser
// reads from left to right, so the shortest beginning of the text that trips an assertion ends with the character that
// did it.
std::size_t place_of_assertion(std::string_view text) {
  std::size_t passes = 0, fails = text.size();
  while (passes + 1 < fails) {
    const std::size_t middle = passes + (fails - passes) / 2;
    (trips_assertion(text.substr(0, middle)) ? fails : passes) = middle;
  }
  return passes;
}

}  // namespace

toml::table parsed_toml(std::string_view text, const std::string& name) {
  check_words_of_keys(text, name);
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    const auto& at = error.source().begin;
    throw InputError({Problem{{name, int(at.line), int(at.column)}, fmt::format("not TOML: {}", error.description())}});
  } catch (const TomlAssertion&) {
    const std::size_t at = place_of_assertion(text);
    const std::string_view found = text.substr(at, 1);
    refuse(text, at, name, fmt::format("a key or a value belongs here, not '{}'", found == "\n" ? "\\n" : found));
  }
}

}  // namespace supple
