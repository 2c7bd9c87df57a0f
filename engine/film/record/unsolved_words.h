// Tells what the warning about unsolved steps needs to know of a film.
#pragma once

#include <string>
#include <vector>

#include "output/run/row_tally.h"
#include "scene/replay/script.h"

namespace supple {

// Returns the names of the bodies that say that their unsolved steps are meant.
std::vector<std::string> bodies_meant_unsolved(const SceneDef& scene);

// Returns the words of a film that is made from the command line. The options triple the iterations of a body, in the
// scene or where the body has its own.
UnsolvedWords unsolved_words(const Script& script);

}  // namespace supple
