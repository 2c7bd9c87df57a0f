#include "sim/model/seams.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "sim/model/joined_model.h"

namespace supple {

void Seams::index(int vertices) {
  begin.assign(std::size_t(vertices) + 1, 0);
  const auto for_each_share = [&](const auto& visit) {
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      for (std::size_t i = 0; i < 3; ++i) {
        if (pairs[p].factor[i] != 0) visit(std::size_t(pairs[p].vertex[i]), Share{std::int32_t(p), pairs[p].factor[i]});
      }
    }
  };
  for_each_share([&](std::size_t v, const Share&) { ++begin[v + 1]; });
  for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
  shares.resize(std::size_t(begin.back()));
  std::vector<std::int32_t> next(begin.begin(), begin.end() - 1);
  for_each_share([&](std::size_t v, const Share& share) { shares[std::size_t(next[v]++)] = share; });
}

double seam_opening(double time, double seam_time) {
  if (time >= seam_time) return 0;
  const double share = std::max(0.0, time / seam_time);
  return 1 - share * share * (3 - 2 * share);
}

void open_gaps(const Model& model, const std::vector<SeamOpening>& openings, double SeamOpening::*when,
               Positions& gaps) {
  if (!openings.empty()) SUPPLE_CHECK(openings.size(), ==, model.parts.size());
  gaps.resize(std::ssize(model.seams.pairs), 3);
  for (Eigen::Index p = 0; p < gaps.rows(); ++p) {
    const SeamPair& pair = model.seams.pairs[std::size_t(p)];
    const double open = openings.empty() ? 1 : openings[model.part_number(pair.vertex[0])].*when;
    gaps.row(p) = open * pair.gap.transpose();
  }
}

SeamChange add_seams(const Model& model, const Positions& gaps, const double* place, const double* reference,
                     const Positions& direction, Positions* gradient) {
  SUPPLE_CHECK(gaps.rows(), ==, std::ssize(model.seams.pairs));
  SeamChange change;
  for (std::size_t p = 0; p < model.seams.pairs.size(); ++p) {
    const SeamPair& pair = model.seams.pairs[p];
    const Vec3 gap = gaps.row(Eigen::Index(p)), at = pair.apart(place), from_gap = at - gap;
    double squares = from_gap.squaredNorm();
    if (reference != nullptr) {  // |a|^2 - |b|^2 = (a - b) . (a + b) keeps its digits where a is near b
      const Vec3 before = pair.apart(reference);
      squares = (at - before).dot(at + before - 2 * gap);
    }
    change.value += 0.5 * pair.stiffness * squares;
    for (std::size_t i = 0; gradient != nullptr && i < 3; ++i) {
      const std::int32_t v = pair.vertex[i];
      if (v >= model.free) continue;
      // The force needs no factor, because e theta = 1 for both integrators.
      const Vec3 slope = pair.stiffness * pair.factor[i] * from_gap;
      gradient->row(v) += slope.transpose();
      change.slope += direction.row(v).dot(slope);
    }
  }
  change.value *= model.scheme.energy;
  return change;
}

double seam_energy(const Model& model, const Positions& gaps, const Positions& x) {
  double sum = 0;
  for (std::size_t p = 0; p < model.seams.pairs.size(); ++p) {
    const SeamPair& pair = model.seams.pairs[p];
    sum += 0.5 * pair.stiffness * (pair.apart(x.data()) - gaps.row(Eigen::Index(p)).transpose()).squaredNorm();
  }
  return sum;
}

double seam_work_on_held(const Model& model, const Positions& gaps, const Positions& x, const Positions& q) {
  double work = 0;
  for (std::size_t p = 0; p < model.seams.pairs.size(); ++p) {
    const SeamPair& pair = model.seams.pairs[p];
    const Vec3 slope = pair.stiffness * (pair.apart(x.data()) - gaps.row(Eigen::Index(p)).transpose());
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t v = pair.vertex[i];
      if (v >= model.free) work += pair.factor[i] * slope.dot((x.row(v) - q.row(v)).transpose());
    }
  }
  return work;
}

double widest_seam(const Model& model, const Positions& gaps, const Positions& x) {
  double widest = 0;
  for (std::size_t p = 0; p < model.seams.pairs.size(); ++p)
    widest = std::max(widest, (model.seams.pairs[p].apart(x.data()) - gaps.row(Eigen::Index(p)).transpose()).norm());
  return widest;
}

std::vector<JoinedVertices> joined_by_seams(const std::vector<SeamPair>& pairs) {
  std::vector<JoinedVertices> joined;
  for (const SeamPair& pair : pairs) {
    for (std::size_t i = 1; i < 3; ++i)
      if (pair.factor[i] != 0) joined.emplace_back(pair.vertex[0], pair.vertex[i]);
  }
  return joined;
}

std::vector<JoinedVertices> joined_by_seams(const Model& model, const Part& part) {
  std::vector<SeamPair> own;
  for (SeamPair pair : model.seams.pairs) {
    if (&model.part_of(pair.vertex[0]) != &part) continue;
    for (std::int32_t& v : pair.vertex) v = own_vertex(model, part, v);
    own.push_back(pair);
  }
  return joined_by_seams(own);
}

}  // namespace supple
