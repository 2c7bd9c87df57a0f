// This file is compiled once for each instruction set; SUPPLE_VARIANT names it.
#include "sim/elements/element_kernels.h"

#include "base/variants.h"
#include "sim/elements/element_corners.h"
#include "sim/elements/element_registers.h"
#include "sim/elements/tetrahedron_scalar_stiffness.h"
#include "sim/elements/triangle_stiffness.h"

namespace supple {
namespace {

static_assert(block_width % lanes == 0);

// Returns one field of the elements of a register. at: the place of the first lane's number among the chunk's fields.
template <class V>
V load_field(const ElementChunk& chunk, int at) {
  if constexpr (is_single<V>) {
    return V::load_aligned(chunk.single_field + at);
  } else {
    return V::load_aligned(chunk.field + at);
  }
}

template <class V, bool with_force, class Formula>
double run_blocks(const Formula& formula, const ElementChunk& chunk, const double* previous, double* energy,
                  double* force, const double* local) {
  constexpr int corners = Formula::corners, fields = Formula::fields, width = V::size;
  using Values = Wide<double, width>;
  Values change{};
  for (int block = 0; block < chunk.blocks; ++block) {
    for (int lane = 0; lane < block_width; lane += width) {
      const std::uint16_t* corner = chunk.corner + block * corners * block_width + lane;
      V x[corners][3], field[fields], gradient[corners - 1][3];
      load_corners<V, corners>(local, corner, x);
      for (int i = 0; i < fields; ++i) field[i] = load_field<V>(chunk, (block * fields + i) * block_width + lane);
      const auto value = __builtin_convertvector(row_of(formula.energy(x, field, gradient)), Values);
      const long at = long(block) * block_width + lane;
      Values before{};
      if (previous != nullptr) load_row(previous + at, before);
      change += value - before;
      store_row(value, energy + at);
      if constexpr (with_force) add_forces<V, corners>(gradient, corner, force);
    }
  }
  double sum = change[0];
  for (int i = 1; i < width; ++i) sum += change[i];
  return sum;
}

// Calls run(formula) with the formula of a chunk.
template <class Run>
double dispatch(const ElementChunk& chunk, const Run& run) {
  if (chunk.kind == ElementKind::spring) return run(SpringElement{});
  if (chunk.kind == ElementKind::triangle) {
    return std::visit([&]<class M>(const M& sheet) { return run(TriangleFormula<M>(sheet)); }, *chunk.membrane);
  }
  return std::visit(
      [&]<class M>(const M& material) {
        return chunk.fibre != nullptr ? run(TetrahedronFormula<M, true>(material, chunk.fibre))
                                      : run(TetrahedronFormula<M, false>(material, nullptr));
      },
      *chunk.material);
}

template <class V>
double elements(const ElementChunk& chunk, const double* x, const double* previous, double* energy, double* force,
                double* local) {
  for (int v = 0; v < chunk.vertices; ++v) {
    const double* p = x + 3 * long(chunk.vertex[v]);
    const Quad<double> row = {p[0], p[1], p[2], 0};
    store_row(row, local + list_stride * v);
  }
  if (force != nullptr) {
    for (int i = 0; i < list_stride * chunk.vertices; ++i) force[i] = 0;
  }
  return dispatch(chunk, [&](const auto& formula) {
    return force != nullptr ? run_blocks<V, true>(formula, chunk, previous, energy, force, local)
                            : run_blocks<V, false>(formula, chunk, previous, energy, nullptr, local);
  });
}

void stiffness(const ElementChunk& chunk, const double* x, bool project, double* out) {
  dispatch(chunk, [&]<class Formula>(const Formula& formula) {
    constexpr int numbers = packed_size(3 * (Formula::corners - 1));
    for_each_register<Formula>(chunk, x, [&](const auto& place, const auto& field, std::size_t first) {
      Lanes packed[numbers];
      formula.stiffness(place, field, project, packed);
      alignas(64) double numbers_of[lanes];
      for (int n = 0; n < numbers; ++n) {
        packed[n].store_aligned(numbers_of);
        for (int i = 0; i < lanes; ++i) out[(first + i) * numbers + n] = numbers_of[i];
      }
    });
    return 0.0;
  });
}

void scalar_stiffness(const ElementChunk& chunk, const double* x, double axial, double* out) {
  dispatch(chunk, [&]<class Formula>(const Formula& formula) {
    constexpr int numbers = packed_size(Formula::corners - 1);
    for_each_register<Formula>(chunk, x, [&](const auto& place, const auto& field, std::size_t first) {
      Lanes packed[numbers];
      formula.scalar_stiffness(place, field, Lanes(axial), packed);
      alignas(64) double numbers_of[lanes];
      for (int n = 0; n < numbers; ++n) {
        packed[n].store_aligned(numbers_of);
        for (int i = 0; i < lanes; ++i) out[(first + i) * numbers + n] = numbers_of[i];
      }
    });
    return 0.0;
  });
}

void stretches(const ElementChunk& chunk, const double* x, double* largest, double* volume) {
  dispatch(chunk, [&]<class Formula>(const Formula& formula) {
    for_each_register<Formula>(chunk, x, [&](const auto& place, const auto& field, std::size_t first) {
      Lanes stretch, share;
      formula.stretch(place, field, stretch, share);
      stretch.store_unaligned(largest + first);
      share.store_unaligned(volume + first);
    });
    return 0.0;
  });
}

void rotations(double* matrices, int blocks) {
  for (double* block = matrices; block < matrices + long(blocks) * 9 * block_width; block += 9 * block_width) {
    for (int lane = 0; lane < block_width; lane += lanes) {
      Matrix3<Lanes> f;
      for (int i = 0; i < 9; ++i) f.m[i] = Lanes::load_aligned(block + i * block_width + lane);
      const Matrix3<Lanes> r = polar_rotation(f);
      for (int i = 0; i < 9; ++i) r.m[i].store_aligned(block + i * block_width + lane);
    }
  }
}

}  // namespace

extern const ElementKernels SUPPLE_TABLE(element);
const ElementKernels SUPPLE_TABLE(element) = {
    elements<Lanes>, elements<SingleLanes>, stiffness, scalar_stiffness, stretches, rotations};

}  // namespace supple
