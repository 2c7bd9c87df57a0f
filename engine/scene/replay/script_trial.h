// Tests a script on the bodies of its scene before a film is made: which of its changes are impossible, and which are
// legal but unwise.
#pragma once

#include "scene/building/assemble.h"
#include "scene/building/warnings.h"
#include "scene/replay/script.h"

namespace supple {

// Makes every change of a script once, so that an impossible one is reported before anything is written. Throws
// InputError with all that the bodies refuse.
void try_changes(const Script& script, std::vector<Body> bodies);

// Lists what is legal but unwise in a scene and its changes, as warnings.
std::vector<Warning> all_warnings(const Script& script, const std::vector<Body>& bodies);

}  // namespace supple
