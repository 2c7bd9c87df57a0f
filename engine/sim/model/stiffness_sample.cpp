#include "sim/model/stiffness_sample.h"

#include <algorithm>
#include <cmath>

#include "sim/model/element_view.h"

namespace supple {
namespace {

constexpr std::size_t sampled_chunks = 8;  // one of so many chunks is sampled

int numbers_of(const Model::ChunkRange& range) { return range.blocks * block_width * scalar_numbers(range.kind); }

}  // namespace

StiffnessSample::StiffnessSample(const Model& model) {
  std::size_t count = 0, most = 0;
  for (std::size_t c = 0; c < model.chunks.size(); c += sampled_chunks) {
    first_number_.push_back(count);
    count += numbers_of(model.chunks[c]);
    most = std::max<std::size_t>(most, numbers_of(model.chunks[c]));
  }
  numbers_.resize(count);
  now_.resize(most);
}

// total_ contains the share of A, and leaves out corner 0.
void StiffnessSample::take(const Model& model, const Positions& x, const TangentShares& shares) {
  shares_ = shares;
  total_ = 0;
  for (std::size_t c = 0; c < model.chunks.size(); c += sampled_chunks) {
    const Model::ChunkRange& range = model.chunks[c];
    double* numbers = &numbers_[first_number_[c / sampled_chunks]];
    element_kernels().scalar_stiffness(model.chunk(static_cast<int>(c)), x.data(), shares.axial, numbers);
    const int inner = corners_of(range.kind) - 1, count = scalar_numbers(range.kind);
    for_each_element(model, range, [&](const ElementView& element) {
      const SystemTerm term = model.system_term(element);
      const double* own = numbers + std::size_t(element.lane - range.first_block * block_width) * count;
      for (int a = 1, at = 0; a <= inner; ++a) {
        for (int b = 1; b <= a; ++b, ++at) {
          double product = 0;
          for (int i = 0; i < 3; ++i) product += term.row[a][i] * term.row[b][i];
          total_ += std::abs(shares.tangent * own[at] + shares.constant * term.weight * product);
        }
      }
    });
  }
}

double StiffnessSample::departure(const Model& model, const Positions& x) {
  double change = 0;
  for (std::size_t c = 0; c < model.chunks.size(); c += sampled_chunks) {
    const Model::ChunkRange& range = model.chunks[c];
    element_kernels().scalar_stiffness(model.chunk(static_cast<int>(c)), x.data(), shares_.axial, now_.data());
    const double* made = &numbers_[first_number_[c / sampled_chunks]];
    for (int i = 0; i < numbers_of(range); ++i) change += shares_.tangent * std::abs(now_[i] - made[i]);
  }
  return change / total_;
}

}  // namespace supple
