#include "sim/model/flow.h"

#include <array>
#include <cstdint>
#include <cstring>

namespace supple {
namespace {

// Holds the numbers that stand before the lists.
struct FlowHead {
  double until, lost;
  std::uint64_t plastic, hardened, viscous;
};

}  // namespace

std::string bytes_of(const Flow& flow) {
  if (flow.empty()) return {};
  const FlowHead head{flow.until, flow.lost, flow.plastic.size(), flow.hardened.size(), flow.viscous.size()};
  std::string bytes(reinterpret_cast<const char*>(&head), sizeof head);
  for (const std::vector<double>* list : {&flow.plastic, &flow.hardened, &flow.viscous})
    bytes.append(reinterpret_cast<const char*>(list->data()), sizeof(double) * list->size());
  return bytes;
}

std::optional<Flow> flow_from(std::string_view bytes) {
  if (bytes.empty()) return Flow{};
  FlowHead head;
  if (bytes.size() < sizeof head) return std::nullopt;
  std::memcpy(&head, bytes.data(), sizeof head);
  bytes.remove_prefix(sizeof head);
  Flow flow{{}, {}, {}, head.until, head.lost};
  const std::array lists = {std::pair(&flow.plastic, head.plastic), std::pair(&flow.hardened, head.hardened),
                            std::pair(&flow.viscous, head.viscous)};
  for (const auto& [list, count] : lists) {
    if (count > bytes.size() / sizeof(double)) return std::nullopt;
    list->resize(count);
    std::memcpy(list->data(), bytes.data(), sizeof(double) * count);
    bytes.remove_prefix(sizeof(double) * count);
  }
  if (!bytes.empty()) return std::nullopt;
  return flow;
}

}  // namespace supple
