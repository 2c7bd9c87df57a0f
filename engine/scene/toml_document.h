// Defines the parts of the TOML parser that Config, ConfigTable and ConfigValue hold. Only the three files that
// implement them include this header.
#pragma once

// The parser takes its assertions for a part of handling malformed files, and without them promises the compiler that
// they hold. They stay in any build, and throw: parsed_toml() reports what they find as an error of syntax. None of
// those that a file can reach stands in a function or a destructor that must not throw.
#undef NDEBUG
namespace supple {
struct TomlAssertion {};
[[noreturn]] void toml_assertion_failed();
}  // namespace supple
#define TOML_ASSERT(expr) ((expr) ? static_cast<void>(0) : ::supple::toml_assertion_failed())
// Documents are walked, copied and destroyed by recursion, so their depth is bounded.
#define TOML_MAX_NESTED_VALUES 32
#include <toml++/toml.h>

#include <unordered_set>

#include "scene/config.h"

namespace supple {

constexpr std::string_view set_option = "--set ";

struct Config::Content {
  toml::table document;
  std::string name;
  std::filesystem::path folder;
  std::filesystem::path assets;
  std::vector<Problem> problems;
  std::map<const toml::table*, std::vector<std::string>> asked;  // the keys that readers asked for, by table
  std::vector<DocumentedKey> documented;
  std::vector<KnownKey> known;
  std::unordered_set<std::string> known_paths, documented_keys;  // what the two lists hold, to look it up
  std::shared_ptr<KnownSurfaces> surfaces;
  // Holds the places of the originals of copied nodes, because the parser does not copy them.
  std::map<const toml::node*, toml::source_region> moved;

  const toml::source_region& source_of(const toml::node& node) const {
    const auto at = moved.find(&node);
    return at != moved.end() ? at->second : node.source();
  }

  // Returns the folder from which relative paths in a value start: the folder of the file that contains the value,
  // which may be a replay, or the working folder for values of --set.
  std::filesystem::path folder_of(const toml::source_region& source) const {
    if (!source.path || *source.path == name) return folder;
    return source.path->starts_with(set_option) ? std::filesystem::path()
                                                : std::filesystem::path(*source.path).parent_path();
  }

  ConfigValue value_of(const toml::node& node) const;
  // Records the places of a value after a copy of it has been put into the document.
  void settle(const toml::node& copy, const ConfigValue& value);

  Problem place(const toml::node* node, std::string message) const {
    if (node == nullptr) return {name, 0, 0, std::move(message)};
    const toml::source_region& region = source_of(*node);
    const std::string source = region.path ? *region.path : name;
    const bool from_option = source.starts_with(set_option);
    return {source, from_option ? 0 : int(region.begin.line), from_option ? 0 : int(region.begin.column),
            std::move(message)};
  }
};

// Holds the parts of a ConfigValue: a copy of a node, and the place of the original.
struct ConfigValue::Content {
  std::shared_ptr<const toml::node> node;
  std::vector<toml::source_region> places;  // of the node and of those below it, in the order of walk()
};

// Calls visit(node) for a node and all below it. The order is the same for a node and its copies.
template <class Visit>
void walk(const toml::node& node, const Visit& visit) {
  visit(node);
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, inner] : *table) walk(inner, visit);
  } else if (const toml::array* list = node.as_array()) {
    for (const toml::node& inner : *list) walk(inner, visit);
  }
}

// Parses a text. `name` is what the places of its nodes say. Throws InputError with line and column where the text is
// not TOML, and where a key has more than most_words words between dots.
toml::table parsed_toml(std::string_view text, const std::string& name);
inline constexpr std::size_t most_words = 32;

// Writes a value as messages show it.
std::string shown(const toml::node& node);

// Returns the name of an element of a list of tables, or the list's name when it has none.
std::string name_of(const toml::table& element, const std::string& list);

}  // namespace supple
