#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "app/verbs.h"
#include "base/console.h"
#include "film/machine_findings.h"
#include "output/files/json_text.h"

namespace supple {
namespace {

void say_text(const std::vector<Finding>& list, bool ready) {
  for (const Finding& f : list) {
    std::string line = fmt::format("{:<9}{:<16}{}\n{:25}{}", f.ok ? "ok" : "missing", f.name, f.found, "", f.purpose);
    if (!f.ok && !f.package.empty()) line += fmt::format("; Debian: {}", f.package);
    if (!f.ok && !f.needed) line += "; a film can do without";
    say(stdout, line + "\n");
  }
  say(stdout, ready ? "Everything that a film needs is there.\n" : "A film needs what is missing above.\n");
}

void say_json(const std::vector<Finding>& list, bool ready) {
  nlohmann::ordered_json json = {{"ready", ready}, {"checks", nlohmann::ordered_json::array()}};
  for (const Finding& f : list) {
    json["checks"].push_back({{"name", f.name},
                              {"ok", f.ok},
                              {"needed", f.needed},
                              {"found", f.found},
                              {"purpose", f.purpose},
                              {"package", f.package}});
  }
  say(stdout, json_text(json) + "\n");
}

int report_findings(bool as_json) {
  const std::vector<Finding> list = examine_machine();
  bool ready = true;
  for (const Finding& f : list) ready &= f.ok || !f.needed;
  as_json ? say_json(list, ready) : say_text(list, ready);
  return ready ? 0 : 1;
}

}  // namespace

void add_doctor(CommandLine& line) {
  auto json = std::make_shared<bool>(false);
  Verb verb = line.verb("doctor", "What this machine has and lacks for making films.");
  verb.footer(
      "Example: supple doctor\n"
      "Exit status: 0 everything that a film needs is there; 1 something is missing.");
  verb.flag("--json", *json, "the result as one line of JSON");
  verb.runs([json] { return report_findings(*json); });
}

}  // namespace supple
