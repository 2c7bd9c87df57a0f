// Answers what a shell asks while a command is typed: which words fit. The answer comes from the command line's own
// description, so there is no second list of verbs and options to keep.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "app/verbs.h"
#include "base/console.h"
#include "film/places.h"

namespace supple {
namespace {

constexpr const char* files_too = "/";  // a line of its own in the answer: names of files fit here as well

using Words = std::vector<std::string>;

std::vector<const CLI::App*> visible_verbs(const CLI::App& app) {
  std::vector<const CLI::App*> verbs = app.get_subcommands([](const CLI::App*) { return true; });
  std::erase_if(verbs, [](const CLI::App* verb) { return verb->get_group().empty(); });
  return verbs;
}

Words names_of(const CLI::Option& option) {
  Words names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

// The words of a closed choice, which CLI11 describes as "{a,b,c}".
Words choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{'), end = type.find('}');
  Words words;
  if (begin == std::string::npos || end == std::string::npos) return words;
  std::string word;
  for (const char letter : type.substr(begin + 1, end - begin - 1) + ",") {
    if (letter != ',') {
      word += letter;
      continue;
    }
    words.push_back(std::exchange(word, ""));
  }
  return words;
}

// The words that an option or a place on the line can hold. Its own name tells which of the names that ship fit.
Words values_of(const CLI::Option& option) {
  Words words = choices_of(option);
  if (!words.empty()) return words;
  const std::string& place = option.get_name();
  for (const auto& [part, kind] : {std::pair("SCENE", "scenes"), {"REPLAY", "replays"}, {"SHAPE", "shapes"}}) {
    if (place.find(part) == std::string::npos) continue;
    const Words names = shipped_names(kind);
    words.insert(words.end(), names.begin(), names.end());
  }
  words.push_back(files_too);
  return words;
}

const CLI::Option* option_named(const CLI::App& verb, const std::string& word) {
  return word.starts_with("-") && word.size() > 1 ? verb.get_option_no_throw(word) : nullptr;
}

// The words that can stand last on the line.
Words fitting(const CLI::App& app, const Words& line) {
  Words words;
  if (line.size() <= 1) {
    for (const CLI::App* verb : visible_verbs(app)) words.push_back(verb->get_name());
    for (const CLI::Option* option : app.get_options())
      for (const std::string& name : names_of(*option)) words.push_back(name);
    return words;
  }
  const std::vector<const CLI::App*> verbs = visible_verbs(app);
  const auto found = std::ranges::find(verbs, line.front(), &CLI::App::get_name);
  if (found == verbs.end()) return words;
  const CLI::App* verb = *found;
  std::size_t place = 0;  // of positional words before the last
  for (std::size_t i = 1; i + 1 < line.size(); ++i) {
    const CLI::Option* option = option_named(*verb, line[i]);
    if (option == nullptr) {
      ++place;
      continue;
    }
    if (!takes_value(*option)) continue;
    if (i + 2 == line.size()) return values_of(*option);
    ++i;
  }
  const bool option_begun = line.back().starts_with("-");
  for (const CLI::Option* option : verb->get_options()) {
    const bool positional = option->get_positional();
    if (positional ? option_begun || place-- != 0 : !option_begun) continue;
    const Words fits = positional ? values_of(*option) : names_of(*option);
    words.insert(words.end(), fits.begin(), fits.end());
  }
  return words;
}

int complete(const CLI::App& app, const Words& line) {
  const std::string begun = line.empty() ? "" : line.back();
  for (const std::string& word : fitting(app, line)) {
    if (word == files_too || word.starts_with(begun)) say(stdout, word + "\n");
  }
  return 0;
}

}  // namespace

void add_complete(CLI::App& app, Action& action, const std::vector<std::string>& command) {
  CLI::App* verb = app.add_subcommand("complete", "Words that can go on a command line; asked by the shell.");
  verb->group("");  // not for people
  verb->footer("Example: supple complete -- render squirrel --gl ''");
  // Declared so that the line may hold anything; what is read is the command as it was called.
  auto words = std::make_shared<Words>();
  verb->add_option("WORDS", *words, "the line after 'supple', the last word as far as it was typed");
  const auto dashes = std::find(command.begin(), command.end(), "--");
  const Words line(dashes == command.end() ? dashes : dashes + 1, command.end());
  verb->callback([&app, &action, words, line] { action = [&app, line] { return complete(app, line); }; });
}

}  // namespace supple
