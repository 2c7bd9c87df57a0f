#include "output/profile.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace supple {
namespace {

std::vector<double> of_body(const std::vector<FrameRow>& rows, std::size_t body,
                            const std::function<std::optional<double>(const BodyRow&)>& get) {
  std::vector<double> values;
  for (const FrameRow& row : rows) {
    if (body >= row.bodies.size()) continue;
    if (const auto value = get(row.bodies[body])) values.push_back(*value);
  }
  return values;
}

}  // namespace

Distribution distribution_of(std::vector<double> values) {
  Distribution d;
  if (values.empty()) return d;
  std::sort(values.begin(), values.end());
  const auto rank = [&](double share) {
    const auto index = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
    return values[std::clamp<std::size_t>(index, 1, values.size()) - 1];
  };
  d.p50 = rank(0.50);
  d.p95 = rank(0.95);
  d.p99 = rank(0.99);
  d.max = values.back();
  for (const double value : values) d.total += value;
  d.mean = d.total / static_cast<double>(values.size());
  return d;
}

std::vector<StageSummary> summarize(const std::vector<FrameRow>& rows) {
  struct Stage {
    const char* name;
    std::optional<double> (*get)(const FrameRow&);
  };
  constexpr Stage stages[] = {{"step", [](const FrameRow& r) { return std::optional<double>(r.step_ms); }},
                              {"change", [](const FrameRow& r) { return r.change_ms; }},
                              {"draw", [](const FrameRow& r) { return r.draw_ms; }},
                              {"render", [](const FrameRow& r) { return r.render_ms; }},
                              {"compress", [](const FrameRow& r) { return r.compress_ms; }}};
  std::vector<StageSummary> result;
  for (const Stage& stage : stages) {
    std::vector<double> values;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      if (const auto value = stage.get(rows[i])) values.push_back(*value);
    }
    const std::optional<double> first = rows.empty() ? std::nullopt : stage.get(rows.front());
    if (first || !values.empty()) result.push_back({stage.name, first.value_or(0), distribution_of(std::move(values))});
  }
  return result;
}

namespace {

// Summarises what one collider did to one body.
struct TouchSummary {
  std::string body, collider;
  double deepest = 0;  // over the body's size
  int deepest_frame = 0, deep_frames = 0;
  double force_sum = 0, largest_force = 0;  // [N]
};

constexpr double deep = 0.01;  // a depth that a viewer sees, over the body's size

std::vector<TouchSummary> touch_summaries(const std::vector<FrameRow>& rows) {
  std::vector<TouchSummary> list;
  for (const FrameRow& row : rows) {
    for (const BodyRow& body : row.bodies) {
      if (!body.contact) continue;
      for (const ColliderRow& collider : body.contact->colliders) {
        auto found = std::find_if(list.begin(), list.end(), [&](const TouchSummary& one) {
          return one.body == body.name && one.collider == collider.name;
        });
        if (found == list.end()) found = list.insert(list.end(), {body.name, collider.name});
        if (collider.penetration > found->deepest) {
          found->deepest = collider.penetration;
          found->deepest_frame = row.frame;
        }
        found->deep_frames += collider.penetration > deep;
        found->force_sum += collider.force;
        found->largest_force = std::max(found->largest_force, collider.force);
      }
    }
  }
  std::erase_if(list, [](const TouchSummary& one) { return one.deepest <= 0 && one.largest_force <= 0; });
  return list;
}

std::string touch_table(const std::vector<FrameRow>& rows) {
  const std::vector<TouchSummary> list = touch_summaries(rows);
  if (list.empty()) return "";
  std::string text = fmt::format("\n  {:<14}{:<14}{:>13}{:>10}{:>14}{:>14}\n", "body", "collider", "penetration",
                                 "at frame", "force N, mean", "most");
  for (const TouchSummary& one : list) {
    text += fmt::format("  {:<14}{:<14}{:>13.1e}{:>10}{:>14.3g}{:>14.3g}\n", one.body, one.collider, one.deepest,
                        one.deepest > 0 ? fmt::format("{}", one.deepest_frame) : "-",
                        one.force_sum / static_cast<double>(rows.size()), one.largest_force);
  }
  return text;
}

}  // namespace

std::vector<std::string> penetration_warnings(const std::vector<FrameRow>& rows) {
  std::vector<std::string> list;
  for (const TouchSummary& one : touch_summaries(rows)) {
    if (one.deepest <= deep) continue;
    list.push_back(fmt::format(
        "the surface of body '{}' was up to {:.2g} % of its size deep inside collider '{}' (at "
        "frame {}; above {:g} % in {} of {} frames): a thickness, a finer mesh of the body or "
        "substeps make that less",
        one.body, 100 * one.deepest, one.collider, one.deepest_frame, 100 * deep, one.deep_frames, rows.size()));
  }
  return list;
}

std::string profile_table(const std::vector<FrameRow>& rows) {
  std::string text = fmt::format("  {:<10}{:>9}{:>9}{:>9}{:>9}{:>11}{:>10}\n", "ms/frame", "p50", "p95", "p99", "max",
                                 "first", "total s");
  for (const StageSummary& stage : summarize(rows)) {
    text += fmt::format("  {:<10}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}{:>11.2f}{:>10.1f}\n", stage.stage, stage.rest.p50,
                        stage.rest.p95, stage.rest.p99, stage.rest.max, stage.first,
                        (stage.rest.total + stage.first) / 1000);
  }
  if (rows.empty()) return text;
  bool measured = false;
  for (const FrameRow& row : rows)
    measured |= std::any_of(row.bodies.begin(), row.bodies.end(), [](const BodyRow& b) { return b.error_measured; });
  text += fmt::format("\n  {:<14}{:>9}{:>9}{:>12}{:>10}{:>10}{:>12}", "body", "step ms", "p95", "trials/it", "stretch",
                      "jiggle", "error est.");
  const bool touching = rows.front().bodies.empty() ? false : rows.front().bodies.front().contact.has_value();
  if (touching) text += fmt::format("{:>12}{:>10}{:>13}", "collide ms", "contacts", "penetration");
  text += measured ? fmt::format("{:>11}{:>10}{:>10}\n", "error mean", "p95", "worst") : "\n";
  for (std::size_t b = 0; b < rows.front().bodies.size(); ++b) {
    const Distribution step =
        distribution_of(of_body(rows, b, [](const BodyRow& r) { return std::optional(r.step_ms); }));
    double trials = 0, iterations = 0;
    for (const FrameRow& row : rows) {
      trials += row.bodies[b].line_search;
      iterations += row.bodies[b].iterations;
    }
    const Distribution stretch =
        distribution_of(of_body(rows, b, [](const BodyRow& r) { return std::optional(r.stretch); }));
    const std::vector<double> jiggles = of_body(rows, b, [](const BodyRow& r) { return r.jiggle; });
    const Distribution estimate =
        distribution_of(of_body(rows, b, [](const BodyRow& r) { return std::optional(r.error_estimate); }));
    text += fmt::format("  {:<14}{:>9.2f}{:>9.2f}{:>12.3f}{:>10.3f}{:>10}{:>12.1e}", rows.front().bodies[b].name,
                        step.p50, step.p95, iterations > 0 ? trials / iterations : 0.0, stretch.max,
                        jiggles.empty() ? "-" : fmt::format("{:.3f}", distribution_of(jiggles).max), estimate.mean);
    if (touching) {
      const Distribution collide =
          distribution_of(of_body(rows, b, [](const BodyRow& r) { return std::optional(r.contact->collide_ms); }));
      const Distribution contacts = distribution_of(
          of_body(rows, b, [](const BodyRow& r) { return std::optional<double>(r.contact->contacts); }));
      const Distribution deepest =
          distribution_of(of_body(rows, b, [](const BodyRow& r) { return std::optional(r.contact->penetration); }));
      text += fmt::format("{:>12.2f}{:>10.0f}{:>13.1e}", collide.p50, contacts.max, deepest.max);
    }
    if (measured) {
      const Distribution error = distribution_of(of_body(rows, b, [](const BodyRow& r) { return r.error; }));
      text += fmt::format("{:>11.1e}{:>10.1e}{:>10.1e}", error.mean, error.p95, error.max);
    }
    text += '\n';
  }
  return text + touch_table(rows);
}

}  // namespace supple
