#include "base/console.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace supple {
namespace {

void write(std::FILE* stream, std::string_view text) { (void)!std::fwrite(text.data(), 1, text.size(), stream); }

}  // namespace

void say(std::FILE* stream, std::string_view text) {
  const bool terminal = isatty(fileno(stream)) == 1;
  if (may_colour(terminal, std::getenv("NO_COLOR"), std::getenv("TERM"))) {
    write(stream, highlighted(text));
  } else {
    write(stream, text);
  }
}

std::string highlighted(std::string_view text) {
  constexpr std::pair<std::string_view, std::string_view> marks[] = {{"supple:", "\033[1;31m"},
                                                                     {"warning:", "\033[1m"}};
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
    std::string_view line = text.substr(begin, end - begin);
    for (const auto& [word, colour] : marks) {
      if (!line.starts_with(word)) continue;
      result.append(colour).append(word).append("\033[0m");
      line.remove_prefix(word.size());
      break;
    }
    result += line;
    begin = end;
  }
  return result;
}

bool may_colour(bool terminal, const char* no_color, const char* term) {
  const bool refused = no_color != nullptr && *no_color != '\0';
  return terminal && !refused && term != nullptr && std::string_view(term) != "dumb";
}

}  // namespace supple
