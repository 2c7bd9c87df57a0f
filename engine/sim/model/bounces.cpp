#include "sim/model/bounces.h"

#include <cstring>

namespace supple {
namespace {

// Holds the numbers of a bounce that stand before its shares.
struct BounceHead {
  std::int32_t collider, body;
  double normal[3], arm[3], other_arm[3];
  double approach, sunk, target, ahead;
  std::uint64_t is_leaving, shares;
};

template <class Value>
void append(std::string& bytes, const Value* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), sizeof(Value) * count);
}

// Takes values from the front of the bytes. Returns false where there are too few.
template <class Value>
bool take(std::string_view& bytes, Value* values, std::size_t count) {
  if (count > bytes.size() / sizeof(Value)) return false;
  std::memcpy(values, bytes.data(), sizeof(Value) * count);
  bytes.remove_prefix(sizeof(Value) * count);
  return true;
}

BounceHead head_of(const Bounce& bounce) {
  BounceHead head{
      bounce.collider,   bounce.body,         {}, {}, {}, bounce.approach, bounce.sunk, bounce.target, bounce.ahead,
      bounce.is_leaving, bounce.shares.size()};
  Eigen::Map<Vec3>(head.normal) = bounce.normal;
  Eigen::Map<Vec3>(head.arm) = bounce.arm;
  Eigen::Map<Vec3>(head.other_arm) = bounce.other_arm;
  return head;
}

}  // namespace

std::string bytes_of(const Bounces& bounces) {
  std::string bytes;
  if (bounces.begun.empty() && bounces.given == 0) return bytes;
  append(bytes, &bounces.given, 1);
  for (const Bounce& bounce : bounces.begun) {
    const BounceHead head = head_of(bounce);
    append(bytes, &head, 1);
    append(bytes, bounce.shares.data(), bounce.shares.size());
  }
  return bytes;
}

std::optional<Bounces> bounces_from(std::string_view bytes) {
  Bounces bounces;
  if (bytes.empty()) return bounces;
  if (!take(bytes, &bounces.given, 1)) return std::nullopt;
  while (!bytes.empty()) {
    BounceHead head;
    if (!take(bytes, &head, 1) || head.shares > bytes.size() / sizeof(double)) return std::nullopt;
    Bounce bounce{head.collider,
                  head.body,
                  Vec3(head.normal),
                  Vec3(head.arm),
                  Vec3(head.other_arm),
                  head.approach,
                  head.sunk,
                  head.is_leaving != 0,
                  head.target,
                  head.ahead,
                  std::vector<double>(head.shares)};
    if (!take(bytes, bounce.shares.data(), head.shares)) return std::nullopt;
    bounces.begun.push_back(std::move(bounce));
  }
  return bounces;
}

}  // namespace supple
