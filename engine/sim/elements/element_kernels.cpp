// This file is compiled once for each instruction set; SUPPLE_VARIANT names it.
#include "sim/elements/element_kernels.h"

#include "base/variants.h"
#include "sim/elements/element_registers.h"
#include "sim/elements/tetrahedron_scalar_stiffness.h"

namespace supple {
namespace {

static_assert(block_width % lanes == 0);

template <bool with_force, class Formula>
double run_blocks(const Formula& formula, const ElementChunk& chunk, const double* previous, double* energy,
                  double* force, const double* local) {
  constexpr int corners = Formula::corners, fields = Formula::fields;
  Lanes change(0.0);
  for (int block = 0; block < chunk.blocks; ++block) {
    for (int lane = 0; lane < block_width; lane += lanes) {
      const std::uint16_t* corner = chunk.corner + block * corners * block_width + lane;
      alignas(64) double gathered[3 * corners][lanes];
      for (int k = 0; k < corners; ++k) {
        for (int i = 0; i < lanes; ++i) {
          const double* p = local + 3 * corner[k * block_width + i];
          gathered[3 * k][i] = p[0];
          gathered[3 * k + 1][i] = p[1];
          gathered[3 * k + 2][i] = p[2];
        }
      }
      Lanes x[corners][3], field[fields], gradient[corners - 1][3];
      for (int k = 0; k < corners; ++k) {
        for (int c = 0; c < 3; ++c) x[k][c] = Lanes::load_aligned(gathered[3 * k + c]);
      }
      for (int i = 0; i < fields; ++i)
        field[i] = Lanes::load_aligned(chunk.field + (block * fields + i) * block_width + lane);
      const Lanes value = formula.energy(x, field, gradient);
      const long at = long(block) * block_width + lane;
      change += previous != nullptr ? value - Lanes::load_aligned(previous + at) : value;
      value.store_aligned(energy + at);
      if constexpr (with_force) {
        alignas(64) double out[3 * (corners - 1)][lanes];
        for (int k = 0; k < corners - 1; ++k) {
          for (int c = 0; c < 3; ++c) gradient[k][c].store_aligned(out[3 * k + c]);
        }
        for (int i = 0; i < lanes; ++i) {
          double* f0 = force + 3 * corner[i];
          double sum[3] = {0, 0, 0};
          for (int k = 0; k < corners - 1; ++k) {
            double* fk = force + 3 * corner[(k + 1) * block_width + i];
            for (int c = 0; c < 3; ++c) {
              const double value_c = out[3 * k + c][i];
              fk[c] += value_c;
              sum[c] += value_c;
            }
          }
          for (int c = 0; c < 3; ++c) f0[c] -= sum[c];
        }
      }
    }
  }
  return sum_in_order(change);
}

// Calls run(formula) with the formula of a chunk.
template <class Run>
double dispatch(const ElementChunk& chunk, const Run& run) {
  if (chunk.kind == ElementKind::spring) return run(SpringElement{});
  return std::visit(
      [&]<class M>(const M& material) {
        return chunk.fibre != nullptr ? run(TetrahedronFormula<M, true>(material, chunk.fibre))
                                      : run(TetrahedronFormula<M, false>(material, nullptr));
      },
      *chunk.material);
}

double elements(const ElementChunk& chunk, const double* x, const double* previous, double* energy, double* force,
                double* local) {
  for (int v = 0; v < chunk.vertices; ++v) {
    const double* p = x + 3 * long(chunk.vertex[v]);
    local[3 * v] = p[0];
    local[3 * v + 1] = p[1];
    local[3 * v + 2] = p[2];
  }
  if (force != nullptr) {
    for (int i = 0; i < 3 * chunk.vertices; ++i) force[i] = 0;
  }
  return dispatch(chunk, [&](const auto& formula) {
    return force != nullptr ? run_blocks<true>(formula, chunk, previous, energy, force, local)
                            : run_blocks<false>(formula, chunk, previous, energy, nullptr, local);
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
const ElementKernels SUPPLE_TABLE(element) = {elements, stiffness, scalar_stiffness, stretches, rotations};

}  // namespace supple
