// Warns about scenes that are legal but unwise, before a film is made of them. Not here: what a run warns of at its end
// (output/run/row_tally.h), and letters that the font lacks (film/pictures/picture_words.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/building/assemble.h"

namespace supple {

struct SceneDef;

// Computes k h^2 / (rho L^2): the square of the number of times that a wave crosses the body in one step. k is the
// stiffness of the body and its fibres; for cloth, k is tension by width, and rho is mass by area. When the number is
// far above 1, ten iterations leave a visible error.
double crossing_number(const Body& body);

// Says what a crossing number means to the solver: "soft for its time step", "firm ..." or "stiff ...".
std::string stiffness_words(double crossing);

struct Warning {
  std::optional<WarningKind> kind;  // nothing: the warning is not about one body
  Problem problem;                  // points to its place in the scene file
  bool meant = false;               // the body says that it is meant, so it is not printed
};

std::vector<Warning> warnings(const SceneDef& scene, const std::vector<Body>& bodies);

// Tells whether a body's definition says that a kind of warning is meant.
bool is_meant(const BodyDef& body, WarningKind kind);

// Returns the problems of the warnings that are to be printed: those that are not meant.
std::vector<Problem> said(std::vector<Warning> list);

// Advises solver.untangle where it is off and a body starts with elements that are inverted or flat, of a material that
// may stay folded from there (docs/stability.md); empty elsewhere.
std::string untangle_advice(const Body& body);

// Lists what the scene asks its pictures to show but is known only after the film: drawings of a finished run can show
// it, the run itself cannot.
std::vector<Problem> known_after_film(const SceneDef& scene);

}  // namespace supple
