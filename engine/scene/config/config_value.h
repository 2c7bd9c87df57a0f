// Defines values and keys of a TOML file as changes and lists of keys hold them, without the file. Not here: how they
// are read (config.h).
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/names.h"

namespace supple {

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

// Describes one key of one table of a file, whether the file gives it or leaves it at the default.
struct KnownKey {
  std::string path;     // as --set takes it: body.soft.material.mu
  std::string generic;  // as in DocumentedKey
  std::string type, allowed, unit, meaning;
  std::string value;               // the value in the file, or the default
  Range range = {};                // range of numbers
  std::vector<std::string> words;  // the words that are allowed, where the value is one
};

// Selects how a value goes from one number to another.
enum class RampRule {
  difference,  // (1 - s) from + s to
  ratio,       // from^(1-s) to^s
};
template <>
struct Names<RampRule> {
  static constexpr std::array table = {Name{RampRule::difference, "difference"}, Name{RampRule::ratio, "ratio"}};
};

// Holds a value of any type, together with its place in its file.
class ConfigValue {
 public:
  std::string text() const;        // shortened so that it fits into a message
  std::string whole_text() const;  // the whole value as people read it: words without quotes
  bool is_list_or_number() const;
  // Tells whether a ramp can lead from one value to the other: both must be numbers, or lists (of lists, ...) of
  // numbers with the same structure; a colour "#rrggbb" counts as the list of its channels.
  bool joins(const ConfigValue& other) const;
  bool all_positive() const;
  // Reads a default in the form that KnownKey has. Returns nothing when the default is a description in words.
  // source: what messages name as the value's place.
  static std::optional<ConfigValue> parse(const std::string& text, const std::string& source = "");
  // Returns the value at a fraction `s` of the way, 0 to 1, interpolated number by number. whole: whether numbers are
  // rounded.
  static ConfigValue between(const ConfigValue& from, const ConfigValue& to, double s, RampRule by, bool whole);

 private:
  friend class Config;
  friend class ConfigTable;
  struct Content;
  explicit ConfigValue(std::shared_ptr<const Content> content) : content_(std::move(content)) {}
  std::shared_ptr<const Content> content_;
};

}  // namespace supple
