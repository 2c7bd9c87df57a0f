#include "sim/solver/unforeseen_contacts.h"

#include <algorithm>
#include <iterator>

#include "sim/contact/contact_order.h"
#include "sim/solver/place_iterate.h"

namespace supple {
namespace {

// Returns the contact of the same point with the same collider or part, or of the same edge with the same edge of a
// solid; null: there is none. Of cloth, all contacts with one number count as the same.
const Contact* find_same(const Model& model, const std::vector<Contact>& list, const Contact& contact) {
  const bool with_cloth = !contact.other.is_collider() && !model.parts[contact.other.part].solid;
  auto at = std::lower_bound(list.begin(), list.end(), contact, comes_before);
  for (; at != list.end() && !comes_before(contact, *at); ++at) {
    if (with_cloth || is_same_contact(contact, *at)) return &*at;
  }
  return nullptr;
}

}  // namespace

bool learn_contacts(const Model& model, const StepInputs& inputs, OpenWorkspace& w) {
  Iterate& at = w.current;
  const std::vector<Contact> before = at.contacts;
  const double moved = at.moved;
  find_contacts_of(model, inputs, w, at);
  at.moved = moved;  // since the contacts of before were found, which stay
  std::vector<Contact> more;
  for (const Contact& contact : at.contacts) {
    if (!contact.stencil.is_vertex() && find_same(model, before, contact) == nullptr) more.push_back(contact);
  }
  for (Contact ahead : w.trial.contacts) {
    if (gap(ahead, at.x) < 0 || find_same(model, before, ahead) != nullptr || find_same(model, more, ahead) != nullptr)
      continue;
    ahead.depth = ahead.friction = 0;
    more.insert(std::upper_bound(more.begin(), more.end(), ahead, comes_before), ahead);
  }
  at.contacts.clear();
  std::merge(before.begin(), before.end(), more.begin(), more.end(), std::back_inserter(at.contacts), comes_before);
  const double rise = add_contacts(more, at.x, nullptr, w.direction, &at.gradient).value;
  at.g += rise;
  w.report.objective.back() = at.g;
  w.report.decrease -= rise;
  return !more.empty();
}

}  // namespace supple
