// Cuts the free vertices into chunks of fixed size, so that sums over them do not depend on the number of threads.
#pragma once

#include "sim/model/model.h"

namespace supple {

constexpr int vertices_a_chunk = 1024;

inline int vertex_chunks(const Model& model) { return (model.free + vertices_a_chunk - 1) / vertices_a_chunk; }

}  // namespace supple
