// Implements ConfigValue: values of any type, how they are shown, and the interpolation between two of them; also the
// functions of ConfigTable that return such values.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "scene/config/toml_document.h"

namespace supple {
namespace {

std::optional<double> number_of(const toml::node& node) {
  return node.is_number() ? node.value<double>() : std::nullopt;
}

// Returns the channels of a colour that is written in hexadecimal digits, which ramps take for a list of numbers.
std::optional<toml::array> channels_of(const toml::node& node) {
  const std::optional<Vec3> color = node.is_string() ? hex_color(node.as_string()->get()) : std::nullopt;
  if (!color) return std::nullopt;
  return toml::array{color->x(), color->y(), color->z()};
}

bool of_one_form(const toml::node& a, const toml::node& b) {
  if (a.is_number() && b.is_number()) return true;
  if (const auto color = channels_of(a)) return of_one_form(*color, b);
  if (const auto color = channels_of(b)) return of_one_form(a, *color);
  const toml::array *first = a.as_array(), *second = b.as_array();
  if (first == nullptr || second == nullptr || first->size() != second->size()) return false;
  for (std::size_t i = 0; i < first->size(); ++i) {
    if (!of_one_form((*first)[i], (*second)[i])) return false;
  }
  return true;
}

bool only_positive(const toml::node& node) {
  if (const auto number = number_of(node)) return *number > 0;
  if (const auto color = channels_of(node)) return only_positive(*color);
  if (!node.is_array()) return false;
  for (const toml::node& element : *node.as_array()) {
    if (!only_positive(element)) return false;
  }
  return true;
}

void append_between(const toml::node& a, const toml::node& b, double s, RampRule by, bool whole, toml::array& out) {
  if (const auto color = channels_of(a)) return append_between(*color, b, s, by, whole, out);
  if (const auto color = channels_of(b)) return append_between(a, *color, s, by, whole, out);
  if (const toml::array* first = a.as_array()) {
    toml::array list;
    for (std::size_t i = 0; i < first->size(); ++i) append_between((*first)[i], (*b.as_array())[i], s, by, whole, list);
    out.push_back(std::move(list));
    return;
  }
  const double from = *number_of(a), to = *number_of(b);
  const double value = by == RampRule::ratio ? from * std::pow(to / from, s) : from + s * (to - from);
  if (whole) {
    out.push_back(static_cast<std::int64_t>(std::llround(value)));
  } else {
    out.push_back(value);
  }
}

std::shared_ptr<const toml::node> clone(const toml::node& node) {
  std::shared_ptr<const toml::node> result;
  node.visit([&](const auto& typed) { result = std::make_shared<std::remove_cvref_t<decltype(typed)>>(typed); });
  return result;
}

// Writes the whole value as people read it, with words without quotes.
std::string people_form(const toml::node& node) {
  std::string text;
  if (const toml::array* list = node.as_array()) {
    for (const toml::node& element : *list) text += (text.empty() ? "" : ", ") + people_form(element);
    return "[" + text + "]";
  }
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, value] : *table)
      text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", std::string(key.str()), people_form(value));
    return "{" + text + "}";
  }
  return node.is_string() ? node.as_string()->get() : shown(node);
}

struct FoundList {
  std::string path;
  const toml::node* node;
};

// Collects the values of a table whose keys are paths. Tables in it represent paths with dots.
void find_lists(const toml::table& table, const std::string& prefix, std::vector<FoundList>& found) {
  for (const auto& [key, node] : table) {
    const std::string path = prefix.empty() ? std::string(key.str()) : prefix + "." + std::string(key.str());
    if (const toml::table* inner = node.as_table()) {
      find_lists(*inner, path, found);
    } else {
      found.push_back({path, &node});
    }
  }
}

}  // namespace

std::string toml_text(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      quoted += fmt::format("\\u{:04x}", int(c));
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

ConfigValue Config::Content::value_of(const toml::node& node) const {
  auto content = std::make_shared<ConfigValue::Content>();
  content->node = clone(node);
  walk(node, [&](const toml::node& inner) { content->places.push_back(source_of(inner)); });
  return ConfigValue(std::move(content));
}

void Config::Content::settle(const toml::node& copy, const ConfigValue& value) {
  std::size_t next = 0;
  const std::vector<toml::source_region>& places = value.content_->places;
  walk(copy, [&](const toml::node& inner) {
    if (next < places.size()) moved[&inner] = places[next++];
  });
}

std::optional<ConfigValue> ConfigValue::parse(const std::string& text, const std::string& source) {
  try {
    const toml::table table = parsed_toml("value = " + text, source);
    auto content = std::make_shared<Content>();
    content->node = clone(*table.get("value"));
    const toml::source_region whole{{}, {}, std::make_shared<const std::string>(source)};
    if (!source.empty()) walk(*content->node, [&](const toml::node&) { content->places.push_back(whole); });
    return ConfigValue(std::move(content));
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::string ConfigValue::whole_text() const { return people_form(*content_->node); }
std::string ConfigValue::text() const { return shown(*content_->node); }
bool ConfigValue::is_list_or_number() const { return content_->node->is_number() || content_->node->is_array(); }
bool ConfigValue::joins(const ConfigValue& other) const { return of_one_form(*content_->node, *other.content_->node); }
bool ConfigValue::all_positive() const { return only_positive(*content_->node); }

ConfigValue ConfigValue::between(const ConfigValue& from, const ConfigValue& to, double s, RampRule by, bool whole) {
  if (s >= 1) return to;  // exactly
  toml::array result;
  append_between(*from.content_->node, *to.content_->node, s, by, whole, result);
  auto content = std::make_shared<Content>();
  content->node = clone(result[0]);
  content->places.assign(to.content_->places.begin(), to.content_->places.begin() + !to.content_->places.empty());
  return ConfigValue(std::move(content));
}

ConfigValue ConfigTable::all_but(const char* key) const {
  toml::table rest = *table_;
  for (const auto& [name, node] : rest) (void)has(std::string(name.str()).c_str());
  rest.erase(key);
  auto content = std::make_shared<ConfigValue::Content>();
  content->places.push_back(config_->content_->source_of(*table_));
  for (const auto& [name, node] : *table_) {
    if (name.str() == key) continue;
    walk(node, [&](const toml::node& inner) { content->places.push_back(config_->content_->source_of(inner)); });
  }
  content->node = std::make_shared<toml::table>(std::move(rest));
  return ConfigValue(std::move(content));
}

std::vector<PathList> ConfigTable::path_lists() const {
  const Config::Content& content = *config_->content_;
  for (const std::string& key : keys()) (void)has(key.c_str());
  std::vector<FoundList> found;
  find_lists(*table_, "", found);
  std::stable_sort(found.begin(), found.end(), [&](const FoundList& a, const FoundList& b) {
    const toml::source_position first = content.source_of(*a.node).begin, second = content.source_of(*b.node).begin;
    return std::tie(first.line, first.column) < std::tie(second.line, second.column);
  });
  std::vector<PathList> lists;
  for (const FoundList& one : found) {
    PathList list{one.path, {}, content.place(one.node)};
    const toml::array* values = one.node->as_array();
    if (values == nullptr || values->empty()) {
      config_->complain(one.node,
                        fmt::format("{} = {}: must be a list of values, at least one", one.path, shown(*one.node)));
      continue;
    }
    for (const toml::node& value : *values)
      list.values.push_back({content.value_of(value), people_form(value), content.place(&value)});
    lists.push_back(std::move(list));
  }
  return lists;
}

}  // namespace supple
