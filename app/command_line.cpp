#include "app/command_line.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <sstream>
#include <utility>

#include "base/console.h"
#include "base/text.h"
#include "output/run/run_folder.h"

namespace supple {
namespace {

std::vector<CLI::App*> visible_verbs(CLI::App& app) {
  return app.get_subcommands([](CLI::App* verb) { return !verb->get_group().empty(); });
}

// Returns the message for a first word that is not a verb; CLI11 alone would only say that a subcommand is required.
std::string unknown_word(CLI::App& app, const std::string& word) {
  std::vector<std::string> known = {"--help", "--version"};
  for (const CLI::App* verb : visible_verbs(app)) known.push_back(verb->get_name());
  return fmt::format("supple: no {} '{}'{}\nTry: supple --help\n", word.starts_with("-") ? "option" : "verb", word,
                     did_you_mean(word, known));
}

// Returns the words of a closed choice, which CLI11 describes as "{a,b,c}".
std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{'), end = type.find('}');
  std::vector<std::string> words;
  if (begin == std::string::npos || end == std::string::npos) return words;
  std::istringstream list(type.substr(begin + 1, end - begin - 1));
  for (std::string word; std::getline(list, word, ',');) words.push_back(word);
  return words;
}

// Appends the options of an app and of its groups.
void describe(CLI::App& app, bool offered, std::vector<DescribedOption>& list) {
  for (const CLI::Option* option : app.get_options()) {
    DescribedOption each;
    each.offered = offered;
    each.place = option->get_positional();
    each.takes_value = option->get_items_expected_max() > 0;
    each.choices = choices_of(*option);
    for (const std::string& name : option->get_snames()) each.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) each.names.push_back("--" + name);
    if (each.place) each.names = {option->get_name()};
    list.push_back(std::move(each));
  }
  for (CLI::App* group : app.get_subcommands([](CLI::App* verb) { return verb->get_name().empty(); }))
    describe(*group, false, list);
}

std::vector<DescribedOption> described(CLI::App& app) {
  std::vector<DescribedOption> list;
  describe(app, true, list);
  return list;
}

}  // namespace

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::between(int least, int most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

Option& Option::between(std::size_t least, std::size_t most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

Option& Option::between(double least, double most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

Option& Option::one_of(const std::vector<std::string>& words) {
  const CLI::IsMember member(words);
  const auto check = [words, member](std::string& word) {
    return member(word).empty() ? ""
                                : fmt::format("'{}': must be {}{}", word, word_list(words), did_you_mean(word, words));
  };
  option_->check(CLI::Validator(check, member.get_description()));  // the description tells --help the words
  return *this;
}

Option& Option::repeatable() {
  option_->take_all()->allow_extra_args(false);
  return *this;
}

Option& Option::separated_by(char mark) {
  option_->delimiter(mark);
  return *this;
}

Option& Option::two_values(const std::string& names) {
  option_->type_name(names)->expected(2);
  return *this;
}

Option& Option::needs(const Option& other) {
  option_->needs(other.option_);
  return *this;
}

Option& Option::excludes(const Option& other) {
  option_->excludes(other.option_);
  return *this;
}

Option& Option::excludes(const std::vector<std::string>& names) {
  for (const std::string& name : names) option_->excludes(name);
  return *this;
}

Option& Option::shows_default() {
  option_->capture_default_str();
  return *this;
}

Option Options::option(const std::string& name, std::string& value, const std::string& meaning) {
  return Option(app_->add_option(name, value, meaning));
}
Option Options::option(const std::string& name, int& value, const std::string& meaning) {
  return Option(app_->add_option(name, value, meaning));
}
Option Options::option(const std::string& name, long long& value, const std::string& meaning) {
  return Option(app_->add_option(name, value, meaning));
}
Option Options::option(const std::string& name, std::optional<std::size_t>& value, const std::string& meaning) {
  return Option(app_->add_option(name, value, meaning));
}
Option Options::option(const std::string& name, std::optional<double>& value, const std::string& meaning) {
  return Option(app_->add_option(name, value, meaning));
}
Option Options::option(const std::string& name, std::vector<std::string>& values, const std::string& meaning) {
  return Option(app_->add_option(name, values, meaning));
}
Option Options::option(const std::string& name, std::vector<int>& values, const std::string& meaning) {
  return Option(app_->add_option(name, values, meaning));
}
Option Options::option(const std::string& name, std::function<void(const std::string&)> take,
                       const std::string& meaning) {
  return Option(app_->add_option_function<std::string>(name, take, meaning));
}
Option Options::flag(const std::string& name, bool& given, const std::string& meaning) {
  return Option(app_->add_flag(name, given, meaning));
}
Option Options::flag(const std::string& name, std::function<void()> take, const std::string& meaning) {
  return Option(app_->add_flag_callback(name, std::move(take), meaning));
}

Options Verb::at_most_one_of(const std::string& title, const std::string& meaning) {
  CLI::Option_group* group = app_->add_option_group(title, meaning);
  group->require_option(0, 1);
  return Options(group);
}

void Verb::footer(const std::string& text) { app_->footer(text); }
void Verb::hide() { app_->group(""); }

void Verb::runs(Action action) {
  app_->callback([line = line_, action = std::move(action)] { line->action_ = action; });
}

std::vector<std::string> Verb::given() const {
  std::vector<std::string> names;
  for (const CLI::Option* option : app_->get_options()) {
    if (option->count() > 0) names.push_back(option->get_name());
  }
  return names;
}

CommandLine::CommandLine(int argc, char** argv)
    : argc_(argc),
      argv_(argv),
      words_(argv, argv + argc),
      app_(std::make_unique<CLI::App>("Simulates soft bodies fast and accurately, and films them.", "supple")) {
  app_->require_subcommand(1);
  app_->footer(
      "Examples: supple render squirrel --frames 60\n"
      "          supple list");
  app_->set_version_flag("--version", program_version());
  app_->failure_message([](const CLI::App* app, const CLI::Error& error) {
    return fmt::format("supple: {}\nTry: supple {}--help\n", error.what(),
                       app->get_subcommands().empty() ? "" : app->get_subcommands().front()->get_name() + " ");
  });
}

CommandLine::~CommandLine() = default;

Verb CommandLine::verb(const std::string& name, const std::string& meaning) {
  return Verb(app_->add_subcommand(name, meaning), *this);
}

std::optional<int> CommandLine::read() {
  try {
    app_->parse(argc_, argv_);
  } catch (const CLI::Success& asked) {
    return app_->exit(asked);
  } catch (const CLI::ParseError& error) {
    std::ostringstream help, message;
    (void)app_->exit(error, help, message);
    const bool no_verb = app_->get_subcommands().empty() && !app_->remaining().empty();
    say(stderr, no_verb ? unknown_word(*app_, app_->remaining().front()) : message.str());
    return 2;
  }
  return std::nullopt;
}

std::vector<DescribedVerb> CommandLine::verbs() const {
  std::vector<DescribedVerb> list;
  for (CLI::App* verb : visible_verbs(*app_)) list.push_back({verb->get_name(), described(*verb)});
  return list;
}

std::vector<DescribedOption> CommandLine::options() const { return described(*app_); }

}  // namespace supple
