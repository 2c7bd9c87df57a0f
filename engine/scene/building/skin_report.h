// Says how well the elements of a body fill its drawn skin.
#pragma once

#include <optional>
#include <string>

#include "scene/building/drawn_body.h"
#include "scene/building/warnings.h"

namespace supple {

// Says in words how well the elements fill a drawn skin; empty where the mesh's own boundary is drawn.
std::string skin_words(const Body& body, const DrawnBody& drawn);

// Returns how many vertices a drawn skin has and how much of it lies outside all elements; empty where the mesh's own
// boundary is drawn.
std::string skin_text(const Body& body, const DrawnBody& drawn);

// Warns of a skin that reaches far beyond its elements, and says what helps.
std::optional<Warning> skin_warning(const Body& body, const DrawnBody& drawn);

}  // namespace supple
