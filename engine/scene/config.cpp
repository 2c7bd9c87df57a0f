#include "scene/config.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "base/text.h"

namespace supple {
namespace {

constexpr std::uintmax_t largest_file = 1 << 20;
constexpr std::string_view set_option = "--set ";

std::string shown(const toml::node& node) {
  if (node.is_table()) return "a table";
  std::string text;
  if (const auto number = node.value_exact<double>()) {
    text = fmt::format("{}", *number);
  } else if (const auto word = node.value_exact<std::string>()) {
    text = fmt::format("'{}'", *word);
  } else {
    std::ostringstream out;
    if (node.is_array()) out << *node.as_array();
    if (!node.is_array()) {
      node.visit([&out](const auto& value) {
        if constexpr (toml::is_value<decltype(value)>) out << value;
      });
    }
    text = out.str();
  }
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

std::string number_text(double value) { return fmt::format("{:g}", value); }

}  // namespace

std::string Range::text() const {
  const bool below = std::isfinite(lowest), above = std::isfinite(highest);
  if (below && above)
    return fmt::format("{}{} to {}", open_below ? "above " : "", number_text(lowest), number_text(highest));
  if (below) return fmt::format("{} {}", open_below ? "above" : "at least", number_text(lowest));
  if (above) return fmt::format("at most {}", number_text(highest));
  return "any number";
}

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

Config::Config(std::unique_ptr<Content> content) : content_(std::move(content)) {}
Config::Config(Config&&) noexcept = default;
Config& Config::operator=(Config&&) noexcept = default;
Config::~Config() = default;

Config Config::load(const std::filesystem::path& path, const std::filesystem::path& assets) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw InputError(path.string(), std::filesystem::exists(path, error) ? "is not a file" : "no such file");
  }
  if (std::filesystem::file_size(path, error) > largest_file)
    throw InputError(path.string(), "is larger than 1 MB: not a scene");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw InputError(path.string(), "cannot be read");
  Config config = parse(text.str(), path.string(), assets);
  config.content_->folder = path.parent_path();
  return config;
}

Config Config::parse(std::string_view text, const std::string& name, const std::filesystem::path& assets) {
  auto content = std::make_unique<Content>();
  content->name = name;
  content->assets = assets;
  if (text.size() > largest_file) throw InputError(name, "is larger than 1 MB: not a scene");
  try {
    content->document = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    const auto& at = error.source().begin;
    throw InputError({Problem{name, int(at.line), int(at.column), fmt::format("not TOML: {}", error.description())}});
  }
  return Config(std::move(content));
}

void Config::set(const std::string& assignment, const std::vector<std::set<std::string>>& exclusive) {
  const std::string source = std::string(set_option) + assignment;
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InputError(source, "should read path=value, such as solver.iterations=20");
  std::vector<std::string> path;
  std::istringstream words(assignment.substr(0, equals));
  for (std::string word; std::getline(words, word, '.');) path.push_back(word);
  const std::string value = assignment.substr(equals + 1);

  // A value that is not TOML is taken as the word that it is, so that no shell quotes are needed around names and
  // paths.
  toml::table parsed;
  try {
    parsed = toml::parse("value = " + value, source);
  } catch (const toml::parse_error&) {
    toml::value<std::string> word(value);
    parsed = toml::parse("value = ''", source);
    parsed.get("value")->as_string()->get() = value;
  }

  toml::table* table = &content_->document;
  for (std::size_t depth = 0; depth + 1 < path.size(); ++depth) {
    toml::node* next = table->get(path[depth]);
    if (next == nullptr) {
      table->insert(path[depth], toml::table{});
      next = table->get(path[depth]);
    }
    if (toml::array* list = next->as_array()) {
      const std::string& wanted = path[++depth];
      std::vector<std::string> names;  // an element without a name bears its list's
      toml::node* found = nullptr;
      for (toml::node& element : *list) {
        const toml::table* candidate = element.as_table();
        if (candidate == nullptr) continue;
        const std::string element_name =
            candidate->get("name") ? candidate->get("name")->value_or(std::string()) : path[depth - 1];
        names.push_back(element_name);
        if (element_name == wanted) found = &element;
      }
      if (found == nullptr || depth + 1 >= path.size()) {
        throw InputError(source, found == nullptr
                                     ? fmt::format("there is no {} named '{}' (there is {})", path[depth - 1], wanted,
                                                   word_list(names))
                                     : fmt::format("names a whole {}; a value inside it is wanted", path[depth - 1]));
      }
      next = found;
    }
    if (!next->is_table()) throw InputError(source, fmt::format("'{}' is not a table", path[depth]));
    table = next->as_table();
  }
  if (path.empty() || path.back().empty()) throw InputError(source, "the path ends in nothing");
  for (const std::set<std::string>& group : exclusive) {
    if (!group.contains(path.back())) continue;
    for (const std::string& other : group) table->erase(other);
  }
  table->insert_or_assign(path.back(), std::move(*parsed.get("value")));
}

ConfigTable Config::root() { return ConfigTable(this, &content_->document, ""); }

void Config::complain(const toml::node* where, const std::string& message) {
  content_->problems.push_back(content_->place(where, message));
}

void Config::complain(Problem problem) { content_->problems.push_back(std::move(problem)); }

std::vector<Problem> Config::take_problems() {
  std::vector<Problem> problems = std::exchange(content_->problems, {});
  for (const auto& [table, asked] : content_->asked) {
    for (const auto& [key, node] : *table) {
      if (std::find(asked.begin(), asked.end(), key.str()) != asked.end()) continue;
      const std::string nearest = nearest_word(key.str(), asked);
      const toml::source_region& region = key.source();
      Problem problem = content_->place(&node, "");
      if (problem.line > 0 && region.begin.line > 0) {
        problem.line = int(region.begin.line);
        problem.column = int(region.begin.column);
      }
      std::vector<std::string> sorted = asked;
      std::sort(sorted.begin(), sorted.end());
      sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
      problem.message =
          nearest.empty() ? fmt::format("unknown key '{}'; allowed here: {}", std::string(key.str()), word_list(sorted))
                          : fmt::format("unknown key '{}'; did you mean '{}'?", std::string(key.str()), nearest);
      problems.push_back(std::move(problem));
    }
  }
  std::stable_sort(problems.begin(), problems.end(), [](const Problem& a, const Problem& b) {
    return std::tie(a.source, a.line, a.column) < std::tie(b.source, b.line, b.column);
  });
  return problems;
}

void Config::finish() {
  std::vector<Problem> problems = take_problems();
  if (!problems.empty()) throw InputError(std::move(problems));
}

const std::vector<DocumentedKey>& Config::documented() const { return content_->documented; }
const std::filesystem::path& Config::assets() const { return content_->assets; }
const std::string& Config::name() const { return content_->name; }

std::string Config::as_json() const {
  std::ostringstream out;
  out << toml::json_formatter(content_->document);
  return out.str();
}

ConfigTable::ConfigTable(Config* config, const toml::table* table, std::string path)
    : config_(config), table_(table), path_(std::move(path)) {
  config_->content_->asked.try_emplace(table_);
}

bool ConfigTable::has(const char* key) const {
  config_->content_->asked[table_].push_back(key);
  return table_->contains(key);
}

std::vector<std::string> ConfigTable::keys() const {
  std::vector<std::string> names;
  for (const auto& [key, node] : *table_) names.emplace_back(key.str());
  return names;
}

const toml::node* ConfigTable::find(const Key& key, const char* type, std::string fallback, std::string allowed) const {
  config_->content_->asked[table_].push_back(key.name);
  const std::string path = path_.empty() ? key.name : path_ + "." + key.name;
  auto& documented = config_->content_->documented;
  const bool known = std::any_of(documented.begin(), documented.end(),
                                 [&](const DocumentedKey& d) { return d.path == path && d.type == type; });
  if (!known) documented.push_back({path, type, std::move(fallback), std::move(allowed), key.unit, key.meaning});
  return table_->get(key.name);
}

void ConfigTable::wrong(const Key& key, const toml::node& node, const std::string& allowed) const {
  config_->complain(&node, fmt::format("{} = {}: must be {}", key.name, shown(node), allowed));
}

double ConfigTable::number(const Key& key, std::optional<double> fallback, const Range& range) const {
  const toml::node* node = find(key, "number", fallback ? number_text(*fallback) : "required", range.text());
  const double instead = fallback.value_or(range.contains(1) ? 1 : range.lowest);
  if (node == nullptr) {
    if (!fallback) complain(fmt::format("'{}' is missing: {} ({})", key.name, key.meaning, range.text()));
    return instead;
  }
  const std::optional<double> value = node->is_number() ? node->value<double>() : std::nullopt;
  if (!value || !std::isfinite(*value) || !range.contains(*value)) {
    wrong(key, *node, value && !std::isfinite(*value) ? "finite" : range.text());
    return instead;
  }
  return *value;
}

std::optional<double> ConfigTable::number_if_given(const Key& key, const Range& range) const {
  if (find(key, "number", "none", range.text()) == nullptr) return std::nullopt;
  return number(key, std::nullopt, range);
}

std::optional<Vec3> ConfigTable::vector_if_given(const Key& key, const Range& range) const {
  if (find(key, "three numbers", "none", "three numbers") == nullptr) return std::nullopt;
  return vector(key, std::nullopt, range);
}

int ConfigTable::integer(const Key& key, std::optional<int> fallback, const Range& range) const {
  const toml::node* node =
      find(key, "whole number", fallback ? fmt::format("{}", *fallback) : "required", range.text());
  const int instead = fallback.value_or(1);
  if (node == nullptr) {
    if (!fallback) complain(fmt::format("'{}' is missing: {} ({})", key.name, key.meaning, range.text()));
    return instead;
  }
  const std::optional<std::int64_t> value = node->is_integer() ? node->value<std::int64_t>() : std::nullopt;
  if (!value || !range.contains(static_cast<double>(*value)) || std::abs(static_cast<double>(*value)) > 2e9) {
    wrong(key, *node, fmt::format("a whole number, {}", range.text()));
    return instead;
  }
  return static_cast<int>(*value);
}

bool ConfigTable::boolean(const Key& key, bool fallback) const {
  const toml::node* node = find(key, "true or false", fallback ? "true" : "false", "true or false");
  if (node == nullptr) return fallback;
  if (const auto value = node->value_exact<bool>()) return *value;
  wrong(key, *node, "true or false");
  return fallback;
}

std::string ConfigTable::text(const Key& key, std::optional<std::string> fallback) const {
  const toml::node* node = find(key, "text", fallback ? fmt::format("\"{}\"", *fallback) : "required", "text");
  if (node == nullptr) {
    if (!fallback) complain(fmt::format("'{}' is missing: {}", key.name, key.meaning));
    return fallback.value_or("");
  }
  if (const auto value = node->value_exact<std::string>()) return *value;
  wrong(key, *node, "text");
  return fallback.value_or("");
}

std::string ConfigTable::choice(const Key& key, std::optional<std::string> fallback,
                                const std::vector<std::string>& allowed) const {
  const toml::node* node =
      find(key, "word", fallback ? fmt::format("\"{}\"", *fallback) : "required", word_list(allowed));
  const std::string instead = fallback.value_or(allowed.front());
  if (node == nullptr) {
    if (!fallback) complain(fmt::format("'{}' is missing: {} ({})", key.name, key.meaning, word_list(allowed)));
    return instead;
  }
  const auto value = node->value_exact<std::string>();
  if (value && std::find(allowed.begin(), allowed.end(), *value) != allowed.end()) return *value;
  const std::string nearest = value ? nearest_word(*value, allowed) : "";
  wrong(key, *node,
        nearest.empty() ? word_list(allowed) : fmt::format("{}; did you mean '{}'?", word_list(allowed), nearest));
  return instead;
}

namespace {

std::optional<Vec3> as_vector(const toml::node& node) {
  const toml::array* list = node.as_array();
  if (list == nullptr || list->size() != 3) return std::nullopt;
  Vec3 value;
  for (int k = 0; k < 3; ++k) {
    const toml::node& element = (*list)[std::size_t(k)];
    const std::optional<double> x = element.is_number() ? element.value<double>() : std::nullopt;
    if (!x || !std::isfinite(*x)) return std::nullopt;
    value[k] = *x;
  }
  return value;
}

}  // namespace

Vec3 ConfigTable::vector(const Key& key, std::optional<Vec3> fallback, const Range& range) const {
  const auto form = [](const Vec3& v) { return fmt::format("[{:g}, {:g}, {:g}]", v.x(), v.y(), v.z()); };
  const std::string allowed = "three numbers" + (range.text() == "any number" ? "" : ", each " + range.text());
  const toml::node* node = find(key, "three numbers", fallback ? form(*fallback) : "required", allowed);
  const Vec3 instead = fallback.value_or(Vec3::Ones());
  if (node == nullptr) {
    if (!fallback) complain(fmt::format("'{}' is missing: {} ({})", key.name, key.meaning, allowed));
    return instead;
  }
  const std::optional<Vec3> value = as_vector(*node);
  const auto fits = [&range](const Vec3& v) {
    return range.contains(v.x()) && range.contains(v.y()) && range.contains(v.z());
  };
  if (value && fits(*value)) return *value;
  wrong(key, *node, value ? allowed : "a list of " + allowed + ", all finite");
  return instead;
}

std::vector<Vec3> ConfigTable::vectors(const Key& key, std::size_t count) const {
  const std::string allowed = fmt::format("{} lists of three numbers", count);
  const toml::node* node = find(key, "list of points", "required", allowed);
  if (node == nullptr) {
    complain(fmt::format("'{}' is missing: {} ({})", key.name, key.meaning, allowed));
    return {};
  }
  std::vector<Vec3> values;
  if (const toml::array* list = node->as_array()) {
    for (const toml::node& element : *list) {
      if (const auto value = as_vector(element)) values.push_back(*value);
    }
    if (values.size() == count && list->size() == count) return values;
  }
  wrong(key, *node, allowed + ", all finite");
  return {};
}

std::filesystem::path ConfigTable::file(const Key& key) const {
  const toml::node* node = find(key, "file", "none", "a path, beside the file that names it or among the assets");
  if (node == nullptr) return {};
  const auto value = node->value_exact<std::string>();
  if (!value || value->empty()) {
    wrong(key, *node, "a path");
    return {};
  }
  const bool from_option = node->source().path && node->source().path->starts_with(set_option);
  const std::filesystem::path beside = (from_option ? std::filesystem::path() : config_->content_->folder) / *value;
  const std::filesystem::path asset = config_->content_->assets / *value;
  std::error_code error;
  if (std::filesystem::exists(beside, error)) return beside;
  if (std::filesystem::exists(asset, error)) return asset;
  config_->complain(node, fmt::format("{} = '{}': no such file (looked for {} and {})", key.name, *value,
                                      beside.string(), asset.string()));
  return {};
}

std::optional<ConfigTable> ConfigTable::table(const Key& key, const char* fallback) const {
  const toml::node* node = find(key, "table", fallback, "a table");
  if (node == nullptr) return std::nullopt;
  if (const toml::table* inner = node->as_table()) {
    return ConfigTable(config_, inner, path_.empty() ? key.name : path_ + "." + key.name);
  }
  wrong(key, *node, "a table");
  return std::nullopt;
}

std::vector<ConfigTable> ConfigTable::tables(const Key& key) const {
  const toml::node* node = find(key, "list of tables", "none", "a list of tables");
  std::vector<ConfigTable> result;
  if (node == nullptr) return result;
  const toml::array* list = node->as_array();
  if (list == nullptr) {
    wrong(key, *node, fmt::format("a list of tables ([[{}]])", key.name));
    return result;
  }
  for (const toml::node& element : *list) {
    if (const toml::table* inner = element.as_table()) {
      result.push_back(
          ConfigTable(config_, inner, (path_.empty() ? key.name : path_ + "." + key.name) + std::string("[]")));
    } else {
      wrong(key, element, "a list of tables");
    }
  }
  return result;
}

std::optional<double> ConfigTable::number_or_word(const Key& key, const char* word, const Range& range) const {
  const std::string allowed = fmt::format("\"{}\" or {}", word, range.text());
  const toml::node* node = find(key, "number or word", fmt::format("\"{}\"", word), allowed);
  if (node == nullptr || node->value_exact<std::string>() == word) return std::nullopt;
  const std::optional<double> value = node->is_number() ? node->value<double>() : std::nullopt;
  if (value && std::isfinite(*value) && range.contains(*value)) return value;
  wrong(key, *node, allowed);
  return std::nullopt;
}

Problem ConfigTable::place(const char* key, std::string message) const {
  const toml::node* node = key != nullptr ? table_->get(key) : nullptr;
  return config_->content_->place(node != nullptr ? node : table_, std::move(message));
}

void ConfigTable::complain(const char* key, const std::string& message) const {
  config_->complain(place(key, message));
}

void ConfigTable::complain(const std::string& message) const { config_->complain(place(nullptr, message)); }

}  // namespace supple
