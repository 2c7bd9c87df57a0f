// Defines the command line, on which each verb describes its options. CLI11 reads the words, checks the values and
// writes the texts of --help. command_line.cpp is the only unit that includes that library, because it takes long to
// compile.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace supple {

// An action is what the program runs once it has understood the command line. It returns the exit status.
using Action = std::function<int()>;

// Refers to an option or a positional argument that has been added, and states what its values must satisfy.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option& required();
  Option& between(int least, int most);
  Option& between(std::size_t least, std::size_t most);
  Option& between(double least, double most);
  Option& one_of(const std::vector<std::string>& words);
  Option& repeatable();             // each time with one value
  Option& separated_by(char mark);  // one word may hold several values
  Option& two_values(const std::string& names);
  Option& needs(const Option& other);
  Option& excludes(const Option& other);
  Option& excludes(const std::vector<std::string>& names);  // of options that have been added
  Option& shows_default();                                  // --help tells what the variable holds at this call

 private:
  CLI::Option* option_;
};

// Holds a set of options. The variables that they fill must live until the action has run. A name that does not begin
// with a dash denotes a positional argument.
class Options {
 public:
  explicit Options(CLI::App* app) : app_(app) {}

  Option option(const std::string& name, std::string& value, const std::string& meaning);
  Option option(const std::string& name, int& value, const std::string& meaning);
  Option option(const std::string& name, long long& value, const std::string& meaning);
  Option option(const std::string& name, std::optional<std::size_t>& value, const std::string& meaning);
  Option option(const std::string& name, std::optional<double>& value, const std::string& meaning);
  Option option(const std::string& name, std::vector<std::string>& values, const std::string& meaning);
  Option option(const std::string& name, std::vector<int>& values, const std::string& meaning);
  Option option(const std::string& name, std::function<void(const std::string&)> take, const std::string& meaning);
  Option flag(const std::string& name, bool& given, const std::string& meaning);
  Option flag(const std::string& name, std::function<void()> take, const std::string& meaning);

 protected:
  CLI::App* app_;
};

class CommandLine;

class Verb : public Options {
 public:
  Verb(CLI::App* app, CommandLine& line) : Options(app), line_(&line) {}

  Options at_most_one_of(const std::string& title, const std::string& meaning);
  void footer(const std::string& text);  // of --help
  void hide();                           // from --help
  void runs(Action action);

  std::vector<std::string> given() const;  // the names of the options that stand on the line

 private:
  CommandLine* line_;
};

// Describes an option or a positional argument: its names and the values that it takes.
struct DescribedOption {
  std::vector<std::string> names;  // with their dashes; of a positional argument its name
  bool place = false;              // whether it is a positional argument
  bool takes_value = false;
  bool offered = true;               // whether the shell offers it; options of a group are not offered
  std::vector<std::string> choices;  // of its value; empty: anything
};
struct DescribedVerb {
  std::string name;
  std::vector<DescribedOption> options;
};

class CommandLine {
 public:
  CommandLine(int argc, char** argv);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  Verb verb(const std::string& name, const std::string& meaning);
  const std::vector<std::string>& words() const { return words_; }  // as the program was called

  // Reads the words. Returns the exit status where nothing is left to do, because help was asked for or a word is wrong
  // (a message then says which).
  std::optional<int> read();
  // Runs the action of the verb that was called.
  int run() const { return action_(); }

  std::vector<DescribedVerb> verbs() const;      // those that --help lists
  std::vector<DescribedOption> options() const;  // of the program itself

 private:
  friend class Verb;
  int argc_;
  char** argv_;
  std::vector<std::string> words_;
  std::unique_ptr<CLI::App> app_;
  Action action_;
};

}  // namespace supple
