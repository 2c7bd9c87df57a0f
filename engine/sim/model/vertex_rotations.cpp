#include "sim/model/vertex_rotations.h"

#include <algorithm>
#include <tuple>

#include "sim/model/element_view.h"

namespace supple {
namespace {

constexpr int entries = 9;
constexpr int blocks_a_chunk = 64;

}  // namespace

VertexRotations::VertexRotations(const Model& model) : blocks_((model.free + block_width - 1) / block_width) {
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
  begin_.assign(std::size_t(blocks_) * block_width + 1, 0);
  for (std::size_t i = 0; i < parts.size();) {
    const auto [v, neighbor] = place(parts[i]);
    Vec3 sum = Vec3::Zero();
    for (; i < parts.size() && place(parts[i]) == std::pair(v, neighbor); ++i) sum += std::get<2>(parts[i]);
    sum /= volume[v];
    neighbor_.push_back(neighbor);
    weight_.insert(weight_.end(), {sum.x(), sum.y(), sum.z()});
    begin_[v + 1] = static_cast<std::int32_t>(neighbor_.size());
  }
  for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] = std::max(begin_[v], begin_[v - 1]);
}

void VertexRotations::find(const Positions& x, Threads* threads, Rotations& rotations) const {
  rotations.resize(std::size_t(blocks_) * entries * block_width);
  const int chunks = (blocks_ + blocks_a_chunk - 1) / blocks_a_chunk;
  run_chunks(threads, chunks, long(neighbor_.size()) * 20, [&](int chunk) {
    const int first = chunk * blocks_a_chunk, end = std::min(blocks_, first + blocks_a_chunk);
    for (int block = first; block < end; ++block) {
      double* to = rotations.data() + std::size_t(block) * entries * block_width;
      for (int lane = 0; lane < block_width; ++lane) {
        const int v = block * block_width + lane;
        double f[entries] = {};
        for (std::int32_t k = begin_[v]; k < begin_[v + 1]; ++k) {
          const double* at = x.data() + 3 * std::size_t(neighbor_[k]);
          const double* g = &weight_[3 * std::size_t(k)];
          for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) f[3 * i + j] += at[i] * g[j];
          }
        }
        for (int i = 0; i < entries; ++i) to[i * block_width + lane] = f[i];
      }
    }
    element_kernels().rotations(rotations.data() + std::size_t(first) * entries * block_width, end - first);
  });
}

namespace {

template <bool back>
void turn_rows(const Rotations& rotations, const Positions& from, Positions& to) {
  for (Eigen::Index v = 0; v < from.rows(); ++v) {
    const double* r = rotations.data() + v / block_width * (entries * block_width) + v % block_width;
    const double in[3] = {from(v, 0), from(v, 1), from(v, 2)};
    for (int i = 0; i < 3; ++i) {
      double sum = 0;
      for (int j = 0; j < 3; ++j) sum += r[(back ? 3 * j + i : 3 * i + j) * block_width] * in[j];
      to(v, i) = sum;
    }
  }
}

}  // namespace

void append_inverse(Rotations& rotations, const Rotations& s) {
  for (std::size_t block = 0; block < rotations.size(); block += entries * block_width) {
    for (int lane = 0; lane < block_width; ++lane) {
      double* r = rotations.data() + block + lane;
      const double* other = s.data() + block + lane;
      double product[entries];
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          double sum = 0;
          for (int k = 0; k < 3; ++k) sum += r[(3 * i + k) * block_width] * other[(3 * j + k) * block_width];
          product[3 * i + j] = sum;
        }
      }
      for (int i = 0; i < entries; ++i) r[i * block_width] = product[i];
    }
  }
}

void turn(const Rotations& rotations, const Positions& from, Positions& to) { turn_rows<false>(rotations, from, to); }
void turn_back(const Rotations& rotations, const Positions& from, Positions& to) {
  turn_rows<true>(rotations, from, to);
}

}  // namespace supple
