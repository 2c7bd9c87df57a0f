#include "sim/model/vertex_rotations.h"

#include <algorithm>
#include <tuple>

#include "sim/model/element_view.h"

namespace supple {
namespace {

constexpr int entries = 9;
constexpr int row_numbers = 4, rotation_numbers = 3 * row_numbers;
constexpr int rotation_blocks_a_chunk = 8;

// Holds a row in a register, which the compiler splits where registers are narrower.
typedef double RowOfFour __attribute__((vector_size(row_numbers * sizeof(double))));

RowOfFour load(const double* from) {
  RowOfFour row;
  __builtin_memcpy(&row, from, sizeof row);
  return row;
}
void store(const RowOfFour& row, double* to) { __builtin_memcpy(to, &row, sizeof row); }

}  // namespace

VertexRotations::VertexRotations(const Model& model) : free_(model.free) {
  std::vector<std::tuple<std::int32_t, std::int32_t, Vec3>> parts;  // vertex, neighbour, V_e times its row of G_e^T
  std::vector<double> volume(model.free, 0.0);
  for_each_element(model, [&](const ElementView& element) {
    if (element.kind != ElementKind::tetrahedron) return;
    const SystemTerm term = unit_term(element);
    for (int a = 0; a < 4; ++a) {
      const std::int32_t v = element.corner[a];
      if (v >= model.free) continue;
      volume[v] += term.weight;
      for (int b = 0; b < 4; ++b)
        parts.emplace_back(v, element.corner[b], term.weight * Vec3(term.row[b][0], term.row[b][1], term.row[b][2]));
    }
  });
  const auto place = [](const auto& part) { return std::pair(std::get<0>(part), std::get<1>(part)); };
  std::stable_sort(parts.begin(), parts.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
  begin_.assign(std::size_t(free_) + 1, 0);
  for (std::size_t i = 0; i < parts.size();) {
    const auto [v, neighbor] = place(parts[i]);
    Vec3 sum = Vec3::Zero();
    for (; i < parts.size() && place(parts[i]) == std::pair(v, neighbor); ++i) sum += std::get<2>(parts[i]);
    sum /= volume[v];
    neighbor_.push_back(neighbor);
    weight_.insert(weight_.end(), {sum.x(), sum.y(), sum.z(), 0.0});
    begin_[v + 1] = static_cast<std::int32_t>(neighbor_.size());
  }
  for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] = std::max(begin_[v], begin_[v - 1]);
}

void VertexRotations::find(const Positions& x, Threads* threads, Rotations& rotations) const {
  rotations.resize(std::size_t(free_) * rotation_numbers);
  const int blocks = (free_ + block_width - 1) / block_width;
  run_chunks(threads, (blocks + rotation_blocks_a_chunk - 1) / rotation_blocks_a_chunk, long(neighbor_.size()) * 20,
             [&](int chunk) {
               const int first = chunk * rotation_blocks_a_chunk * block_width;
               const int end = std::min(free_, first + rotation_blocks_a_chunk * block_width);
               alignas(64) double matrices[rotation_blocks_a_chunk * entries * block_width] = {};
               const auto place = [first](int v, int i) {
                 return (v - first) / block_width * entries * block_width + i * block_width + (v - first) % block_width;
               };
               for (int v = first; v < end; ++v) {
                 RowOfFour row[3] = {};
                 for (std::int32_t k = begin_[v]; k < begin_[v + 1]; ++k) {
                   const double* at = x.data() + 3 * std::size_t(neighbor_[k]);
                   const RowOfFour g = load(&weight_[row_numbers * std::size_t(k)]);
                   for (int i = 0; i < 3; ++i) row[i] += at[i] * g;
                 }
                 for (int i = 0; i < entries; ++i) matrices[place(v, i)] = row[i / 3][i % 3];
               }
               element_kernels().rotations(matrices, (end - first + block_width - 1) / block_width);
               for (int v = first; v < end; ++v) {
                 double* to = &rotations[rotation_numbers * std::size_t(v)];
                 for (int i = 0; i < entries; ++i) to[i / 3 * row_numbers + i % 3] = matrices[place(v, i)];
               }
             });
}

void transpose(const Rotations& from, Rotations& to) {
  to.resize(from.size());
  for (std::size_t at = 0; at < from.size(); at += rotation_numbers) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) to[at + i * row_numbers + j] = from[at + j * row_numbers + i];
    }
  }
}

void multiply(const Rotations& r, const Rotations& s, Rotations& to) {
  to.resize(r.size());
  for (std::size_t at = 0; at < r.size(); at += rotation_numbers) {
    RowOfFour row[3];
    for (int i = 0; i < 3; ++i) {
      const double* factor = &r[at + i * row_numbers];
      row[i] = factor[0] * load(&s[at]) + factor[1] * load(&s[at + row_numbers]) +
               factor[2] * load(&s[at + 2 * row_numbers]);
    }
    for (int i = 0; i < 3; ++i) store(row[i], &to[at + i * row_numbers]);
  }
}

void turn_back(const Rotations& rotations, const Positions& from, Positions& to) {
  for (Eigen::Index v = 0; v < from.rows(); ++v) {
    const double* r = &rotations[rotation_numbers * std::size_t(v)];
    const double* in = from.data() + 3 * v;
    const RowOfFour sum = in[0] * load(r) + in[1] * load(r + row_numbers) + in[2] * load(r + 2 * row_numbers);
    double* out = to.data() + 3 * v;
    for (int c = 0; c < 3; ++c) out[c] = sum[c];
  }
}

}  // namespace supple
