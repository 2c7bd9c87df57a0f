#include "sim/model/flow_step.h"

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/trace.h"
#include "sim/elements/element_flow.h"
#include "sim/model/element_view.h"

namespace supple {
namespace {

constexpr std::array<double, 9> identity = {1, 0, 0, 0, 1, 0, 0, 0, 1};

std::size_t tetrahedra_in(const Model& model) {
  std::size_t count = 0;
  for_each_element(model, [&](const ElementView& element) {
    count += element.kind == ElementKind::tetrahedron && !element.is_arm ? 1 : 0;
  });
  return count;
}

std::vector<double> identities(std::size_t count) {
  std::vector<double> list(9 * count);
  for (std::size_t i = 0; i < list.size(); ++i) list[i] = identity[i % 9];
  return list;
}

// Returns the list that holds what the elements of a chunk keep; null where they keep nothing.
const std::vector<double>* kept_by(const Model::ChunkRange& range, const Flow& flow) {
  const std::vector<double>& list = range.is_arm ? flow.viscous : flow.plastic;
  return range.kind != ElementKind::tetrahedron || list.empty() ? nullptr : &list;
}

// Returns the place of an element's first field among those of all.
std::size_t field_of(const Model::ChunkRange& range, int place) {
  return range.first_field + std::size_t(place) / block_width * Tetrahedron::fields * block_width +
         std::size_t(place) % block_width;
}

void show(const double* kept, std::size_t field, Model& model) {
  flowed_rest_shape(&model.field[field], block_width, kept, &model.present_field[field]);
  flowed_rest_shape(&model.field[field], block_width, kept, &model.present_single_field[field]);
}

// Lets the elements of a chunk flow, which are all of one material.
class ChunkFlow {
 public:
  ChunkFlow(Model& model, const Model::ChunkRange& range, State& state, double time)
      : model_(model), range_(range), state_(state), time_(time) {
    weight_ = model.creep ? (range.is_arm ? model.creep->share : 1 - model.creep->share) : 1;
  }

  // Returns the elastic energy that is lost [J].
  template <class M>
  double run(const M& material) const {
    double lost = 0;
    for (int place = 0; place < range_.blocks * block_width; ++place) {
      const std::int32_t input = model_.element_of_lane[std::size_t(range_.first_block * block_width + place)];
      if (input >= 0) lost += flow(material, place, std::size_t(input));
    }
    return lost;
  }

 private:
  Matrix3<double> elastic_gradient(int place) const {
    const std::size_t block = std::size_t(place) / block_width, lane = std::size_t(place) % block_width;
    double corners[4][3], field[Tetrahedron::fields];
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint16_t local = model_.corner[range_.first_corner + (block * 4 + k) * block_width + lane];
      const std::int32_t v = model_.chunk_vertex[std::size_t(range_.first_vertex) + local];
      for (int i = 0; i < 3; ++i) corners[k][i] = state_.x(v, i);
    }
    const std::size_t first = field_of(range_, place);
    for (std::size_t i = 0; i < Tetrahedron::fields; ++i) field[i] = model_.present_field[first + i * block_width];
    return deformation_gradient(corners, field);
  }

  // Tells whether an element may yield, without a decomposition into singular values.
  template <class M>
  bool may_yield(const M& material, const Matrix3<double>& f, double hardened) const {
    constexpr double nearly = 1 - 1e-9;  // round-off must not decide
    Matrix3<double> stress;
    (void)density_of(material, f, stress);
    double tau[6];  // xx, yy, zz, yz, xz, xy
    constexpr int row[6] = {0, 1, 2, 1, 0, 0}, column[6] = {0, 1, 2, 2, 2, 1};
    for (int n = 0; n < 6; ++n) {
      tau[n] = 0;
      for (int k = 0; k < 3; ++k) tau[n] += stress(row[n], k) * f(column[n], k);
    }
    const double mean = (tau[0] + tau[1] + tau[2]) / 3;
    double squared = 0;
    for (int n = 0; n < 3; ++n) squared += (tau[n] - mean) * (tau[n] - mean) + 2 * tau[n + 3] * tau[n + 3];
    return weight_ * std::sqrt(1.5 * squared) > nearly * (model_.plastic->yield + model_.plastic->hardening * hardened);
  }

  template <class M>
  double flow(const M& material, int place, std::size_t input) const {
    const Matrix3<double> f = elastic_gradient(place);
    Flow& flow = state_.flow;
    if (!range_.is_arm && !may_yield(material, f, flow.hardened[input])) return 0;
    const Svd3<double> parts = svd(f);
    if (!(parts.s[2] > least_flowing_stretch)) return 0;
    const LogStrains strains(parts.s);
    const double share = range_.is_arm
                             ? viscous_share(*model_.creep, time_)
                             : plastic_share(material, *model_.plastic, weight_, strains, flow.hardened[input]);
    if (!(share > 0)) return 0;
    double kept[9];
    std::vector<double>& list = range_.is_arm ? flow.viscous : flow.plastic;
    std::copy_n(&list[9 * input], 9, kept);
    add_flow(parts, strains, share, kept);
    std::copy_n(kept, 9, &list[9 * input]);
    if (!range_.is_arm) flow.hardened[input] += share * std::sqrt(2.0 / 3) * strains.length();
    const std::size_t field = field_of(range_, place);
    show(kept, field, model_);
    double flowed[3], slope[3];
    strains.stretches(share, flowed);
    const double before = density_at_stretches(material, parts.s, slope),
                 after = density_at_stretches(material, flowed, slope);
    return model_.field[field + 9 * block_width] * (before - after);
  }

  Model& model_;
  const Model::ChunkRange& range_;
  State& state_;
  double time_, weight_ = 1;
};

}  // namespace

Flow rest_flow(const Model& model) {
  Flow flow;
  const std::size_t count = model.flows() ? tetrahedra_in(model) : 0;
  if (model.plastic) {
    flow.plastic = identities(count);
    flow.hardened.assign(count, 0.0);
  }
  if (model.creep) flow.viscous = identities(count);
  return flow;
}

void show_flow(const Flow& flow, Model& model) {
  if (!model.flows()) return;
  for (const Model::ChunkRange& range : model.chunks) {
    const std::vector<double>* kept = kept_by(range, flow);
    if (kept == nullptr) continue;
    for (int place = 0; place < range.blocks * block_width; ++place) {
      const std::int32_t input = model.element_of_lane[std::size_t(range.first_block * block_width + place)];
      if (input >= 0) show(&(*kept)[9 * std::size_t(input)], field_of(range, place), model);
    }
  }
}

void show_flow(const std::vector<const Model*>& bodies, Model& joined) {
  if (joined.present_field.empty()) return;
  std::size_t at = 0;
  for (const Model* body : bodies) {
    if (body->flows()) {
      std::copy(body->present_field.begin(), body->present_field.end(),
                joined.present_field.begin() + std::ptrdiff_t(at));
      std::copy(body->present_single_field.begin(), body->present_single_field.end(),
                joined.present_single_field.begin() + std::ptrdiff_t(at));
    }
    at += body->field.size();
  }
}

void let_flow(Model& model, State& state, Threads* threads, std::vector<double>& lost) {
  if (!model.flows() || !(state.time > state.flow.until)) return;
  const Zone zone("flow", model.name);
  const double time = state.time - state.flow.until;
  const int chunks = static_cast<int>(model.chunks.size());
  lost.assign(model.chunks.size(), 0.0);
  run_chunks(threads, chunks, long(model.elements) * 20, [&](int c) {
    const Model::ChunkRange& range = model.chunks[std::size_t(c)];
    if (kept_by(range, state.flow) == nullptr) return;
    const ChunkFlow flow(model, range, state, time);
    lost[std::size_t(c)] = std::visit([&](const auto& material) { return flow.run(material); },
                                      model.materials[std::size_t(range.region)]);
  });
  for (const double part : lost) state.flow.lost += part;
  state.flow.until = state.time;
}

}  // namespace supple
