// What a Config owns; only for config.cpp and config_values.cpp, which know the TOML parser.
#pragma once

// The parser takes its assertions for a part of handling malformed files, and without them promises the compiler that
// they hold. They stay in any build.
#undef NDEBUG
#include <cassert>

#include <toml++/toml.h>

#include "scene/config.h"

namespace supple {

constexpr std::string_view set_option = "--set ";

struct Config::Content {
  toml::table document;
  std::string name;
  std::filesystem::path folder;
  std::filesystem::path assets;
  std::vector<Problem> problems;
  std::map<const toml::table*, std::vector<std::string>> asked;  // keys by table that was opened
  std::vector<DocumentedKey> documented;
  std::vector<KnownKey> known;
  std::shared_ptr<KnownSurfaces> surfaces;
  std::map<const toml::node*, toml::source_region> moved;  // where nodes that are copies stood; the parser forgets it

  const toml::source_region& source_of(const toml::node& node) const {
    const auto at = moved.find(&node);
    return at != moved.end() ? at->second : node.source();
  }

  // Beside what the file names in a value are: its own file, which may be a replay's; the working folder for options.
  std::filesystem::path folder_of(const toml::source_region& source) const {
    if (!source.path || *source.path == name) return folder;
    return source.path->starts_with(set_option) ? std::filesystem::path()
                                                : std::filesystem::path(*source.path).parent_path();
  }

  ConfigValue value_of(const toml::node& node) const;
  // A copy of a value has taken its place in the document.
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

// What a ConfigValue owns.
struct ConfigValue::Content {
  std::shared_ptr<const toml::node> node;
  std::vector<toml::source_region> places;  // of the node and those below it, as walk() goes
};

// Calls visit(node) for a node and all below it, in an order that copies share.
template <class Visit>
void walk(const toml::node& node, const Visit& visit) {
  visit(node);
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, inner] : *table) walk(inner, visit);
  } else if (const toml::array* list = node.as_array()) {
    for (const toml::node& inner : *list) walk(inner, visit);
  }
}

// As messages show a value.
std::string shown(const toml::node& node);

// An element of a list of tables goes by its name, or by its list's.
std::string name_of(const toml::table& element, const std::string& list);

}  // namespace supple
