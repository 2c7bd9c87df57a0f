// Represents a parsed TOML file in which every value knows its file, line and column, and in which a key that no reader
// asked for is an error. Problems are collected rather than thrown one by one: a reader asks for all that it needs,
// then calls finish(). The readers' requests are also the documentation, because each key is requested with its unit
// and meaning. No other part of the program uses the TOML parser, and only toml_document.h includes it.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/error.h"
#include "base/names.h"
#include "base/text.h"
#include "base/types.h"
#include "scene/config/config_value.h"

namespace toml {
inline namespace v3 {
class node;
class table;
}  // namespace v3
}  // namespace toml

namespace supple {

// Describes a key: its name, unit and meaning, as docs/scene-format.md lists them.
struct Key {
  const char* name;
  const char* unit;
  const char* meaning;
};

// Lists the words that a key may have.
struct Words {
  std::vector<std::string> allowed;
  // These are the words of earlier versions, each with the word that replaces it now.
  std::vector<std::pair<std::string, std::string>> former = {};
  // These are words for what exists no more, each with the word for what is nearest to it.
  std::vector<std::pair<std::string, std::string>> gone = {};
};

// Holds one row of the documentation: a key that some reader asked for.
struct DocumentedKey {
  std::string path;  // a list is followed by []: body[].handles[].stiffness
  std::string type;
  std::string fallback;  // the default, or "required"
  std::string allowed;
  std::string unit;
  std::string meaning;
};

// Holds one value of a list, which will be put into another place.
struct ListedValue {
  ConfigValue value;
  std::string text;  // the whole value as people read it: words without quotes
  FilePlace place;   // where it stands
};

// Holds a path with a list of values: "a.b" = [...] or a.b = [...].
struct PathList {
  std::string path;
  std::vector<ListedValue> values;
  FilePlace place;
};

// Writes a text in quotes, as TOML reads it.
std::string toml_text(std::string_view text);

class ConfigTable;
struct KnownSurfaces;  // surfaces that a Config and its copies have read already (reading/known_surfaces.h)

class Config {
 public:
  // Reads a file. Throws InputError when there is no such file, when it is larger than 1 MB or when it is not TOML.
  // Relative paths in it are looked up first in the folder of the file, then in `assets`.
  static Config load(const std::filesystem::path& path, const std::filesystem::path& assets);
  static Config parse(std::string_view text, const std::string& name, const std::filesystem::path& assets);
  // Takes a text that stands for a file, in whose folder relative paths are looked up.
  static Config parse_beside(std::string_view text, const std::filesystem::path& file,
                             const std::filesystem::path& assets);
  Config(Config&&) noexcept;
  Config& operator=(Config&&) noexcept;
  ~Config();

  // Applies "path=value", as on the command line. Elements of lists are addressed by their names:
  // body.soft.material.mu. Setting one key of an exclusive group removes the others. Throws InputError.
  void set(const std::string& assignment, const std::vector<std::set<std::string>>& exclusive);

  // Does what set() does, with a value of another file. Messages about the path point to `place`.
  void put(const std::string& path, const ConfigValue& value, const FilePlace& place,
           const std::vector<std::set<std::string>>& exclusive);
  // Returns the value at a path, or nothing when no value has this path.
  std::optional<ConfigValue> value_at(const std::string& path) const;
  // Appends a table of another file to a list of tables, which is created when it does not exist.
  void append(const std::string& list_path, const ConfigValue& table, const FilePlace& place);
  // Sets a key of a table of the root. The table is created when it does not exist; the key may contain dots. Names of
  // files in the value that are relative to the working folder become absolute.
  void put_key(const std::string& table, const std::string& key, const ConfigValue& value);
  // Makes the names of files in all values absolute.
  void make_files_absolute();
  // Removes a key of the root table if it exists.
  void remove(const char* key);
  // Copies the document, but neither the problems nor the record of the keys that readers asked for.
  Config copy() const;

  ConfigTable root();
  void complain(const toml::node* where, const std::string& message);
  void complain(Problem problem);

  // Throws InputError with all problems, unknown keys among them, in the order of their lines.
  void finish();
  // Returns the problems so far, unknown keys among them, and empties the list.
  std::vector<Problem> take_problems();
  // Returns the problems so far. Keys that no reader has asked for yet are not among them.
  const std::vector<Problem>& complaints() const;

  const std::vector<DocumentedKey>& documented() const;
  // Returns every key that a reader asked for, table by table.
  const std::vector<KnownKey>& known() const;
  std::string as_json() const;  // the whole document after set()
  std::string as_toml() const;  // the same document as TOML, for a file
  std::shared_ptr<KnownSurfaces>& surfaces();
  const std::filesystem::path& assets() const;
  const std::string& name() const;

 private:
  friend class ConfigTable;
  struct Content;
  explicit Config(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

// Gives access to one table of a Config, which must outlive it.
class ConfigTable {
 public:
  // Tells whether the table has the key. From then on the key counts as known to the reader.
  bool has(const char* key) const;
  // Returns the keys in the order of the file, for tables whose keys are names that the user chose.
  std::vector<std::string> keys() const;

  // Each of these functions returns the value of a key. When the key is absent or wrong, it returns the default, and
  // records the problem if there is one. A key without a default is required.
  double number(const Key& key, std::optional<double> fallback, const Range& range) const;
  int integer(const Key& key, std::optional<int> fallback, const Range& range) const;
  bool boolean(const Key& key, bool fallback) const;
  std::string text(const Key& key, std::optional<std::string> fallback) const;
  std::string choice(const Key& key, std::optional<std::string> fallback, const Words& words) const;
  // Returns the value of an enum that the key names.
  template <Named E>
  E word(const Key& key, std::optional<E> fallback) const {
    return word<E>(key, fallback, {all_names<E>()});
  }
  // Does the same for an enum of which the key may have these words alone.
  template <Named E>
  E word(const Key& key, std::optional<E> fallback, const Words& words) const {
    std::optional<std::string> usual;
    if (fallback) usual = name_of(*fallback);
    return *value_named<E>(choice(key, std::move(usual), words));
  }
  // Returns the value of an enum that the key names; nothing when the key is absent or wrong. fallback: the default in
  // words, for the documentation.
  template <Named E>
  std::optional<E> word_if_given(const Key& key, const char* fallback) const {
    return value_named<E>(choice_if_given(key, fallback, {all_names<E>()}));
  }
  // Returns a list of words; empty when the key is absent or wrong.
  std::vector<std::string> choices(const Key& key, const Words& words) const;
  // Returns the values of an enum that a list of words names.
  template <Named E>
  std::vector<E> words(const Key& key) const {
    std::vector<E> values;
    for (const std::string& word : choices(key, {all_names<E>()})) values.push_back(*value_named<E>(word));
    return values;
  }
  // Returns a word, or a table with its own keys; nothing when the key is absent or wrong. `fallback`: the default as a
  // file would give it.
  std::optional<std::variant<std::string, ConfigTable>> word_or_table(const Key& key, const std::string& fallback,
                                                                      const Words& words) const;
  Vec3 vector(const Key& key, std::optional<Vec3> fallback, const Range& range = Range::any()) const;
  std::optional<double> number_if_given(const Key& key, const Range& range) const;
  std::optional<Vec3> vector_if_given(const Key& key, const Range& range = Range::any()) const;
  // Returns a colour in sRGB, which a file gives as three numbers or as "#rrggbb".
  Vec3 color(const Key& key, const Vec3& fallback) const;
  std::optional<Vec3> color_if_given(const Key& key) const;
  // Returns `count` points, or at least one where `count` is 0; none when the key is absent or wrong.
  std::vector<Vec3> vectors(const Key& key, std::size_t count) const;
  // Returns a list of at least one whole number, each `lowest` or above; it is empty when the key is absent or wrong.
  std::vector<int> integers(const Key& key, int lowest) const;
  // Returns two numbers, both in range.
  Eigen::Vector2d pair(const Key& key, const Range& range) const;
  // Returns a word, or two numbers in range; the fallback, which is a word, when the key is absent or wrong.
  std::variant<std::string, Eigen::Vector2d> word_or_pair(const Key& key, const std::string& fallback,
                                                          const Words& words, const Range& range) const;
  // Returns a list of pairs of finite numbers; it is empty when the key is absent or wrong.
  std::vector<std::pair<double, double>> pairs(const Key& key, std::size_t least, std::size_t most) const;
  // Returns true or false, or a list of texts; the fallback when the key is absent or wrong. `texts`: what the texts of
  // a list are, such as "names of bodies".
  std::variant<bool, std::vector<std::string>> boolean_or_texts(const Key& key, bool fallback, const char* texts) const;
  // Returns a list of texts; it is empty when the key is absent or wrong. `texts`: what they are, such as "names of
  // bodies".
  std::vector<std::string> required_texts(const Key& key, const char* texts) const;
  bool is_text(const char* key) const;
  // Returns an existing path, looked up in the folder of the file that names it or among the assets; empty when the key
  // is absent or wrong.
  std::filesystem::path file(const Key& key) const;
  // Does the same for a path that may name more than one file. is_there: tells whether what a path names is there.
  std::filesystem::path file_that(const Key& key,
                                  const std::function<bool(const std::filesystem::path&)>& is_there) const;

  // Returns a value of any type, which the caller must check.
  std::optional<ConfigValue> value(const Key& key, const char* fallback = "required") const;

  // Returns the whole table without one key. All its keys count as known to the reader.
  ConfigValue all_but(const char* key) const;

  std::optional<ConfigTable> table(const Key& key, const char* fallback = "none") const;
  std::vector<ConfigTable> tables(const Key& key) const;
  // Returns all lists in this table, whose keys are paths, in the order of the file.
  std::vector<PathList> path_lists() const;
  // Returns a number; nothing when the key is absent or wrong, or has the value `word`.
  std::optional<double> number_or_word(const Key& key, const char* word, const Range& range) const;

  // Returns a text or a number, or nothing when the key is absent or wrong. `texts`: what the text is, such as "name of
  // a body". `fallback`: what holds without the key.
  std::optional<std::variant<std::string, double>> text_or_number_if_given(const Key& key, const char* texts,
                                                                           const Range& range,
                                                                           const char* fallback) const;

  // Records a problem at a key's value, or at this table.
  void complain(const char* key, const std::string& message) const;
  void complain(const std::string& message) const;
  // Returns the place of a key, or of this table for nullptr, for messages that are written later.
  FilePlace place(const char* key) const;
  Config& config() const { return *config_; }

 private:
  friend class Config;
  ConfigTable(Config* config, const toml::table* table, std::string path, std::string generic);
  // Describes what a key may have.
  struct Allowed {
    Allowed(std::string in_words) : text(std::move(in_words)) {}
    Allowed(const char* in_words) : text(in_words) {}
    Allowed(const Range& values) : text(values.text()), range(values) {}
    Allowed(const Words& list) : text(word_list(list.allowed)), words(list.allowed) {}
    std::string text;
    Range range = {};
    std::vector<std::string> words = {};
  };
  const toml::node* find(const Key& key, const char* type, std::string fallback, Allowed allowed) const;
  void wrong(const Key& key, const toml::node& node, const std::string& allowed) const;
  std::string choice_if_given(const Key& key, const char* fallback, const Words& words) const;
  Vec3 color_at(const Key& key, const toml::node* node, const Vec3& fallback) const;
  bool is_one_of(const Words& words, const Key& key, const toml::node& node) const;

  Config* config_;
  const toml::table* table_;

  ConfigTable inner(const Key& key, const toml::table& table, const std::string& name, const char* suffix) const;

  std::string path_;     // as --set takes it
  std::string generic_;  // as in DocumentedKey
};

}  // namespace supple
