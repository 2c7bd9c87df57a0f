// Finds in a run's rows what went wrong physically.
#include <fmt/core.h>

#include <algorithm>

#include "base/text.h"
#include "output/profile.h"

namespace supple {
namespace {

constexpr double much_energy = 0.2;       // of what was exchanged
constexpr double much_skin_excess = 1.5;  // as many times the stretch of the elements

void warn_of_energy(const std::vector<FrameRow>& rows, std::size_t body, std::vector<std::string>& list) {
  const FrameRow *first = nullptr, *worst = nullptr;
  for (const FrameRow& row : rows) {
    const std::optional<BalanceRow>& balance = row.bodies.at(body).balance;
    if (!balance || balance->from_nothing <= much_energy * balance->exchanged) continue;
    if (first == nullptr) first = &row;
    if (worst == nullptr || balance->from_nothing > worst->bodies[body].balance->from_nothing) worst = &row;
  }
  if (first == nullptr) return;
  const BalanceRow& most = *worst->bodies[body].balance;
  list.push_back(fmt::format(
      "body '{}' gained energy from nothing, first in frame {}: up to {:.3g} J in frame {}, {:.0f} % of what it "
      "exchanged; more solver.iterations or substeps, or a stiffer material",
      first->bodies[body].name, first->frame, most.from_nothing, worst->frame,
      100 * most.from_nothing / most.exchanged));
}

void warn_of_skin(const std::vector<FrameRow>& rows, std::size_t body, std::vector<std::string>& list) {
  const auto excess = [body](const FrameRow& row) { return row.bodies.at(body).skin_excess.value_or(0); };
  const FrameRow& worst = *std::ranges::max_element(rows, {}, excess);
  if (excess(worst) <= much_skin_excess) return;
  list.push_back(
      fmt::format("the skin of body '{}' was stretched {:.1f} times as much as its elements in frame {}; more "
                  "vertices bring the elements closer to the skin",
                  worst.bodies[body].name, excess(worst), worst.frame));
}

}  // namespace

std::vector<std::string> warnings_of(const std::vector<FrameRow>& rows) {
  std::vector<std::string> list;
  if (rows.empty()) return list;
  const FrameRow& last = rows.back();
  for (std::size_t body = 0; body < last.bodies.size(); ++body) {
    warn_of_energy(rows, body, list);
    warn_of_skin(rows, body, list);
    const BodyRow& end = last.bodies[body];
    if (end.inverted.value_or(0) > 0)
      list.push_back(fmt::format("body '{}' has {} turned inside out in its last frame", end.name,
                                 count_text(*end.inverted, "element")));
    if (end.collapsed.value_or(0) > 0)
      list.push_back(fmt::format("body '{}' has {} without volume in its last frame", end.name,
                                 count_text(*end.collapsed, "element")));
  }
  for (std::string& warning : penetration_warnings(rows)) list.push_back(std::move(warning));
  return list;
}

}  // namespace supple
