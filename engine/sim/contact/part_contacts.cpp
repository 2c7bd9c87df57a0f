#include "sim/contact/part_contacts.h"

#include <algorithm>

#include "sim/model/joined_model.h"

namespace supple {

std::vector<Contact> contacts_of_part(const Model& joined, const Part& part, const std::vector<Contact>& contacts,
                                      const Positions& x) {
  std::vector<Contact> own;
  for (Contact contact : contacts) {
    const ContactStencil all = contact.stencil;
    ContactStencil& stencil = contact.stencil;
    stencil.count = stencil.free = 0;
    Vec3 others = Vec3::Zero();
    for (int k = 0; k < all.count; ++k) {
      if (&joined.part_of(all.vertex[k]) != &part) {
        others += all.weight[k] * x.row(all.vertex[k]).transpose();
        continue;
      }
      stencil.vertex[stencil.count] = own_vertex(joined, part, all.vertex[k]);
      stencil.weight[stencil.count] = all.weight[k];
      ++stencil.count;
      stencil.free += all.vertex[k] < joined.free;
    }
    if (stencil.free == 0) continue;
    std::fill(stencil.vertex.begin() + stencil.count, stencil.vertex.end(), stencil.vertex[stencil.count - 1]);
    std::fill(stencil.weight.begin() + stencil.count, stencil.weight.end(), 0.0);
    contact.offset -= contact.normal.dot(others);
    contact.origin -= others;
    contact.number = stencil.vertex[0];
    own.push_back(contact);
  }
  return own;
}

}  // namespace supple
