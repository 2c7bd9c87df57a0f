// A parsed TOML file in which every value knows its file, line and column, and in which a key that nobody asked for is
// an error. Problems are collected, not thrown one by one: a reader asks for all that it needs, then calls finish().
// The readers' questions are also the documentation: each key is asked for with its unit and meaning. The only place
// that knows the TOML parser.
#pragma once

#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/types.h"

namespace toml {
inline namespace v3 {
class node;
class table;
}  // namespace v3
}  // namespace toml

namespace supple {

// What a key is called, in which unit it is given and what it means; ends up in docs/scene-format.md.
struct Key {
  const char* name;
  const char* unit;
  const char* meaning;
};

struct Range {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool open_below = false;  // `lowest` itself is not allowed

  static Range any() { return {}; }
  static Range positive() { return {0, std::numeric_limits<double>::infinity(), true}; }
  static Range at_least(double lowest) { return {lowest}; }
  static Range between(double lowest, double highest) { return {lowest, highest}; }
  static Range above(double lowest, double highest) { return {lowest, highest, true}; }
  bool contains(double value) const { return (open_below ? value > lowest : value >= lowest) && value <= highest; }
  std::string text() const;
};

// One row of the documentation: a key that some reader asked for.
struct DocumentedKey {
  std::string path;  // with [] behind lists: body[].handles[].stiffness
  std::string type;
  std::string fallback;  // the default, or "required"
  std::string allowed;
  std::string unit;
  std::string meaning;
};

// One key of one table of a file, where it stands or could stand: body.soft.material.mu.
struct KnownKey {
  std::string path;     // as --set takes it
  std::string generic;  // as in DocumentedKey
  std::string type, allowed, unit, meaning;
  std::string value;  // as it stands, or the default
};

// A value of a file, whatever its type; knows where it stood.
class ConfigValue {
 public:
  std::string text() const;        // shortened to what fits into a message
  std::string whole_text() const;  // all of it, as people read it: words without quotes
  bool is_list_or_number() const;
  // Numbers, or lists of them (of lists, ...) of one form: what a ramp can lead through.
  bool joins(const ConfigValue& other) const;
  bool all_positive() const;
  // Of a default as KnownKey has it; nothing where that is only words.
  static std::optional<ConfigValue> parse(const std::string& text);
  // (1 - s) from + s to, number by number; by_ratio: from^(1-s) to^s; whole: rounded.
  static ConfigValue between(const ConfigValue& from, const ConfigValue& to, double s, bool by_ratio, bool whole);

 private:
  friend class Config;
  friend class ConfigTable;
  struct Content;
  explicit ConfigValue(std::shared_ptr<const Content> content) : content_(std::move(content)) {}
  std::shared_ptr<const Content> content_;
};

// A value out of a list, to be put elsewhere.
struct ListedValue {
  ConfigValue value;
  std::string text;  // whole, as people read it: words without quotes
  Problem place;     // where it stands
};

// What a table of lists has for one path: "a.b" = [...] or a.b = [...].
struct PathList {
  std::string path;
  std::vector<ListedValue> values;
  Problem place;
};

class ConfigTable;
struct KnownSurfaces;  // read once for a Config and its copies (shape_reader.cpp)

class Config {
 public:
  // Throws InputError: no such file, larger than 1 MB, or not TOML. `assets`: where relative paths are looked up
  // second.
  static Config load(const std::filesystem::path& path, const std::filesystem::path& assets);
  static Config parse(std::string_view text, const std::string& name, const std::filesystem::path& assets);
  Config(Config&&) noexcept;
  Config& operator=(Config&&) noexcept;
  ~Config();

  // Applies "path=value", as on the command line. Lists are entered by the name of their element:
  // body.soft.material.mu. Setting one key of an exclusive group removes the others. Throws InputError.
  void set(const std::string& assignment, const std::vector<std::set<std::string>>& exclusive);

  // The same with a value of another file; `place` is where messages about the path point.
  void put(const std::string& path, const ConfigValue& value, const Problem& place,
           const std::vector<std::set<std::string>>& exclusive);
  // Nothing where the path leads nowhere.
  std::optional<ConfigValue> value_at(const std::string& path) const;
  // Appends a table of another file to a list of tables that may not be there yet.
  void append(const std::string& list_path, const ConfigValue& table, const Problem& place);
  // Takes a key off the root, if it is there.
  void remove(const char* key);
  // The document as it stands, without what was asked of it.
  Config copy() const;

  ConfigTable root();
  void complain(const toml::node* where, const std::string& message);
  void complain(Problem problem);

  // Throws InputError with all problems, unknown keys among them, in the order of their lines.
  void finish();
  // The problems so far, unknown keys among them; empties the list.
  std::vector<Problem> take_problems();
  // The problems so far, without a word on keys that nobody has asked for yet.
  const std::vector<Problem>& complaints() const;

  const std::vector<DocumentedKey>& documented() const;
  // Every key that a reader asked for, table by table.
  const std::vector<KnownKey>& known() const;
  std::string as_json() const;  // the whole document after set()
  std::shared_ptr<KnownSurfaces>& surfaces();
  const std::filesystem::path& assets() const;
  const std::string& name() const;

 private:
  friend class ConfigTable;
  struct Content;
  explicit Config(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

// A view of one table of a Config; valid while that lives.
class ConfigTable {
 public:
  // Whether the key stands here; it counts as known to the reader.
  bool has(const char* key) const;
  // Keys as they stand, for tables whose keys are names that the user chose.
  std::vector<std::string> keys() const;

  // Each returns the value, or the default when the key is absent or wrong (and then the problem is recorded). Without
  // a default the key is required.
  double number(const Key& key, std::optional<double> fallback, const Range& range) const;
  int integer(const Key& key, std::optional<int> fallback, const Range& range) const;
  bool boolean(const Key& key, bool fallback) const;
  std::string text(const Key& key, std::optional<std::string> fallback) const;
  std::string choice(const Key& key, std::optional<std::string> fallback,
                     const std::vector<std::string>& allowed) const;
  Vec3 vector(const Key& key, std::optional<Vec3> fallback, const Range& range = Range::any()) const;
  std::optional<double> number_if_given(const Key& key, const Range& range) const;
  std::optional<Vec3> vector_if_given(const Key& key, const Range& range = Range::any()) const;
  std::vector<Vec3> vectors(const Key& key, std::size_t count) const;
  // Two numbers, both in range.
  Eigen::Vector2d pair(const Key& key, const Range& range) const;
  // A list of pairs of finite numbers; empty when the key is absent or wrong.
  std::vector<std::pair<double, double>> pairs(const Key& key, std::size_t least, std::size_t most) const;
  bool is_text(const char* key) const;
  // A path that exists, found beside the file that names it or among the assets; empty when absent or wrong.
  std::filesystem::path file(const Key& key) const;

  // Of any type, which is for the caller to judge.
  std::optional<ConfigValue> value(const Key& key, const char* fallback = "required") const;

  // The whole table but for one key; all of it counts as known to the reader.
  ConfigValue all_but(const char* key) const;

  std::optional<ConfigTable> table(const Key& key, const char* fallback = "none") const;
  std::vector<ConfigTable> tables(const Key& key) const;
  // All lists in this table, whose keys are paths, in the order in which they stand.
  std::vector<PathList> path_lists() const;
  // A number, or nothing when the key is absent or says `word`.
  std::optional<double> number_or_word(const Key& key, const char* word, const Range& range) const;

  // Records a problem at a key's value, or at this table.
  void complain(const char* key, const std::string& message) const;
  void complain(const std::string& message) const;
  // Where a key (or this table) stands, for messages that come later.
  Problem place(const char* key, std::string message) const;
  Config& config() const { return *config_; }

 private:
  friend class Config;
  ConfigTable(Config* config, const toml::table* table, std::string path, std::string generic);
  const toml::node* find(const Key& key, const char* type, std::string fallback, std::string allowed) const;
  void wrong(const Key& key, const toml::node& node, const std::string& allowed) const;

  Config* config_;
  const toml::table* table_;

  ConfigTable inner(const Key& key, const toml::table& table, const std::string& name, const char* behind) const;

  std::string path_;     // as --set takes it
  std::string generic_;  // as in DocumentedKey
};

}  // namespace supple
