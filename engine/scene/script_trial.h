// A script held against the bodies of its scene before a film is made: what its changes would break, and what is legal
// and unwise.
#pragma once

#include "scene/assemble.h"
#include "scene/script.h"

namespace supple {

// Makes every change of a script once, so that what cannot be is said before anything is written. Throws InputError
// with all that the bodies refuse.
void try_changes(const Script& script, std::vector<Body> bodies);

// Lists what is legal and unwise about a scene and its changes.
std::vector<Problem> all_warnings(const Script& script, const std::vector<Body>& bodies);

}  // namespace supple
