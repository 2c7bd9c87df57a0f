#include "scene/replay/played_session.h"

#include <fmt/format.h>

#include <charconv>
#include <map>
#include <variant>

#include "base/hash.h"
#include "scene/config/config.h"
#include "scene/config/config_value.h"

namespace supple {
namespace {

constexpr std::size_t digits = 16;        // of a hash
constexpr std::size_t numbers_a_cut = 4;  // frame, substep, and those of BudgetCuts::after

std::vector<std::uint64_t> read_hashes(const ConfigTable& session) {
  const auto texts = session.boolean_or_texts({"hashes", "", "of the states after each frame"}, false, "hashes");
  std::vector<std::uint64_t> hashes;
  if (std::holds_alternative<bool>(texts)) return hashes;
  for (const std::string& text : std::get<std::vector<std::string>>(texts)) {
    const char* end = text.data() + text.size();
    const auto [read_to, error] = std::from_chars(text.data(), end, hashes.emplace_back(), 16);
    if (text.size() == digits && error == std::errc() && read_to == end) continue;
    session.complain("hashes",
                     fmt::format("hashes: \"{}\" is no hash, which has {} digits 0 to 9 and a to f", text, digits));
    return {};
  }
  return hashes;
}

void read_cuts(const ConfigTable& table, std::vector<PlayedCut>& cuts) {
  const std::string body = table.text({"body", "", "whose steps a budget ended"}, std::nullopt);
  const std::vector<int> numbers =
      table.integers({"after", "", "frame, substep and the two numbers of iterations of each of these steps"}, -1);
  if (numbers.size() % numbers_a_cut != 0) {
    table.complain("after", fmt::format("after: {} numbers; each step has {}", numbers.size(), numbers_a_cut));
    return;
  }
  for (std::size_t i = 0; i < numbers.size(); i += numbers_a_cut)
    cuts.push_back({body, numbers[i], numbers[i + 1], {{numbers[i + 2], numbers[i + 3]}}});
}

}  // namespace

PlayedSession read_session(const ConfigTable& replay) {
  PlayedSession played;
  const auto session = replay.table({"session", "", "what a live session has noted of its frames"});
  if (!session) return played;
  played.hashes = read_hashes(*session);
  for (const ConfigTable& table : session->tables({"cuts", "", "steps of a body that a budget of time has ended"}))
    read_cuts(table, played.cuts);
  return played;
}

void put_session(Config& replay, const PlayedSession& session) {
  replay.remove("session");
  if (session.empty()) return;
  const auto value_of = [](const std::string& text) { return ConfigValue::parse(text).value(); };
  std::string hashes;
  for (const std::uint64_t hash : session.hashes) hashes += fmt::format("'{}', ", hash_text_form(hash));
  replay.put_key("session", "hashes", value_of("[" + hashes + "]"));
  std::map<std::string, std::string> by_body;
  for (const PlayedCut& cut : session.cuts)
    by_body[cut.body] += fmt::format("{}, {}, {}, {}, ", cut.frame, cut.substep, cut.cuts.after[0], cut.cuts.after[1]);
  std::string tables;
  for (const auto& [body, numbers] : by_body)
    tables += fmt::format("{{ body = {}, after = [{}] }}, ", toml_text(body), numbers);
  if (!tables.empty()) replay.put_key("session", "cuts", value_of("[" + tables + "]"));
}

}  // namespace supple
