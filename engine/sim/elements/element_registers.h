// Takes the elements of a chunk into registers, one element in each lane. Like lanes.h it is only for files that are
// compiled once for each instruction set.
#pragma once

#include "base/lanes.h"
#include "sim/elements/element_kernels.h"

namespace supple {
namespace {

// Calls visit(corners, fields, first) for the elements of each register; `first` is the index of its first lane among
// those of the chunk.
template <class Formula, class Visit>
void for_each_register(const ElementChunk& chunk, const double* x, const Visit& visit) {
  constexpr int corners = Formula::corners, fields = Formula::fields;
  for (int block = 0; block < chunk.blocks; ++block) {
    for (int lane = 0; lane < block_width; lane += lanes) {
      alignas(64) double gathered[3 * corners][lanes];
      for (int k = 0; k < corners; ++k) {
        for (int i = 0; i < lanes; ++i) {
          const int at = (block * corners + k) * block_width + lane + i;
          const double* p = x + 3 * long(chunk.vertex[chunk.corner[at]]);
          for (int c = 0; c < 3; ++c) gathered[3 * k + c][i] = p[c];
        }
      }
      Lanes place[corners][3], field[fields];
      for (int k = 0; k < corners; ++k) {
        for (int c = 0; c < 3; ++c) place[k][c] = Lanes::load_aligned(gathered[3 * k + c]);
      }
      for (int i = 0; i < fields; ++i)
        field[i] = Lanes::load_aligned(chunk.field + (block * fields + i) * block_width + lane);
      visit(place, field, std::size_t(block) * block_width + lane);
    }
  }
}

}  // namespace
}  // namespace supple
