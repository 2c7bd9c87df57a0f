#include "sim/contact/lagged_friction.h"

#include <cmath>

#include "sim/contact/contact_order.h"

namespace supple {

void ease_friction(const std::vector<Contact>& before, std::vector<Contact>& next) {
  constexpr double much = 0.5;   // of the change before
  constexpr double seen = 1e-3;  // of the friction
  constexpr int enough = 2;
  constexpr double least = 0.1, most = 0.9;  // of a change that is eased
  auto first = before.begin();
  for (Contact& contact : next) {
    while (first != before.end() && comes_before(*first, contact)) ++first;
    auto at = first;
    while (at != before.end() && !comes_before(contact, *at) && !is_same_contact(contact, *at)) ++at;
    if (at == before.end() || comes_before(contact, *at)) {
      contact.friction_change = contact.friction;
      continue;
    }
    const double change = contact.friction - at->friction, last = at->friction_change;
    const bool swings =
        change * last < 0 && std::abs(change) > std::max(much * std::abs(last), seen * contact.friction);
    contact.friction_change = change;
    contact.friction_swings = swings ? at->friction_swings + 1 : 0;
    if (contact.friction_swings < enough) continue;
    contact.friction = at->friction + std::clamp(last / (last - change), least, most) * change;
    contact.friction_change = 0;
    contact.friction_swings = 0;
  }
}

}  // namespace supple
