#include "sim/model/solver_memory.h"

#include <cstring>

namespace supple {
namespace {

// Holds the numbers that stand before the positions.
struct Head {
  std::int32_t age, began_in_single;
  double turned_hessian_progress, system_progress;
};

std::size_t size_of(const Positions& rows) { return sizeof(double) * static_cast<std::size_t>(rows.size()); }

}  // namespace

std::string bytes_of(const SolverMemory& memory) {
  const Head head{memory.matrix_age, memory.began_in_single ? 1 : 0, memory.turned_hessian_progress,
                  memory.system_progress};
  std::string bytes(reinterpret_cast<const char*>(&head), sizeof head);
  bytes.append(reinterpret_cast<const char*>(memory.matrix_made_at.data()), size_of(memory.matrix_made_at));
  return bytes;
}

std::optional<SolverMemory> memory_from(std::string_view bytes, Eigen::Index vertices) {
  Head head;
  if (bytes.size() < sizeof head) return std::nullopt;
  std::memcpy(&head, bytes.data(), sizeof head);
  SolverMemory memory{Positions(0, 3), head.age, head.turned_hessian_progress, head.system_progress,
                      head.began_in_single != 0};
  bytes.remove_prefix(sizeof head);
  if (bytes.empty()) return memory;
  if (bytes.size() != 3 * sizeof(double) * static_cast<std::size_t>(vertices)) return std::nullopt;
  memory.matrix_made_at.resize(vertices, 3);
  std::memcpy(memory.matrix_made_at.data(), bytes.data(), bytes.size());
  return memory;
}

}  // namespace supple
