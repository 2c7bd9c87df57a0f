#include "scene/config/config.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "base/read_file.h"
#include "base/text.h"
#include "scene/config/toml_document.h"

namespace supple {
namespace {

constexpr std::uintmax_t largest_file = 1 << 20;

std::vector<std::string> words_of(const std::string& path) {
  std::vector<std::string> result;
  std::istringstream words(path);
  for (std::string word; std::getline(words, word, '.');) result.push_back(word);
  return result;
}

[[noreturn]] void fail(const FilePlace& place, std::string message) {
  throw InputError({Problem{place, std::move(message)}});
}

// Tells whether a path has reached a list of tables whose elements are addressed by their names: bodies, colliders and
// a body's handles.
bool is_named_list(const std::vector<std::string>& path, std::size_t depth) {
  return depth == 0 ? path[0] == "body" || path[0] == "collider" : path[0] == "body" && path[depth] == "handles";
}

std::string one_of(const std::string& list) { return list == "handles" ? "handle" : list; }

[[noreturn]] void fail_unnamed(const FilePlace& place, const std::string& list, const std::string& wanted,
                               const std::vector<std::string>& names) {
  fail(place, fmt::format("there is no {} named '{}' (there is {}){}", one_of(list), wanted,
                          names.empty() ? "none" : word_list(names), did_you_mean(wanted, names)));
}

using Places = std::map<const toml::node*, toml::source_region>;

// Finds the table that contains the last word of a path. Missing tables along the path are created; elements of lists
// are found by their names.
toml::table& enter(toml::table& document, Places& places, const std::vector<std::string>& path,
                   const FilePlace& place) {
  if (path.size() > most_words)
    fail(place, fmt::format("the path has {} words; {} are the most", path.size(), most_words));
  toml::table* table = &document;
  for (std::size_t depth = 0; depth + 1 < path.size(); ++depth) {
    toml::node* next = table->get(path[depth]);
    if (next == nullptr) {
      if (is_named_list(path, depth)) fail_unnamed(place, path[depth], path[depth + 1], {});
      table->insert(path[depth], toml::table{});
      next = table->get(path[depth]);
      const toml::source_position at{toml::source_index(place.line), toml::source_index(place.column)};
      places[next] = {at, at, std::make_shared<const std::string>(place.source)};
    }
    if (toml::array* list = next->as_array()) {
      if (!is_named_list(path, depth))
        fail(place, fmt::format("'{}' is a list whose entries have no names; it can be set as a whole", path[depth]));
      const std::string& wanted = path[++depth];
      std::vector<std::string> names;
      toml::node* found = nullptr;
      for (toml::node& element : *list) {
        if (!element.is_table()) continue;
        names.push_back(name_of(*element.as_table(), path[depth - 1]));
        if (names.back() == wanted) found = &element;
      }
      if (found == nullptr) fail_unnamed(place, path[depth - 1], wanted, names);
      if (depth + 1 >= path.size())
        fail(place, fmt::format("names a whole {}; a value inside it is wanted", one_of(path[depth - 1])));
      next = found;
    }
    if (!next->is_table()) {
      fail(place, fmt::format("'{}' is {} here, not a table with a '{}' in it; it can be set as a whole", path[depth],
                              shown(*next), path[depth + 1]));
    }
    table = next->as_table();
  }
  if (path.empty() || path.back().empty()) fail(place, "the path ends in nothing");
  return *table;
}

// Puts a copy of a value at a path, after removing the keys that exclude its key, and returns the copy.
toml::node& put_node(toml::table& document, Places& places, const std::vector<std::string>& path,
                     const FilePlace& place, const std::vector<std::set<std::string>>& exclusive,
                     const toml::node& value) {
  toml::table& table = enter(document, places, path, place);
  for (const std::set<std::string>& group : exclusive) {
    if (!group.contains(path.back())) continue;
    for (const std::string& other : group) table.erase(other);
  }
  value.visit([&](const auto& typed) { table.insert_or_assign(path.back(), typed); });
  return *table.get(path.back());
}

// Names bodies and colliders that have no name, so that paths can tell them apart. The first of them in a list is
// called like the list, and needs nothing; those after it get a name with a number.
void number_unnamed(toml::table& document) {
  for (const char* list : {"body", "collider"}) {
    toml::array* elements = document.get_as<toml::array>(list);
    int unnamed = 0;
    for (std::size_t i = 0; elements != nullptr && i < elements->size(); ++i) {
      toml::table* element = elements->get(i)->as_table();
      if (element == nullptr || element->contains("name") || ++unnamed == 1) continue;
      element->insert("name", fmt::format("{}_{}", list, unnamed));
    }
  }
}

}  // namespace

std::string name_of(const toml::table& element, const std::string& list) {
  return element.get("name") ? element.get("name")->value_or(std::string()) : list;
}

Config::Config(std::unique_ptr<Content> content) : content_(std::move(content)) {}
Config::Config(Config&&) noexcept = default;
Config& Config::operator=(Config&&) noexcept = default;
Config::~Config() = default;

Config Config::load(const std::filesystem::path& path, const std::filesystem::path& assets) {
  return parse_beside(read_file(path, largest_file), path, assets);
}

Config Config::parse_beside(std::string_view text, const std::filesystem::path& file,
                            const std::filesystem::path& assets) {
  Config config = parse(text, file.string(), assets);
  config.content_->folder = file.parent_path();
  return config;
}

Config Config::parse(std::string_view text, const std::string& name, const std::filesystem::path& assets) {
  auto content = std::make_unique<Content>();
  content->name = name;
  content->assets = assets;
  if (text.size() > largest_file) throw InputError(name, "is larger than 1.0 MB");
  content->document = parsed_toml(text, name);
  number_unnamed(content->document);
  return Config(std::move(content));
}

void Config::set(const std::string& assignment, const std::vector<std::set<std::string>>& exclusive) {
  const std::string source = std::string(set_option) + assignment;
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InputError(source, "should read path=value, such as solver.iterations=20");
  const std::vector<std::string> path = words_of(assignment.substr(0, equals));
  const std::string value = assignment.substr(equals + 1);

  // A value that is not TOML is taken as a plain word, so that names and paths need no shell quotes.
  toml::table parsed;
  try {
    parsed = parsed_toml("value = " + value, source);
  } catch (const InputError&) {
    parsed = parsed_toml("value = ''", source);
    parsed.get("value")->as_string()->get() = value;
  }

  const toml::node& put =
      put_node(content_->document, content_->moved, path, {source}, exclusive, *parsed.get("value"));
  content_->settle(put, content_->value_of(*parsed.get("value")));
}

void Config::put(const std::string& path, const ConfigValue& value, const FilePlace& place,
                 const std::vector<std::set<std::string>>& exclusive) {
  content_->settle(
      put_node(content_->document, content_->moved, words_of(path), place, exclusive, *value.content_->node), value);
}

void Config::append(const std::string& list_path, const ConfigValue& table, const FilePlace& place) {
  const std::vector<std::string> path = words_of(list_path);
  toml::table& parent = enter(content_->document, content_->moved, path, place);
  if (!parent.contains(path.back())) parent.insert(path.back(), toml::array{});
  toml::array* list = parent.get(path.back())->as_array();
  if (list == nullptr) fail(place, fmt::format("'{}' is not a list of tables", list_path));
  list->push_back(*table.content_->node->as_table());
  content_->settle(list->back(), table);
}

std::optional<ConfigValue> Config::value_at(const std::string& path) const {
  const std::vector<std::string> words = words_of(path);
  const toml::node* node = &content_->document;
  for (std::size_t depth = 0; depth < words.size(); ++depth) {
    if (const toml::array* list = node->as_array()) {
      node = nullptr;
      for (const toml::node& element : *list) {
        if (element.is_table() && name_of(*element.as_table(), words[depth - 1]) == words[depth]) node = &element;
      }
    } else {
      node = node->is_table() ? node->as_table()->get(words[depth]) : nullptr;
    }
    if (node == nullptr) return std::nullopt;
  }
  return content_->value_of(*node);
}

namespace {

// Makes relative names of files that exist absolute, in a node and all below it. folder_of: returns the folder in which
// the names of a node are looked up.
template <class FolderOf>
void make_absolute(toml::node& node, std::string_view key, const FolderOf& folder_of) {
  static constexpr std::array file_keys = {"surface", "shape", "mesh", "ghost", "reference", "run"};
  if (toml::table* table = node.as_table()) {
    const std::string path = (*table)["path"].value_or(std::string());  // path of a change: tells what its value is
    for (auto&& [name, inner] : *table)
      make_absolute(inner, name == "value" && !path.empty() ? path : name.str(), folder_of);
  } else if (toml::array* list = node.as_array()) {
    for (toml::node& inner : *list) make_absolute(inner, key, folder_of);
  } else if (toml::value<std::string>* text = node.as_string()) {
    const std::string_view word = key.substr(key.rfind('.') + 1);
    if (std::ranges::find(file_keys, word) == file_keys.end() || text->get().empty()) return;
    std::error_code error;
    const std::filesystem::path file = folder_of(node) / text->get();
    if (std::filesystem::exists(file, error))
      text->get() = std::filesystem::absolute(file, error).lexically_normal().string();
  }
}

}  // namespace

void Config::put_key(const std::string& table, const std::string& key, const ConfigValue& value) {
  if (!content_->document.contains(table)) content_->document.insert(table, toml::table{});
  toml::table* into = content_->document.get_as<toml::table>(table);
  if (into == nullptr) fail({content_->name}, fmt::format("'{}' is not a table", table));
  value.content_->node->visit([&](const auto& typed) { into->insert_or_assign(key, typed); });
  toml::node& node = *into->get(key);
  content_->settle(node, value);
  make_absolute(node, key, [](const toml::node&) { return std::filesystem::current_path(); });
}

void Config::make_files_absolute() {
  make_absolute(content_->document, "",
                [this](const toml::node& node) { return content_->folder_of(content_->source_of(node)); });
}

void Config::remove(const char* key) { content_->document.erase(key); }

Config Config::copy() const {
  auto content = std::make_unique<Content>();
  content->document = content_->document;
  content->settle(content->document, content_->value_of(content_->document));
  content->name = content_->name;
  content->folder = content_->folder;
  content->assets = content_->assets;
  content->surfaces = content_->surfaces;
  return Config(std::move(content));
}

ConfigTable Config::root() { return ConfigTable(this, &content_->document, "", ""); }

void Config::complain(const toml::node* where, const std::string& message) {
  content_->problems.push_back({content_->place(where), message});
}

void Config::complain(Problem problem) { content_->problems.push_back(std::move(problem)); }

std::vector<Problem> Config::take_problems() {
  std::vector<Problem> problems = std::exchange(content_->problems, {});
  for (const auto& [table, asked] : content_->asked) {
    for (const auto& [key, node] : *table) {
      if (std::find(asked.begin(), asked.end(), key.str()) != asked.end()) continue;
      const std::string nearest = did_you_mean(key.str(), asked);
      const toml::source_region& region = key.source();
      FilePlace place = content_->place(&node);
      if (place.line > 0 && region.begin.line > 0) {
        place.line = int(region.begin.line);
        place.column = int(region.begin.column);
      }
      std::vector<std::string> sorted = asked;
      std::sort(sorted.begin(), sorted.end());
      sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
      problems.push_back(
          {std::move(place), fmt::format("unknown key '{}'{}", std::string(key.str()),
                                         nearest.empty() ? "; allowed here: " + word_list(sorted) : nearest)});
    }
  }
  std::stable_sort(problems.begin(), problems.end(),
                   [](const Problem& a, const Problem& b) { return a.place < b.place; });
  return problems;
}

void Config::finish() {
  std::vector<Problem> problems = take_problems();
  if (!problems.empty()) throw InputError(std::move(problems));
}

const std::vector<Problem>& Config::complaints() const { return content_->problems; }
const std::vector<DocumentedKey>& Config::documented() const { return content_->documented; }
const std::vector<KnownKey>& Config::known() const { return content_->known; }
std::shared_ptr<KnownSurfaces>& Config::surfaces() { return content_->surfaces; }
const std::filesystem::path& Config::assets() const { return content_->assets; }
const std::string& Config::name() const { return content_->name; }

std::string Config::as_json() const {
  std::ostringstream out;
  out << toml::json_formatter(content_->document);
  return out.str();
}

std::string Config::as_toml() const {
  std::ostringstream out;
  out << toml::toml_formatter(content_->document,
                              toml::toml_formatter::default_flags & ~toml::format_flags::indentation);
  return out.str();
}

}  // namespace supple
