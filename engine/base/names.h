// Holds the words that spell the values of an enum in files, on the command line and in reports. Each enum has one
// table, beside its declaration, and readers, writers, help and documentation all use it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

template <class E>
struct Name {
  E value;
  std::string_view text;
};

// An enum is named by a specialisation with a member `table`, in the order of its values:
//   template <>
//   struct Names<Ease> {
//     static constexpr std::array table = {Name{Ease::smooth, "smooth"}, Name{Ease::linear, "linear"}};
//   };
template <class E>
struct Names;

template <class E>
concept Named = requires {
  Names<E>::table.size();
};

// Tells whether the table lists the values 0, 1, 2, ... in this order, so that a value is its own index.
template <Named E>
constexpr bool in_order_of_values() {
  for (std::size_t i = 0; i < Names<E>::table.size(); ++i) {
    if (static_cast<std::size_t>(Names<E>::table[i].value) != i) return false;
  }
  return true;
}

template <Named E>
constexpr std::string_view name_of(E value) {
  static_assert(in_order_of_values<E>());
  return Names<E>::table[static_cast<std::size_t>(value)].text;
}

// Returns the value with this name; nothing when there is none.
template <Named E>
constexpr std::optional<E> value_named(std::string_view text) {
  for (const Name<E>& name : Names<E>::table) {
    if (name.text == text) return name.value;
  }
  return std::nullopt;
}

template <Named E>
std::vector<std::string> all_names() {
  std::vector<std::string> texts;
  for (const Name<E>& name : Names<E>::table) texts.emplace_back(name.text);
  return texts;
}

}  // namespace supple
