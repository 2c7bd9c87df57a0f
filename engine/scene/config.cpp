#include "scene/config.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "base/text.h"
#include "scene/config_content.h"

namespace supple {
namespace {

constexpr std::uintmax_t largest_file = 1 << 20;
}  // namespace

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

Problem ConfigTable::place(const char* key, std::string message) const {
  const toml::node* node = key != nullptr ? table_->get(key) : nullptr;
  return config_->content_->place(node != nullptr ? node : table_, std::move(message));
}

void ConfigTable::complain(const char* key, const std::string& message) const {
  config_->complain(place(key, message));
}

void ConfigTable::complain(const std::string& message) const { config_->complain(place(nullptr, message)); }

}  // namespace supple
