// Counts contacts and their changes.
#include <algorithm>

#include "base/hash.h"
#include "sim/contact/contact_order.h"
#include "sim/contact/find_contacts.h"

namespace supple {
namespace {

// Returns the XXH64 of all pairs of a point and what it touches.
std::uint64_t set_of(const std::vector<Contact>& contacts) {
  std::uint64_t hash = 1;
  for (const Contact& contact : contacts) {
    if (contact.depth <= 0) continue;
    // Parts are numbered below the colliders.
    const std::int32_t other = contact.other.is_collider() ? contact.other.collider : -1 - contact.other.part;
    const std::int32_t pair[] = {contact.number, other};
    hash = hash_bytes(pair, sizeof pair, hash);
  }
  return hash;
}

// Counts the pairs that touch in one list and not in the other; both lists are sorted.
int changes_between(const std::vector<Contact>& a, const std::vector<Contact>& b) {
  int changes = 0;
  std::size_t i = 0, j = 0;
  const auto skip = [](const std::vector<Contact>& list, std::size_t& at) {
    while (at < list.size() && list[at].depth <= 0) ++at;
  };
  for (;;) {
    skip(a, i);
    skip(b, j);
    if (i == a.size() && j == b.size()) return changes;
    if (j == b.size() || (i < a.size() && comes_before(a[i], b[j]))) {
      ++changes;
      ++i;
    } else if (i == a.size() || comes_before(b[j], a[i])) {
      ++changes;
      ++j;
    } else {
      ++i;
      ++j;
    }
  }
}

}  // namespace

void forget_counts(ContactWork& work) {
  work.counts = {};
  work.set_before = work.set_now = 0;
}

void count_contacts(int changes, const std::vector<Contact>& now, ContactWork& work) {
  work.counts.touching =
      static_cast<int>(std::count_if(now.begin(), now.end(), [](const Contact& k) { return k.depth > 0; }));
  const std::uint64_t set = set_of(now);
  if (work.set_now != 0) {
    work.counts.changes += changes;
    work.counts.cycles += set == work.set_before && set != work.set_now;
  }
  work.set_before = work.set_now;
  work.set_now = set;
}

void count_contacts(const std::vector<Contact>& before, const std::vector<Contact>& now, ContactWork& work) {
  count_contacts(work.set_now == 0 ? 0 : changes_between(before, now), now, work);
}

}  // namespace supple
