// What a Config owns; only for config.cpp and config_values.cpp, which know the TOML parser.
#pragma once

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

  Problem place(const toml::node* node, std::string message) const {
    if (node == nullptr) return {name, 0, 0, std::move(message)};
    const toml::source_region& region = node->source();
    const std::string source = region.path ? *region.path : name;
    const bool from_option = source.starts_with(set_option);
    return {source, from_option ? 0 : int(region.begin.line), from_option ? 0 : int(region.begin.column),
            std::move(message)};
  }
};

}  // namespace supple
