// Implements ConfigTable: the typed requests of the readers.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "base/near_files.h"
#include "base/text.h"
#include "scene/config/toml_document.h"

namespace supple {
namespace {

std::string number_text(double value) { return fmt::format("{:g}", value); }

// Describes what a number must be.
std::string number_in(const Range& range) {
  const std::string text = range.text();
  return text == "any number" ? "a number" : "a number, " + text;
}

// Explains why a word looks like a number: it stands in quotes, or it came from --set and is larger than a double can
// be, so that TOML did not accept it.
const char* word_hint(const toml::node& node) {
  const auto word = node.value_exact<std::string>();
  if (!word || word->empty()) return "";
  double number = 0;
  const auto [end, error] = std::from_chars(word->data(), word->data() + word->size(), number);
  if (end != word->data() + word->size()) return "";
  return error == std::errc::result_out_of_range ? " (beyond what a number holds)" : " (in quotes it is a word)";
}

}  // namespace

std::string shown(const toml::node& node) {
  if (node.is_table()) return "a table";
  std::string text;
  if (const auto number = node.value_exact<double>()) {
    text = fmt::format("{}", *number);
  } else if (const auto word = node.value_exact<std::string>()) {
    text = fmt::format("'{}'", *word);
  } else {
    std::ostringstream out;
    if (const toml::array* list = node.as_array()) {
      for (std::size_t i = 0; i < list->size(); ++i) out << (i == 0 ? "" : ", ") << shown((*list)[i]);
      text = "[" + out.str() + "]";
    } else {
      node.visit([&out](const auto& value) {
        if constexpr (toml::is_value<decltype(value)>) out << value;
      });
      text = out.str();
    }
  }
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

std::string Range::text() const {
  const bool below = std::isfinite(lowest), above = std::isfinite(highest);
  if (below && above)
    return fmt::format("{}{} to {}", open_below ? "above " : "", number_text(lowest), number_text(highest));
  if (below) return fmt::format("{} {}", open_below ? "above" : "at least", number_text(lowest));
  if (above) return fmt::format("at most {}", number_text(highest));
  return "any number";
}

ConfigTable::ConfigTable(Config* config, const toml::table* table, std::string path, std::string generic)
    : config_(config), table_(table), path_(std::move(path)), generic_(std::move(generic)) {
  config_->content_->asked.try_emplace(table_);
}

namespace {

std::string joined(const std::string& path, const char* name) { return path.empty() ? name : path + "." + name; }

}  // namespace

// Returns a table that the key has. `name`: the name of a list's element, with its dot. `suffix`: the end of the
// generic path of a list.
ConfigTable ConfigTable::inner(const Key& key, const toml::table& table, const std::string& name,
                               const char* suffix) const {
  return ConfigTable(config_, &table, joined(path_, key.name) + name, joined(generic_, key.name) + suffix);
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

const toml::node* ConfigTable::find(const Key& key, const char* type, std::string fallback, Allowed allowed) const {
  config_->content_->asked[table_].push_back(key.name);
  const toml::node* node = table_->get(key.name);
  const std::string generic = joined(generic_, key.name);
  Config::Content& content = *config_->content_;
  if (std::string path = joined(path_, key.name); content.known_paths.insert(path).second) {
    content.known.push_back({std::move(path), generic, type, allowed.text, key.unit, key.meaning,
                             node != nullptr ? shown(*node) : fallback, allowed.range, std::move(allowed.words)});
  }
  if (content.documented_keys.insert(generic + '\n' + type).second)
    content.documented.push_back({generic, type, std::move(fallback), std::move(allowed.text), key.unit, key.meaning});
  return node;
}

FilePlace ConfigTable::place(const char* key) const {
  const toml::node* node = key != nullptr ? table_->get(key) : nullptr;
  return config_->content_->place(node != nullptr ? node : table_);
}

void ConfigTable::complain(const char* key, const std::string& message) const {
  config_->complain({place(key), message});
}

void ConfigTable::complain(const std::string& message) const { config_->complain({place(nullptr), message}); }

void ConfigTable::wrong(const Key& key, const toml::node& node, const std::string& allowed) const {
  config_->complain(&node, fmt::format("{} = {}: must be {}", key.name, shown(node), allowed));
}

namespace {

// The largest number that a file may give, far more than any unit needs. Formulas raise numbers to the fourth power and
// multiply several of them; with larger numbers they would leave the range of a double in a place that does not know
// the key.
constexpr double most_of_any = 1e30;

bool is_usable(double value) { return std::abs(value) <= most_of_any; }  // false for infinities and NaN

std::string usable_text(double value) {
  return std::isfinite(value) ? fmt::format("between {:g} and {:g}", -most_of_any, most_of_any) : "finite";
}

// Says what the numbers of a list must be, by the first number that is not.
std::string all_usable(const toml::node& node) {
  std::string text = "finite";
  walk(node, [&text](const toml::node& inner) {
    const std::optional<double> value = inner.is_number() ? inner.value<double>() : std::nullopt;
    if (value && std::isfinite(*value) && !is_usable(*value)) text = usable_text(*value);
  });
  return ", all " + text;
}

}  // namespace

double ConfigTable::number(const Key& key, std::optional<double> fallback, const Range& range) const {
  const toml::node* node = find(key, "number", fallback ? number_text(*fallback) : "required", range);
  const double instead = fallback.value_or(range.contains(1) ? 1 : range.lowest);
  if (node == nullptr) {
    if (!fallback) complain(fmt::format("'{}' is missing: {} ({})", key.name, key.meaning, range.text()));
    return instead;
  }
  const std::optional<double> value = node->is_number() ? node->value<double>() : std::nullopt;
  if (!value || !is_usable(*value) || !range.contains(*value)) {
    const bool usable = value && is_usable(*value);
    wrong(key, *node, usable ? range.text() : value ? usable_text(*value) : number_in(range) + word_hint(*node));
    return instead;
  }
  return *value;
}

std::optional<double> ConfigTable::number_if_given(const Key& key, const Range& range) const {
  if (find(key, "number", "none", range) == nullptr) return std::nullopt;
  return number(key, std::nullopt, range);
}

std::optional<Vec3> ConfigTable::vector_if_given(const Key& key, const Range& range) const {
  if (find(key, "three numbers", "none", "three numbers") == nullptr) return std::nullopt;
  return vector(key, std::nullopt, range);
}

int ConfigTable::integer(const Key& key, std::optional<int> fallback, const Range& range) const {
  const toml::node* node = find(key, "whole number", fallback ? fmt::format("{}", *fallback) : "required", range);
  const int instead = fallback.value_or(1);
  if (node == nullptr) {
    if (!fallback) complain(fmt::format("'{}' is missing: {} ({})", key.name, key.meaning, range.text()));
    return instead;
  }
  const std::optional<double> value = node->is_number() ? node->value<double>() : std::nullopt;  // 10.0 is whole too
  if (!value || *value != std::trunc(*value) || !range.contains(*value) || std::abs(*value) > 2e9) {
    wrong(key, *node, fmt::format("a whole number, {}{}", range.text(), word_hint(*node)));
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

// Tells whether a value is one of the words, and records a problem when it is not.
bool ConfigTable::is_one_of(const Words& words, const Key& key, const toml::node& node) const {
  const auto value = node.value_exact<std::string>();
  if (value && std::find(words.allowed.begin(), words.allowed.end(), *value) != words.allowed.end()) return true;
  for (const auto& [word, instead] : words.former) {
    if (value != word) continue;
    config_->complain(&node, fmt::format("{0} = '{1}': is now written {0} = {2}", key.name, word, instead));
    return false;
  }
  for (const auto& [word, nearest] : words.gone) {
    if (value != word) continue;
    config_->complain(&node, fmt::format("{0} = '{1}': exists no more; nearest is {0} = {2}", key.name, word, nearest));
    return false;
  }
  wrong(key, node, word_list(words.allowed) + (value ? did_you_mean(*value, words.allowed) : ""));
  return false;
}

std::string ConfigTable::choice(const Key& key, std::optional<std::string> fallback, const Words& words) const {
  const std::string list = word_list(words.allowed);
  const toml::node* node = find(key, "word", fallback ? fmt::format("\"{}\"", *fallback) : "required", words);
  const std::string instead = fallback.value_or(words.allowed.front());
  if (node == nullptr) {
    if (!fallback) complain(fmt::format("'{}' is missing: {} ({})", key.name, key.meaning, list));
    return instead;
  }
  return is_one_of(words, key, *node) ? *node->value_exact<std::string>() : instead;
}

std::vector<std::string> ConfigTable::choices(const Key& key, const Words& words) const {
  const std::string allowed = "a list of " + word_list(words.allowed);
  const toml::node* node = find(key, "list of words", "none", allowed);
  std::vector<std::string> values;
  if (node == nullptr) return values;
  const toml::array* list = node->as_array();
  if (list == nullptr) {
    wrong(key, *node, allowed);
    return values;
  }
  for (const toml::node& element : *list)
    if (is_one_of(words, key, element)) values.push_back(*element.value_exact<std::string>());
  return values;
}

// Returns the word that a key has; an empty text when the key is absent or wrong.
std::string ConfigTable::choice_if_given(const Key& key, const char* fallback, const Words& words) const {
  const toml::node* node = find(key, "word", fallback, words);
  return node != nullptr && is_one_of(words, key, *node) ? *node->value_exact<std::string>() : "";
}

std::optional<std::variant<std::string, ConfigTable>> ConfigTable::word_or_table(const Key& key,
                                                                                 const std::string& fallback,
                                                                                 const Words& words) const {
  const toml::node* node = find(key, "word", fallback, words);
  (void)find(key, "table", "none", "a table");
  if (node == nullptr) return std::nullopt;
  if (const toml::table* table = node->as_table()) return inner(key, *table, "", "");
  if (is_one_of(words, key, *node)) return *node->value_exact<std::string>();
  return std::nullopt;
}

namespace {

template <int size>
std::optional<Eigen::Matrix<double, size, 1>> as_vector(const toml::node& node) {
  const toml::array* list = node.as_array();
  if (list == nullptr || list->size() != size) return std::nullopt;
  Eigen::Matrix<double, size, 1> value;
  for (int k = 0; k < size; ++k) {
    const toml::node& element = (*list)[std::size_t(k)];
    const std::optional<double> x = element.is_number() ? element.value<double>() : std::nullopt;
    if (!x || !is_usable(*x)) return std::nullopt;
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
  const std::optional<Vec3> value = as_vector<3>(*node);
  const auto fits = [&range](const Vec3& v) {
    return range.contains(v.x()) && range.contains(v.y()) && range.contains(v.z());
  };
  if (value && fits(*value)) return *value;
  wrong(key, *node, value ? allowed : "a list of " + allowed + all_usable(*node));
  return instead;
}

namespace {

constexpr const char* color_forms = "three numbers, each 0 to 1, or \"#rrggbb\"";

}  // namespace

std::optional<Vec3> hex_color(const std::string& text) {
  if (text.size() != 7 || text[0] != '#' || text.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos)
    return std::nullopt;
  const auto channel = [&text](std::size_t at) { return std::stoi(text.substr(at, 2), nullptr, 16) / 255.0; };
  return Vec3(channel(1), channel(3), channel(5));
}

Vec3 ConfigTable::color_at(const Key& key, const toml::node* node, const Vec3& fallback) const {
  if (node == nullptr) return fallback;
  const std::optional<std::string> text = node->value_exact<std::string>();
  const std::optional<Vec3> value = text ? hex_color(*text) : as_vector<3>(*node);
  if (value && value->minCoeff() >= 0 && value->maxCoeff() <= 1) return *value;
  wrong(key, *node, color_forms);
  return fallback;
}

Vec3 ConfigTable::color(const Key& key, const Vec3& fallback) const {
  const std::string usual = fmt::format("[{:g}, {:g}, {:g}]", fallback.x(), fallback.y(), fallback.z());
  return color_at(key, find(key, "three numbers", usual, color_forms), fallback);
}

std::optional<Vec3> ConfigTable::color_if_given(const Key& key) const {
  const toml::node* node = find(key, "three numbers", "none", color_forms);
  if (node == nullptr) return std::nullopt;
  return color_at(key, node, Vec3::Ones());
}

std::vector<Vec3> ConfigTable::vectors(const Key& key, std::size_t count) const {
  const std::string allowed =
      count > 0 ? fmt::format("{} lists of three numbers", count) : std::string("lists of three numbers");
  const toml::node* node = find(key, "list of points", "required", allowed);
  if (node == nullptr) {
    complain(fmt::format("'{}' is missing: {} ({})", key.name, key.meaning, allowed));
    return {};
  }
  std::vector<Vec3> values;
  if (const toml::array* list = node->as_array()) {
    for (const toml::node& element : *list) {
      if (const auto value = as_vector<3>(element)) values.push_back(*value);
    }
    if (values.size() == list->size() && !values.empty() && (count == 0 || values.size() == count)) return values;
  }
  wrong(key, *node, allowed + all_usable(*node));
  return {};
}

std::vector<int> ConfigTable::integers(const Key& key, int lowest) const {
  const std::string allowed = fmt::format("a list of whole numbers, each at least {}", lowest);
  const toml::node* node = find(key, "list of whole numbers", "none", allowed);
  if (node == nullptr) return {};
  std::vector<int> values;
  if (const toml::array* list = node->as_array()) {
    for (const toml::node& element : *list) {
      const auto value = element.is_integer() ? element.value<int>() : std::nullopt;
      if (value && *value >= lowest) values.push_back(*value);
    }
    if (!values.empty() && values.size() == list->size()) return values;
  }
  wrong(key, *node, allowed);
  return {};
}

Eigen::Vector2d ConfigTable::pair(const Key& key, const Range& range) const {
  const std::string allowed = "two numbers, each " + range.text();
  const toml::node* node = find(key, "two numbers", "required", allowed);
  const Eigen::Vector2d instead = Eigen::Vector2d::Ones();
  if (node == nullptr) {
    complain(fmt::format("'{}' is missing: {} ({})", key.name, key.meaning, allowed));
    return instead;
  }
  const std::optional<Eigen::Vector2d> value = as_vector<2>(*node);
  if (value && range.contains(value->x()) && range.contains(value->y())) return *value;
  wrong(key, *node, "a list of " + allowed);
  return instead;
}

std::variant<std::string, Eigen::Vector2d> ConfigTable::word_or_pair(const Key& key, const std::string& fallback,
                                                                     const Words& words, const Range& range) const {
  const std::string allowed = fmt::format("{}, or two numbers, each {}", word_list(words.allowed), range.text());
  const toml::node* node = find(key, "word or two numbers", fmt::format("\"{}\"", fallback), allowed);
  if (node == nullptr) return fallback;
  if (node->is_string()) return is_one_of(words, key, *node) ? *node->value_exact<std::string>() : fallback;
  const std::optional<Eigen::Vector2d> value = as_vector<2>(*node);
  if (value && range.contains(value->x()) && range.contains(value->y())) return *value;
  wrong(key, *node, allowed);
  return fallback;
}

std::vector<std::pair<double, double>> ConfigTable::pairs(const Key& key, std::size_t least, std::size_t most) const {
  const std::string allowed = fmt::format("{} to {} lists of two numbers", least, most);
  const toml::node* node = find(key, "list of pairs", "none", allowed);
  std::vector<std::pair<double, double>> values;
  if (node == nullptr) return values;
  if (const toml::array* list = node->as_array(); list != nullptr && list->size() >= least && list->size() <= most) {
    for (const toml::node& element : *list) {
      if (const auto value = as_vector<2>(element)) values.emplace_back(value->x(), value->y());
    }
    if (values.size() == list->size()) return values;
  }
  wrong(key, *node, allowed + all_usable(*node));
  return {};
}

namespace {

// Returns the texts of a list; nothing where the node is no list, or has something else in it.
std::optional<std::vector<std::string>> texts_of(const toml::node& node) {
  const toml::array* list = node.as_array();
  if (list == nullptr) return std::nullopt;
  std::vector<std::string> values;
  for (const toml::node& element : *list) {
    const auto value = element.value_exact<std::string>();
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

}  // namespace

std::variant<bool, std::vector<std::string>> ConfigTable::boolean_or_texts(const Key& key, bool fallback,
                                                                           const char* texts) const {
  const std::string allowed = fmt::format("true, false or a list of {}", texts);
  const toml::node* node = find(key, "true, false or list of texts", fallback ? "true" : "false", allowed);
  if (node == nullptr) return fallback;
  if (const auto value = node->value_exact<bool>()) return *value;
  if (auto values = texts_of(*node)) return std::move(*values);
  wrong(key, *node, allowed);
  return fallback;
}

std::vector<std::string> ConfigTable::required_texts(const Key& key, const char* texts) const {
  const std::string allowed = fmt::format("a list of {}", texts);
  const toml::node* node = find(key, "list of texts", "required", allowed);
  if (node == nullptr) return {};
  if (auto values = texts_of(*node); values && !values->empty()) return std::move(*values);
  wrong(key, *node, allowed);
  return {};
}

bool ConfigTable::is_text(const char* key) const {
  const toml::node* node = table_->get(key);
  return node != nullptr && node->is_string();
}

std::filesystem::path ConfigTable::file(const Key& key) const {
  const auto exists = [](const std::filesystem::path& path) {
    std::error_code error;
    return std::filesystem::exists(path, error);
  };
  return file_that(key, exists);
}

std::filesystem::path ConfigTable::file_that(const Key& key,
                                             const std::function<bool(const std::filesystem::path&)>& is_there) const {
  const toml::node* node = find(key, "file", "none", "a path, beside the file that names it or among the assets");
  if (node == nullptr) return {};
  const auto value = node->value_exact<std::string>();
  if (!value || value->empty()) {
    wrong(key, *node, "a path");
    return {};
  }
  const toml::source_region& source = config_->content_->source_of(*node);
  const std::filesystem::path beside = config_->content_->folder_of(source) / *value;
  const std::filesystem::path asset = config_->content_->assets / *value;
  if (is_there(beside)) return beside;
  if (is_there(asset)) return asset;
  const std::string places =
      beside == asset ? beside.string() : fmt::format("{} and {}", beside.string(), asset.string());
  const auto same_ending = [&beside](const std::filesystem::path& entry) {
    return entry.extension() == beside.extension();
  };
  std::filesystem::path near = near_file(beside, same_ending);
  if (near.empty()) near = near_file(asset, same_ending);
  if (!near.empty()) near = std::filesystem::path(*value).replace_filename(near.filename());  // as the scene writes it
  config_->complain(
      node, fmt::format("{} = '{}': no such file (looked for {}){}", key.name, *value, places, meant_file(near)));
  return {};
}

std::optional<ConfigValue> ConfigTable::value(const Key& key, const char* fallback) const {
  const toml::node* node = find(key, "any", fallback, "any value");
  if (node != nullptr) return config_->content_->value_of(*node);
  if (fallback == std::string_view("required")) complain(fmt::format("'{}' is missing: {}", key.name, key.meaning));
  return std::nullopt;
}

std::optional<ConfigTable> ConfigTable::table(const Key& key, const char* fallback) const {
  const toml::node* node = find(key, "table", fallback, "a table");
  if (node == nullptr) return std::nullopt;
  if (const toml::table* table = node->as_table()) return inner(key, *table, "", "");
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
    if (const toml::table* table = element.as_table()) {
      result.push_back(inner(key, *table, "." + name_of(*table, key.name), "[]"));
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
  if (value && is_usable(*value) && range.contains(*value)) return value;
  wrong(key, *node, allowed + word_hint(*node));
  return std::nullopt;
}

std::optional<std::variant<std::string, double>> ConfigTable::text_or_number_if_given(const Key& key, const char* texts,
                                                                                      const Range& range,
                                                                                      const char* fallback) const {
  const std::string allowed = fmt::format("{}, or {}", texts, range.text());
  const toml::node* node = find(key, "text or number", fallback, allowed);
  if (node == nullptr) return std::nullopt;
  if (const auto text = node->value_exact<std::string>(); text && !text->empty()) return *text;
  const std::optional<double> value = node->is_number() ? node->value<double>() : std::nullopt;
  if (value && is_usable(*value) && range.contains(*value)) return *value;
  wrong(key, *node, allowed);
  return std::nullopt;
}

}  // namespace supple
