// Answers the shell, which asks while a command is typed, with the words that fit. The answer comes from the command
// line's own description, so there is no second list of verbs and options to maintain.
#include <algorithm>
#include <memory>

#include "app/verbs.h"
#include "base/console.h"
#include "film/plan/shipped_files.h"

namespace supple {
namespace {

constexpr const char* files_too = "/";  // a line of its own in the answer: names of files fit here as well

using WordList = std::vector<std::string>;

// Returns the words that an option or a positional argument can take. The name of a positional argument tells which of
// the names that ship fit.
WordList values_of(const DescribedOption& option) {
  if (!option.choices.empty()) return option.choices;
  WordList words;
  for (const auto& [part, kind] : {std::pair("SCENE", "scenes"), {"REPLAY", "replays"}, {"SHAPE", "shapes"}}) {
    if (!option.place || option.names.front().find(part) == std::string::npos) continue;
    const WordList names = shipped_names(kind);
    words.insert(words.end(), names.begin(), names.end());
  }
  words.push_back(files_too);
  return words;
}

const DescribedOption* option_named(const DescribedVerb& verb, const std::string& word) {
  if (!word.starts_with("-")) return nullptr;
  const auto found = std::ranges::find_if(verb.options, [&](const DescribedOption& option) {
    return std::ranges::find(option.names, word) != option.names.end();
  });
  return found == verb.options.end() ? nullptr : &*found;
}

// Returns the words that can stand last on the line.
WordList fitting(const CommandLine& all, const WordList& line) {
  WordList words;
  const std::vector<DescribedVerb> verbs = all.verbs();
  if (line.size() <= 1) {
    for (const DescribedVerb& verb : verbs) words.push_back(verb.name);
    for (const DescribedOption& option : all.options())
      words.insert(words.end(), option.names.begin(), option.names.end());
    return words;
  }
  const auto verb = std::ranges::find(verbs, line.front(), &DescribedVerb::name);
  if (verb == verbs.end()) return words;
  std::size_t place = 0;  // the number of positional words before the last
  for (std::size_t i = 1; i + 1 < line.size(); ++i) {
    const DescribedOption* option = option_named(*verb, line[i]);
    if (option == nullptr) {
      ++place;
      continue;
    }
    if (!option->takes_value) continue;
    if (i + 2 == line.size()) return values_of(*option);
    ++i;
  }
  const bool option_begun = line.back().starts_with("-");
  for (const DescribedOption& option : verb->options) {
    if (!option.offered) continue;
    if (option.place ? option_begun || place-- != 0 : !option_begun) continue;
    const WordList fits = option.place ? values_of(option) : option.names;
    words.insert(words.end(), fits.begin(), fits.end());
  }
  return words;
}

int complete(const CommandLine& all, const WordList& line) {
  const std::string begun = line.empty() ? "" : line.back();
  for (const std::string& word : fitting(all, line)) {
    if (word == files_too || word.starts_with(begun)) say(stdout, word + "\n");
  }
  return 0;
}

}  // namespace

void add_complete(CommandLine& line) {
  Verb verb = line.verb("complete", "Words that can go on a command line; asked by the shell.");
  verb.hide();  // not for people
  verb.footer("Example: supple complete -- render squirrel --gl ''");
  // This option is declared so that the line may hold anything; the words are read from the command as it was called.
  auto declared = std::make_shared<WordList>();
  verb.option("WORDS", *declared, "the line after 'supple', the last word as far as it was typed");
  const WordList& called = line.words();
  const auto dashes = std::find(called.begin(), called.end(), "--");
  const WordList words(dashes == called.end() ? dashes : dashes + 1, called.end());
  verb.runs([&line, declared, words] { return complete(line, words); });
}

}  // namespace supple
