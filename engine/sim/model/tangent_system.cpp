#include "sim/model/tangent_system.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/trace.h"
#include "sim/model/bending.h"
#include "sim/model/element_view.h"

namespace supple {
namespace {

constexpr std::uint64_t tangent_ids = std::uint64_t(1) << 63;  // tells the ids of tangents from those of models
constexpr std::int32_t nowhere = std::numeric_limits<std::int32_t>::min();  // of two held vertices, or padding

}  // namespace

struct TangentSystem::Parts : System {
  // The ids of the structure and the model for which the numbers were made.
  std::uint64_t structure = 0, model = 0;
  TangentShares shares{};
  Positions x;

  // By chunk, lane and pair of corners: the place among the matrix' numbers, or ~ that among the couplings.
  std::vector<std::int32_t> place;
  std::vector<std::size_t> first_place, first_number;  // by chunk
  AlignedVector<double> numbers;                       // stiffness of the elements (element_kernels.h)
  StiffnessSample sample;

  CholeskyFactor::Room room;

  explicit Parts(const Model& of);
  std::int32_t place_of(const Model& of, std::int32_t a, std::int32_t b) const;
  void add_elements(const Model& of);
  void add_vertices(const Model& of);
};

TangentSystem::Parts::Parts(const Model& of) : System(of), structure(of.structure), sample(of) {
  for (const Model::ChunkRange& range : of.chunks) {
    first_place.push_back(place.size());
    first_number.push_back(numbers.size());
    const std::size_t lanes_of_chunk = std::size_t(range.blocks) * block_width;
    place.resize(place.size() + lanes_of_chunk * corner_pairs(corners_of(range.kind)), nowhere);
    numbers.resize(numbers.size() + lanes_of_chunk * scalar_numbers(range.kind));
    for_each_element(of, range, [&](const ElementView& element) {
      const int corners = corners_of(element.kind);
      std::int32_t* to = &place[first_place.back() +
                                std::size_t(element.lane - range.first_block * block_width) * corner_pairs(corners)];
      for (int a = 0; a < corners; ++a) {
        for (int b = 0; b <= a; ++b) *to++ = place_of(of, element.corner[a], element.corner[b]);
      }
    });
  }
}

std::int32_t TangentSystem::Parts::place_of(const Model& of, std::int32_t a, std::int32_t b) const {
  const auto [column, row] = std::minmax(a, b);
  if (column >= of.free) return nowhere;
  if (row >= of.free) {
    const auto before = [](const Model::Coupling& c, const std::pair<std::int32_t, std::int32_t>& wanted) {
      return std::pair(c.free, c.held) < wanted;
    };
    const auto at = std::lower_bound(couplings.begin(), couplings.end(), std::pair(column, row), before);
    return ~static_cast<std::int32_t>(at - couplings.begin());
  }
  const int* first = matrix.innerIndexPtr() + matrix.outerIndexPtr()[column];
  const int* end = matrix.innerIndexPtr() + matrix.outerIndexPtr()[column + 1];
  return static_cast<std::int32_t>(std::lower_bound(first, end, row) - matrix.innerIndexPtr());
}

// Adds the elements' stiffness. The first corner's rows and columns are minus the sums of the others'.
void TangentSystem::Parts::add_elements(const Model& of) {
  double* values = matrix.valuePtr();
  const double scale = shares.tangent * of.scheme.energy * of.scheme.theta * of.scheme.theta;
  for (std::size_t c = 0; c < of.chunks.size(); ++c) {
    const Model::ChunkRange& range = of.chunks[c];
    const int inner = corners_of(range.kind) - 1, pairs = corner_pairs(inner + 1), count = scalar_numbers(range.kind);
    const std::int32_t* to = &place[first_place[c]];
    const double* from = &numbers[first_number[c]];
    double entry[corner_pairs(most_corners)];
    for (int lane = 0; lane < range.blocks * block_width; ++lane, to += pairs, from += count) {
      double first[most_corners] = {};  // the first corner's column
      for (int a = 0, at = 0; a < inner; ++a) {
        for (int b = 0; b <= a; ++b, ++at) {
          entry[corner_pairs(a + 1) + b + 1] = from[at];
          first[a] -= from[at];
          if (b < a) first[b] -= from[at];
        }
      }
      entry[0] = 0;
      for (int a = 0; a < inner; ++a) {
        entry[corner_pairs(a + 1)] = first[a];
        entry[0] -= first[a];
      }
      for (int p = 0; p < pairs; ++p) {
        if (to[p] >= 0) {
          values[to[p]] += scale * entry[p];
        } else if (to[p] != nowhere) {
          couplings[~to[p]].value += scale * entry[p];
        }
      }
    }
  }
}

// Adds inertia, springs of handles, damping, bending and seams, which are the same in the Hessian and in A.
void TangentSystem::Parts::add_vertices(const Model& of) {
  const double inertia = shares.tangent * of.scheme.inertia / (of.time_step * of.time_step);
  const double springs = shares.tangent * of.scheme.energy * of.scheme.theta * of.scheme.theta;
  double* values = matrix.valuePtr();
  for (int v = 0; v < of.free; ++v) {
    const std::int32_t own = matrix.outerIndexPtr()[v];
    values[own] += inertia * of.mass[v];
    if (!of.handle_stiffness.empty()) values[own] += springs * of.handle_stiffness[v];
    if (!of.damping.begin.empty()) {
      for (std::int32_t k = of.damping.begin[v]; k < of.damping.begin[v + 1]; ++k) {
        if (of.damping.column[k] < v) continue;
        const std::int32_t at = place_of(of, of.damping.column[k], v);
        const double value = shares.tangent * of.damping.value[k];
        (at >= 0 ? values[at] : couplings[~at].value) += value;
      }
    }
    if (!of.bending.begin.empty()) {
      values[own] += springs * bending_diagonal(of.bending, v);
      for (std::int32_t k = of.bending.begin[v]; k < of.bending.begin[v + 1]; ++k) {
        if (of.bending.column[k] < v) continue;
        const std::int32_t at = place_of(of, of.bending.column[k], v);
        (at >= 0 ? values[at] : couplings[~at].value) += springs * of.bending.value[k];
      }
    }
    diagonal[v] = values[own];
  }
  for (const SeamPair& pair : of.seams.pairs)
    pair.for_each_entry([&](std::int32_t row, std::int32_t column, double value) {
      if (row < column || column >= of.free) return;
      const std::int32_t at = place_of(of, row, column);
      (at >= 0 ? values[at] : couplings[~at].value) += springs * value;
      if (row == column) diagonal[row] = values[at];
    });
}

TangentSystem::TangentSystem() = default;
TangentSystem::~TangentSystem() = default;
TangentSystem::TangentSystem(TangentSystem&&) noexcept = default;
TangentSystem& TangentSystem::operator=(TangentSystem&&) noexcept = default;

bool TangentSystem::make(const Model& model, const Positions& x, const TangentShares& shares, Threads* threads) {
  SUPPLE_CHECK(x.rows(), ==, model.vertices);
  if (parts_ && parts_->model == model.id && parts_->shares == shares && parts_->x == x) return true;
  const Zone zone("renew matrix");
  if (!parts_ || parts_->structure != model.structure || parts_->factor.precision() != model.factor.precision())
    parts_ = std::make_unique<Parts>(model);
  Parts& p = *parts_;
  p.model = 0;  // stays 0 until the matrix is made
  static std::atomic<std::uint64_t> made{0};
  p.id = ++made | tangent_ids;
  p.shares = shares;
  p.x = x;
  run_chunks(threads, static_cast<int>(model.chunks.size()), long(model.elements) * 40, [&](int c) {
    element_kernels().scalar_stiffness(model.chunk(c), x.data(), shares.axial, p.numbers.data() + p.first_number[c]);
  });
  double* values = p.matrix.valuePtr();
  const double* constant = model.matrix.valuePtr();
  for (Eigen::Index i = 0; i < p.matrix.nonZeros(); ++i) values[i] = shares.constant * constant[i];
  for (std::size_t i = 0; i < p.couplings.size(); ++i)
    p.couplings[i].value = shares.constant * model.couplings[i].value;
  p.add_elements(model);
  p.add_vertices(model);
  p.sample.take(model, x, shares);
  if (!p.factor.renew(p.matrix, p.room)) return false;
  p.model = model.id;
  return true;
}

double TangentSystem::departure(const Model& model, const Positions& x) const {
  SUPPLE_CHECK(parts_->model, ==, model.id);
  return parts_->sample.departure(model, x);
}

const System& TangentSystem::system() const { return *parts_; }

}  // namespace supple
