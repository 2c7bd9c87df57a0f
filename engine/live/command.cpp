#include "live/command.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "output/files/json_text.h"
#include "scene/definition/field_def.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* source = "request";

// Reads the keys of a request one by one, and finds those that nobody has asked for.
class Keys {
 public:
  explicit Keys(const Json& json) : json_(json) {}

  double number(const char* key, double lowest, double highest) {
    const Json& value = required(key);
    const double number = value.is_number() ? value.get<double>() : std::nan("");
    if (!(number >= lowest && number <= highest)) refuse(key, fmt::format("a number, {:g} to {:g}", lowest, highest));
    return number;
  }
  int whole(const char* key, int lowest, int highest) {
    const double number = this->number(key, lowest, highest);
    if (number != std::floor(number)) refuse(key, "a whole number");
    return static_cast<int>(number);
  }
  Eigen::Vector2d pair(const char* key, double most) {
    const Json& value = required(key);
    const auto fits = [most](const Json& one) { return one.is_number() && std::abs(one.get<double>()) <= most; };
    if (!value.is_array() || value.size() != 2 || !std::ranges::all_of(value, fits))
      refuse(key, fmt::format("two numbers, each {:g} to {:g}", -most, most));
    return {value[0].get<double>(), value[1].get<double>()};
  }
  std::string text(const char* key, std::size_t longest) {
    const Json& value = required(key);
    if (!value.is_string() || value.get_ref<const std::string&>().size() > longest)
      refuse(key, fmt::format("a text of at most {} characters", longest));
    return value.get<std::string>();
  }
  bool truth(const char* key) {
    const Json& value = required(key);
    if (!value.is_boolean()) refuse(key, "true or false");
    return value.get<bool>();
  }
  bool has(const char* key) const { return json_.contains(key); }

  void finish() const {
    for (const auto& [key, value] : json_.items()) {
      if (std::ranges::find(asked_, key) == asked_.end())
        throw InputError(source, fmt::format("{}: this command has no such key", printable(key)));
    }
  }

 private:
  const Json& required(const char* key) {
    asked_.emplace_back(key);
    const auto found = json_.find(key);
    if (found == json_.end()) throw InputError(source, fmt::format("{}: is missing", key));
    return *found;
  }
  [[noreturn]] static void refuse(const char* key, const std::string& allowed) {
    throw InputError(source, fmt::format("{}: wants {}", key, allowed));
  }

  const Json& json_;
  std::vector<std::string> asked_;
};

constexpr std::size_t longest_name = 200, longest_value = 3000;

Eigen::Vector2d read_place(Keys& keys) {
  const double x = keys.number("x", -1, 2);  // a pointer may leave the picture
  return {x, keys.number("y", -1, 2)};
}

void read_show(Keys& keys, Command& command) {
  if (keys.has("field")) {
    command.field = keys.text("field", longest_name);
    if (!value_named<FieldQuantity>(*command.field))
      throw InputError(source, "field: wants " + word_list(all_names<FieldQuantity>()));
  }
  if (keys.has("wireframe")) command.wireframe = keys.truth("wireframe");
  if (keys.has("marks")) command.marks = keys.truth("marks");
}

void read_keys(Keys& keys, Command& command) {
  switch (command.kind) {
    case CommandKind::set:
      command.path = keys.text("path", longest_name);
      command.value = keys.text("value", longest_value);
      if (keys.has("over")) command.over = keys.number("over", 0, 3600);
      return;
    case CommandKind::speed: command.factor = keys.number("factor", 0.05, 4); return;
    case CommandKind::go: command.frame = keys.whole("frame", 0, 1000000); return;
    case CommandKind::grab:
    case CommandKind::drag: command.at = read_place(keys); return;
    case CommandKind::drop:
      if (keys.has("pin")) command.on = keys.truth("pin");
      return;
    case CommandKind::release:
      command.body = keys.text("body", longest_name);
      command.name = keys.text("name", longest_name);
      return;
    case CommandKind::orbit: command.at = keys.pair("by", 360); return;
    case CommandKind::pan: command.at = keys.pair("by", 10); return;
    case CommandKind::zoom: command.factor = keys.number("by", 0.1, 10); return;
    case CommandKind::show: read_show(keys, command); return;
    case CommandKind::keep_rate: command.on = keys.truth("on"); return;
    case CommandKind::pause:
    case CommandKind::run:
    case CommandKind::step:
    case CommandKind::restart:
    case CommandKind::home:
    case CommandKind::keep_view:
    case CommandKind::save: return;
  }
}

}  // namespace

Command read_command(std::string_view text) {
  const Json json = json_if_valid<Json>(text);
  if (!json.is_object()) throw InputError(source, "wants a JSON object");
  Keys keys(json);
  const std::string word = keys.text("do", longest_name);
  const std::optional<CommandKind> kind = value_named<CommandKind>(word);
  if (!kind) throw InputError(source, fmt::format("do: wants {}", word_list(all_names<CommandKind>())));
  Command command;
  command.kind = *kind;
  read_keys(keys, command);
  keys.finish();
  return command;
}

}  // namespace supple
