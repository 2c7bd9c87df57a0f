// This file is compiled once for each instruction set; SUPPLE_VARIANT names it.
#include "baselines/local_kernels.h"

#include "base/variants.h"
#include "baselines/element_corner.h"
#include "baselines/element_proximal.h"
#include "sim/elements/element_registers.h"

namespace supple {
namespace {

// Stores the derivatives of each lane, one element after the other.
void store_corner(const CornerDerivatives<Lanes>& corner, double* out) {
  alignas(64) double number[lanes];
  for (int n = 0; n < corner_numbers; ++n) {
    (n < 3 ? corner.force[n] : corner.block[n - 3]).store_aligned(number);
    for (int i = 0; i < lanes; ++i) out[i * corner_numbers + n] = number[i];
  }
}

void corners(const ElementChunk& chunk, const double* x, double* out) {
  if (chunk.kind == ElementKind::spring) {
    for_each_register<SpringElement>(chunk, x, [&](const auto& place, const auto& field, std::size_t first) {
      store_corner(spring_corner(place, field), out + first * corner_numbers);
    });
    return;
  }
  if (chunk.kind == ElementKind::triangle) {
    std::visit(
        [&](const auto& sheet) {
          for_each_register<Triangle>(chunk, x, [&](const auto& place, const auto& field, std::size_t first) {
            store_corner(triangle_corner(sheet, place, field), out + first * corner_numbers);
          });
        },
        *chunk.membrane);
    return;
  }
  std::visit(
      [&](const auto& material) {
        for_each_register<Tetrahedron>(chunk, x, [&](const auto& place, const auto& field, std::size_t first) {
          store_corner(tetrahedron_corner(material, chunk.fibre, place, field), out + first * corner_numbers);
        });
      },
      *chunk.material);
}

// Adds a gradient to the forces on the chunk's list of vertices. It is given for corners 1, 2, ...; minus its sum acts
// on corner 0.
template <int count>
void scatter(const ElementChunk& chunk, std::size_t first, const Lanes (&gradient)[count][3], double* force) {
  alignas(64) double number[count][3][lanes];
  for (int k = 0; k < count; ++k) {
    for (int c = 0; c < 3; ++c) gradient[k][c].store_aligned(number[k][c]);
  }
  const std::size_t block = first / block_width, lane = first % block_width;
  const std::uint16_t* corner = chunk.corner + block * (count + 1) * block_width + lane;
  for (int i = 0; i < lanes; ++i) {
    for (int k = 0; k < count; ++k) {
      for (int c = 0; c < 3; ++c) {
        force[3 * corner[(k + 1) * block_width + i] + c] += number[k][c][i];
        force[3 * corner[i] + c] -= number[k][c][i];
      }
    }
  }
}

// Calls step(u, gradient) for the register whose first lane is `first`, stores its multipliers, and adds the gradient
// to the forces.
template <int count, class Step>
void step_register(const ElementChunk& chunk, std::size_t first, double* multipliers, double* force, const Step& step) {
  double* stored = multipliers + first / block_width * most_multipliers * block_width + first % block_width;
  Lanes u[most_multipliers], gradient[count][3];
  for (int n = 0; n < most_multipliers; ++n) u[n] = Lanes::load_aligned(stored + n * block_width);
  step(u, gradient);
  for (int n = 0; n < most_multipliers; ++n) u[n].store_aligned(stored + n * block_width);
  scatter(chunk, first, gradient, force);
}

void proximal(const ElementChunk& chunk, double k, const double* x, bool start, double* multipliers, double* force) {
  for (int i = 0; i < 3 * chunk.vertices; ++i) force[i] = 0;
  if (chunk.kind == ElementKind::spring) {
    for_each_register<SpringElement>(chunk, x, [&](const auto& place, const auto& field, std::size_t first) {
      step_register<1>(chunk, first, multipliers, force,
                       [&](auto& u, auto& gradient) { spring_proximal(place, field, start, u, gradient); });
    });
    return;
  }
  std::visit(
      [&](const auto& material) {
        for_each_register<Tetrahedron>(chunk, x, [&](const auto& place, const auto& field, std::size_t first) {
          step_register<3>(chunk, first, multipliers, force, [&](auto& u, auto& gradient) {
            tetrahedron_proximal(material, chunk.fibre, Lanes(k), place, field, start, u, gradient);
          });
        });
      },
      *chunk.material);
}

}  // namespace

extern const LocalKernels SUPPLE_TABLE(local);
const LocalKernels SUPPLE_TABLE(local) = {corners, proximal};

}  // namespace supple
