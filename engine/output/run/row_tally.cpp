#include "output/run/row_tally.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/text.h"

namespace supple {
namespace {

constexpr double much_in_picture = 0.6;   // less of a body's surface is a cut that one sees
constexpr double much_open = 0.1;         // of an edge, between two places that a seam joins
constexpr double much_skin_excess = 1.5;  // as many times the stretch of the elements
constexpr double deep = 0.01;             // a depth that a viewer sees, over the body's size

struct Stage {
  const char* name;
  std::optional<double> (*get)(const FrameRow&);
};
constexpr Stage stage_list[] = {{"step", [](const FrameRow& r) { return std::optional<double>(r.step_ms); }},
                                {"change", [](const FrameRow& r) { return r.change_ms; }},
                                {"draw", [](const FrameRow& r) { return r.draw_ms; }},
                                {"render", [](const FrameRow& r) { return r.render_ms; }},
                                {"compress", [](const FrameRow& r) { return r.compress_ms; }}};
enum { step_stage, change_stage, draw_stage, render_stage, compress_stage };

void add_touches(const FrameRow& row, const BodyRow& body, std::vector<TouchTally>& list) {
  for (const ColliderRow& collider : body.contact->colliders) {
    auto found = std::find_if(list.begin(), list.end(), [&](const TouchTally& one) {
      return one.body == body.name && one.collider == collider.name;
    });
    if (found == list.end()) found = list.insert(list.end(), {body.name, collider.name});
    if (collider.penetration > found->deepest) {
      found->deepest = collider.penetration;
      found->deepest_frame = row.frame;
    }
    found->deep_frames += collider.penetration > deep;
    if (collider.far_side > 0 && found->far_frames++ == 0) found->first_far_frame = row.frame;
    found->far_side = std::max(found->far_side, collider.far_side);
    found->force_sum += collider.force;
    found->largest_force = std::max(found->largest_force, collider.force);
  }
}

void add_pairs(const FrameRow& row, std::vector<PairTally>& list) {
  for (const PairRow& pair : row.pairs) {
    auto found = std::ranges::find(list, pair.bodies, &PairTally::bodies);
    if (found == list.end()) found = list.insert(list.end(), {pair.bodies});
    if (pair.penetration > found->deepest) {
      found->deepest = pair.penetration;
      found->deepest_frame = row.frame;
    }
    if (!pair.expected && pair.penetration > found->unexpected) {
      found->unexpected = pair.penetration;
      found->unexpected_frame = row.frame;
    }
    found->deep_frames += !pair.expected && pair.penetration > deep;
    if (pair.coming_apart) {
      found->left = pair.penetration;
      found->left_frame = row.frame;
    }
    found->force_sum += pair.force;
    found->largest_force = std::max(found->largest_force, pair.force);
  }
}

void add_energy(const FrameRow& row, const BalanceRow& balance, BodyTally& tally) {
  if (balance.from_nothing <= much_energy * balance.exchanged()) return;
  if (tally.first_gain < 0) tally.first_gain = row.frame;
  if (tally.worst_gain >= 0 && balance.from_nothing <= tally.gained) return;
  tally.worst_gain = row.frame;
  tally.gained = balance.from_nothing;
  tally.exchanged = balance.exchanged();
}

}  // namespace

void RowTally::add_body(const FrameRow& row, std::size_t number) {
  const BodyRow& body = row.bodies[number];
  if (number >= bodies_.size()) bodies_.resize(number + 1);
  BodyTally& tally = bodies_[number];
  if (tally.frames++ == 0) tally.name = body.name;
  tally.step.push_back(body.step_ms);
  tally.trials += body.line_search;
  tally.iterations += body.iterations;
  tally.stretch = std::max(tally.stretch, body.stretch);
  tally.estimates += body.error_estimate;
  tally.motion_estimates += body.motion_estimate;
  if (body.jiggle) tally.jiggle = std::max(tally.jiggle.value_or(*body.jiggle), *body.jiggle);
  if (body.error) tally.errors.push_back(*body.error);
  if (body.motion_error) tally.motion_errors.push_back(*body.motion_error);
  tally.unsure_errors += !body.reference_converged;
  measured_ = measured_ || body.error_measured;
  if (body.contact) {
    tally.collide.push_back(body.contact->collide_ms);
    tally.contacts = std::max(tally.contacts, body.contact->contacts);
    tally.deepest = std::max(tally.deepest, body.contact->penetration);
    add_touches(row, body, touches_);
  }
  if (body.balance) add_energy(row, *body.balance, tally);
  if (body.skin_excess.value_or(0) > tally.skin_excess) {
    tally.skin_excess = *body.skin_excess;
    tally.skin_frame = row.frame;
  }
  if (body.in_picture) {
    ++tally.drawn;
    const bool out = *body.in_picture <= 0, cut = !out && *body.in_picture < much_in_picture;
    if (out && tally.out++ == 0) tally.first_out = row.frame;
    if (cut && tally.cut++ == 0) tally.first_cut = row.frame;
    if (cut) tally.least_in_picture = std::min(tally.least_in_picture, *body.in_picture);
  }
  tally.inverted = body.inverted.value_or(0);
  tally.collapsed = body.collapsed.value_or(0);
  tally.open_seam = body.open_seam.value_or(0);
  if (body.unsolved)
    unsolved_.push_back({row.frame, body.name, body.error_estimate, body.motion_estimate,
                         body.iterations > 0 ? double(body.line_search) / body.iterations : 0});
}

void RowTally::add(const FrameRow& row) {
  const bool first = frames_++ == 0;
  last_hash_ = row.state_hash;
  last_frame_ = row.frame;
  if (first) touching_ = !row.bodies.empty() && row.bodies.front().contact.has_value();
  for (std::size_t s = 0; s < std::size(stage_list); ++s) {
    const std::optional<double> value = stage_list[s].get(row);
    if (first) stages_[s].first = value;
    if (first || !value) continue;
    stages_[s].rest.push_back(*value);
    stages_[s].sum += *value;
  }
  if (row.as_in_session) {
    ++compared_;
    if (!*row.as_in_session && first_other_ < 0) first_other_ = row.frame;
  }
  for (const std::array<std::string, 2>& bodies : row.passing) passing_.push_back({bodies, row.frame});
  for (const DeepRow& pair : row.deep) deep_.push_back({pair, row.frame});
  add_pairs(row, pairs_);
  for (std::size_t body = 0; body < row.bodies.size(); ++body) add_body(row, body);
}

std::vector<StageSummary> RowTally::stages() const {
  std::vector<StageSummary> result;
  for (std::size_t s = 0; s < std::size(stage_list); ++s) {
    const StageTally& stage = stages_[s];
    if (stage.first || !stage.rest.empty())
      result.push_back({stage_list[s].name, stage.first.value_or(0), distribution_of(stage.rest)});
  }
  return result;
}

std::string RowTally::session_text() const {
  if (compared_ == 0 || first_other_ >= 0) return "";
  return fmt::format("all {} as the live session played them", compared_ == frames_
                                                                   ? count_text(frames_, "frame")
                                                                   : fmt::format("of the first {} frames", compared_));
}

FrameWork RowTally::work(double encoding) const {
  FrameWork work{0, 0, 0, encoding};
  if (frames_ == 0) return work;
  const auto mean = [this](int stage) {
    return frames_ > 1 ? stages_[stage].sum / (frames_ - 1) : stages_[stage].first.value_or(0);
  };
  work.solving = mean(step_stage) + mean(change_stage);
  work.drawing = mean(draw_stage) + mean(render_stage);
  work.compressing = mean(compress_stage);
  return work;
}

std::vector<std::string> RowTally::penetration_warnings() const {
  std::vector<std::string> list;
  for (const TouchTally& one : touches_) {
    if (one.far_frames > 0)
      list.push_back(
          fmt::format("a part of body '{}' is on the far side of collider '{}' from frame {} on (in {} of {} frames), "
                      "by up to {:.2g} m: substeps or a thicker collider keep it on one side",
                      one.body, one.collider, one.first_far_frame, one.far_frames, frames_, one.far_side));
    if (one.deepest <= deep) continue;
    list.push_back(fmt::format(
        "the surface of body '{}' was up to {:.2g} % of its size deep inside collider '{}' (at "
        "frame {}; above {:g} % in {} of {} frames): a thickness, a finer mesh of the body or "
        "substeps make that less",
        one.body, 100 * one.deepest, one.collider, one.deepest_frame, 100 * deep, one.deep_frames, frames_));
  }
  return list;
}

namespace {

bool is_one_body(const std::array<std::string, 2>& bodies) { return bodies[0] == bodies[1]; }

// Tells of two bodies that contact did not keep apart, or of one that it did not keep out of itself. missed: what their
// positions alone showed; null: nothing. Of both depths the larger one is told.
std::string pair_text(const PairTally& pair, const DeepTally* missed, int frames) {
  const bool missed_more = missed != nullptr && missed->found.share > pair.unexpected;
  if (is_one_body(pair.bodies))
    return fmt::format(
        "body '{}' was up to {:.2g} % of its size deep in itself (at frame {}; above {:g} % in {} of {} frames): "
        "substeps or more solver.iterations make that less",
        pair.bodies[0], 100 * pair.unexpected, pair.unexpected_frame, 100 * deep, pair.deep_frames, frames);
  return fmt::format(
      "bodies '{}' and '{}' were up to {:.2g} % of the smaller one's size deep in each other (at frame {}; above {:g} "
      "% in {} of {} frames): substeps or more solver.iterations make that less",
      pair.bodies[0], pair.bodies[1], 100 * (missed_more ? missed->found.share : pair.unexpected),
      missed_more ? missed->frame : pair.unexpected_frame, 100 * deep, pair.deep_frames, frames);
}

// Tells of two bodies that overlapped at the start, and that contact has not pushed out of each other.
std::string left_text(const PairTally& pair) {
  if (is_one_body(pair.bodies))
    return fmt::format(
        "body '{}' overlapped itself at the start and has not come apart: in the last frame, {}, {:.2g} % of its size "
        "is left; more frames or a larger solver.contact.push_out may part it",
        pair.bodies[0], pair.left_frame, 100 * pair.left);
  return fmt::format(
      "bodies '{}' and '{}' overlapped at the start and have not come apart: in the last frame, {}, {:.2g} % of the "
      "smaller one's size is left; more frames or a larger solver.contact.push_out may part them",
      pair.bodies[0], pair.bodies[1], pair.left_frame, 100 * pair.left);
}

// Tells of two bodies that were deep in each other although their contacts never showed such a depth, or of two cloths
// that cross each other, or of one that crosses itself, which have no depth.
std::string missed_text(const DeepTally& pair) {
  const auto& [bodies, share, place] = pair.found;
  if (share == 0 && is_one_body(bodies))
    return fmt::format(
        "cloth '{}' crosses itself from frame {} on: substeps or more solver.iterations make that less likely",
        bodies[0], pair.frame);
  if (share == 0)
    return fmt::format(
        "cloths '{}' and '{}' cross each other from frame {} on: substeps or more solver.iterations make that less "
        "likely",
        bodies[0], bodies[1], pair.frame);
  return fmt::format(
      "bodies '{}' and '{}' were {:.2g} % of the smaller one's size deep in each other in frame {}, at [{:.3g}, "
      "{:.3g}, {:.3g}], and their contacts never showed more than {:g} %: substeps or more solver.iterations make that "
      "less",
      bodies[0], bodies[1], 100 * share, pair.frame, place[0], place[1], place[2], 100 * deep);
}

}  // namespace

std::vector<std::string> RowTally::pair_warnings() const {
  std::vector<std::string> list;
  std::vector<const DeepTally*> missed;  // those that no sentence tells yet
  for (const DeepTally& pair : deep_) missed.push_back(&pair);
  for (const PairTally& pair : pairs_) {
    if (pair.left_frame >= 0 && pair.left_frame == last_frame_) list.push_back(left_text(pair));
    if (pair.deep_frames == 0) continue;
    const auto is_same = [&pair](const DeepTally* one) { return one->found.bodies == pair.bodies; };
    const auto also = std::ranges::find_if(missed, is_same);
    list.push_back(pair_text(pair, also == missed.end() ? nullptr : *also, frames_));
    if (also != missed.end()) missed.erase(also);
  }
  for (const DeepTally* pair : missed) list.push_back(missed_text(*pair));
  return list;
}

std::vector<std::string> RowTally::missing_in_pictures() const {
  constexpr const char* help = "camera.frames = \"film\" shows the whole motion, camera.follow goes along with a body";
  const bool none_seen = std::all_of(bodies_.begin(), bodies_.end(),
                                     [](const BodyTally& body) { return body.drawn > 0 && body.out == body.drawn; });
  if (none_seen && !bodies_.empty()) return {fmt::format("no picture shows a body; {}", help)};
  std::vector<std::string> list;
  for (const BodyTally& body : bodies_) {
    if (body.drawn == 0) continue;
    if (body.out == body.drawn) {
      list.push_back(fmt::format("body '{}' is in no picture; {}", body.name, help));
    } else if (body.out > 0) {
      list.push_back(fmt::format("body '{}' is out of the picture in {} of {} frames, first in frame {}; {}", body.name,
                                 body.out, body.drawn, body.first_out, help));
    } else if (body.cut > 0) {
      list.push_back(
          fmt::format("the picture's border cuts body '{}' in {} of {} frames, first in frame {}: it shows "
                      "as little as {:.0f} % of it; {}",
                      body.name, body.cut, body.drawn, body.first_cut, 100 * body.least_in_picture, help));
    }
  }
  return list;
}

std::vector<std::string> RowTally::warnings() const {
  std::vector<std::string> list;
  for (const BodyTally& body : bodies_) {
    if (body.first_gain >= 0)
      list.push_back(fmt::format(
          "body '{}' gained energy from nothing, first in frame {}: up to {:.3g} J in frame {}, {:.0f} % of what it "
          "exchanged; more solver.iterations or substeps, or a stiffer material",
          body.name, body.first_gain, body.gained, body.worst_gain, 100 * body.gained / body.exchanged));
    if (body.skin_excess > much_skin_excess)
      list.push_back(
          fmt::format("the skin of body '{}' was stretched {:.1f} times as much as its elements in frame {}; more "
                      "vertices bring the elements closer to the skin",
                      body.name, body.skin_excess, body.skin_frame));
    if (body.inverted > 0)
      list.push_back(fmt::format("body '{}' has {} turned inside out in its last frame", body.name,
                                 count_text(body.inverted, "element")));
    if (body.collapsed > 0)
      list.push_back(fmt::format("body '{}' has {} without volume in its last frame", body.name,
                                 count_text(body.collapsed, "element")));
    if (body.open_seam > much_open)
      list.push_back(
          fmt::format("a seam of body '{}' is open by {:.2g} of an edge in the last frame: something holds "
                      "its sides apart, or the cloth is too small",
                      body.name, body.open_seam));
  }
  if (first_other_ >= 0)
    list.push_back(fmt::format(
        "from frame {} on the film is not as the live session played it that wrote the replay: the same bits want the "
        "same settings and files, the same program, and the same kind of processor",
        first_other_));
  for (const PassingTally& pair : passing_)
    list.push_back(fmt::format("bodies '{}' and '{}' pass through each other from frame {} on: these two do not meet",
                               pair.bodies[0], pair.bodies[1], pair.frame));
  for (std::string& warning : pair_warnings()) list.push_back(std::move(warning));
  for (std::string& warning : penetration_warnings()) list.push_back(std::move(warning));
  for (std::string& warning : missing_in_pictures()) list.push_back(std::move(warning));
  if (std::string warning = unsolved_warning(); !warning.empty()) list.push_back(std::move(warning));
  return list;
}

// Says where measured errors are those against a reference that did not converge.
std::string RowTally::unsure_text() const {
  std::string text;
  for (const BodyTally& body : bodies_) {
    if (body.unsure_errors > 0)
      text += fmt::format("  {:<14}the reference did not converge in {}, whose errors may be larger\n", body.name,
                          count_text(body.unsure_errors, "frame"));
  }
  return text;
}

std::string RowTally::touch_table() const {
  std::string text;
  for (const TouchTally& one : touches_) {
    if (one.deepest <= 0 && one.largest_force <= 0) continue;
    if (text.empty())
      text = fmt::format("\n  {:<14}{:<14}{:>13}{:>10}{:>14}{:>14}\n", "body", "collider", "penetration", "at frame",
                         "force N, mean", "most");
    text += fmt::format("  {:<14}{:<14}{:>13.1e}{:>10}{:>14.3g}{:>14.3g}\n", one.body, one.collider, one.deepest,
                        one.deepest > 0 ? fmt::format("{}", one.deepest_frame) : "-", one.force_sum / frames_,
                        one.largest_force);
  }
  return text;
}

std::string RowTally::pair_table() const {
  std::string text;
  for (const PairTally& one : pairs_) {
    if (text.empty())
      text = fmt::format("\n  {:<14}{:<14}{:>13}{:>10}{:>14}{:>14}\n", "body", "other body", "penetration", "at frame",
                         "force N, mean", "most");
    text += fmt::format("  {:<14}{:<14}{:>13.1e}{:>10}{:>14.3g}{:>14.3g}\n", one.bodies[0],
                        is_one_body(one.bodies) ? "itself" : one.bodies[1], one.deepest,
                        one.deepest > 0 ? fmt::format("{}", one.deepest_frame) : "-", one.force_sum / frames_,
                        one.largest_force);
  }
  return text;
}

std::string RowTally::table() const {
  std::string text = fmt::format("  {:<10}{:>9}{:>9}{:>9}{:>9}{:>11}{:>10}\n", "ms/frame", "p50", "p95", "p99", "max",
                                 "first", "total s");
  for (const StageSummary& stage : stages()) {
    text += fmt::format("  {:<10}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}{:>11.2f}{:>10.1f}\n", stage.stage, stage.rest.p50,
                        stage.rest.p95, stage.rest.p99, stage.rest.max, stage.first,
                        (stage.rest.total + stage.first) / 1000);
  }
  if (frames_ == 0) return text;
  text += fmt::format("\n  {:<14}{:>9}{:>9}{:>12}{:>10}{:>10}{:>12}", "body", "step ms", "p95", "trials/it", "stretch",
                      "jiggle", "error est.");
  text += fmt::format("{:>13}", "motion est.");
  if (touching_) text += fmt::format("{:>12}{:>10}{:>13}", "collide ms", "contacts", "penetration");
  if (measured_)
    text += fmt::format("{:>11}{:>10}{:>10}{:>12}{:>10}", "error mean", "p95", "worst", "motion mean", "worst");
  text += '\n';
  for (const BodyTally& body : bodies_) {
    const Distribution step = distribution_of(body.step);
    text += fmt::format("  {:<14}{:>9.2f}{:>9.2f}{:>12.3f}{:>10.3f}{:>10}{:>12.1e}", body.name, step.p50, step.p95,
                        body.iterations > 0 ? body.trials / body.iterations : 0.0, body.stretch,
                        body.jiggle ? fmt::format("{:.3f}", *body.jiggle) : "-", body.estimates / body.frames);
    text += fmt::format("{:>13.1e}", body.motion_estimates / body.frames);
    if (touching_)
      text += fmt::format("{:>12.2f}{:>10}{:>13.1e}", distribution_of(body.collide).p50, body.contacts, body.deepest);
    if (measured_) {
      const Distribution error = distribution_of(body.errors);
      const Distribution motion = distribution_of(body.motion_errors);
      text += fmt::format("{:>11.1e}{:>10.1e}{:>10.1e}{:>12.1e}{:>10.1e}", error.mean, error.p95, error.max,
                          motion.mean, motion.max);
    }
    text += '\n';
  }
  return text + unsure_text() + touch_table() + pair_table();
}

namespace {

// Says how far a body was from its solution in its worst step, and whether that is seen. A tenth of a step's motion, or
// more, is seen where the body moves fast.
std::string distance_words(const UnsolvedStep& step) {
  constexpr double seen = 0.1;  // of a step's motion
  if (step.motion_estimate <= 0) return fmt::format("with an error of about {:.2g} in energy", step.error_estimate);
  if (step.motion_estimate < seen) return "by too little to be seen";
  const std::string share = step.motion_estimate < 1
                                ? fmt::format("about {:.2g} of a step's motion", step.motion_estimate)
                                : std::string("more than a step's motion");
  return "by " + share + ", which is seen where it moves fast";
}

// Tells whether a step is further from its solution than another of the same body.
bool is_further(const UnsolvedStep& one, const UnsolvedStep& other) {
  return std::pair(one.motion_estimate, one.error_estimate) > std::pair(other.motion_estimate, other.error_estimate);
}

// Names what brings bodies nearer to their solutions. options: by name of a body.
std::string remedy_for(const std::vector<UnsolvedStep>& steps, const std::map<std::string, std::string>& options) {
  std::vector<std::string> named;
  for (const UnsolvedStep& step : steps) {
    const auto option = options.find(step.body);
    if (option != options.end() && std::ranges::find(named, option->second) == named.end())
      named.push_back(option->second);
  }
  if (named.empty()) return "more solver.iterations bring them nearer";
  return fmt::format("{} {} them nearer", fmt::join(named, " "), named.size() == 1 ? "brings" : "bring");
}

}  // namespace

std::string RowTally::unsolved_warning() const {
  const std::vector<std::string>& meant = unsolved_words_.meant;
  int frames = 0, last = -1;
  std::vector<UnsolvedStep> worst;  // of each body
  for (const UnsolvedStep& step : unsolved_) {
    if (std::ranges::find(meant, step.body) != meant.end()) continue;
    frames += step.frame != std::exchange(last, step.frame) ? 1 : 0;
    const auto at = std::ranges::find(worst, step.body, &UnsolvedStep::body);
    if (at == worst.end()) {
      worst.push_back(step);
    } else if (is_further(step, *at)) {
      *at = step;
    }
  }
  if (worst.empty()) return "";
  std::string text = fmt::format("{} of {} frames did not come near their solution:", frames, frames_);
  for (const UnsolvedStep& step : worst)
    text += fmt::format("{} body '{}' {} (frame {})", &step == &worst.front() ? "" : ";", step.body,
                        distance_words(step), step.frame);
  return text + "; " + remedy_for(worst, unsolved_words_.options);
}

}  // namespace supple
