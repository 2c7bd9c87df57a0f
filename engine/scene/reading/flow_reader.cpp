// Reads whether a body keeps dents, and whether it creeps.
#include <fmt/core.h>

#include "scene/reading/table_readers.h"

namespace supple {
namespace {

std::optional<Plasticity> read_plasticity(const ConfigTable& body) {
  const auto table = body.table({"plastic", "", "a solid that keeps its dents"});
  if (!table) return std::nullopt;
  Plasticity plastic;
  plastic.yield = table->number({"yield", "Pa", "strains whose stress (von Mises) is above this are kept in part"},
                                std::nullopt, Range::positive());
  plastic.hardening = table->number({"hardening", "Pa", "what a kept strain of 1 adds to the yield stress"},
                                    plastic.hardening, Range::at_least(0));
  plastic.limit =
      table->number_if_given({"limit", "", "the most strain that is kept; the default is any"}, Range::positive())
          .value_or(plastic.limit);
  return plastic;
}

std::optional<Creep> read_creep(const ConfigTable& body) {
  const auto table = body.table({"creep", "", "a solid that gives way slowly under a lasting load"});
  if (!table) return std::nullopt;
  Creep creep;
  creep.share = table->number({"share", "", "of the stiffness that gives way; the rest is elastic"}, 0.5,
                              Range::between(0.001, 0.999));
  creep.time = table->number({"time", "s", "in which the stress of that share falls to 0.37 where nothing moves"},
                             std::nullopt, Range::positive());
  return creep;
}

// Tells whether the steps of a solver know what has flowed. Other solvers keep rest shapes, or matrices of the rest
// pose or of an earlier step; A does not depend on flow (docs/method.md).
bool follows_flow(const SolverDef& solver) {
  const Method& method = solver.method;
  const bool keeps_rest = method.matrix == StartMatrix::rest_hessian ||
                          method.matrix == StartMatrix::warped_rest_hessian ||
                          method.matrix == StartMatrix::vertex_blocks || method.acceleration == Acceleration::admm ||
                          method.preconditioner == Preconditioner::rest;
  return !keeps_rest && solver.settings.matrix == StartMatrix::system;
}

bool has_fibres(const BodyDef& body) {
  bool any = body.substance.fibre.kappa > 0;
  for (const RegionDef& region : body.regions) any |= region.substance.fibre.kappa > 0;
  return any;
}

}  // namespace

void read_flow(const ConfigTable& table, BodyDef& body) {
  body.plastic = read_plasticity(table);
  body.creep = read_creep(table);
  for (const char* key : {"plastic", "creep"}) {
    if (!table.has(key)) continue;
    if (body.cloth) {
      table.complain(key, fmt::format("{}: of solids; cloth neither keeps dents nor creeps", key));
    } else if (has_fibres(body)) {
      table.complain(key, fmt::format("{}: of materials that are alike in all directions; fibres do not flow", key));
    } else if (!follows_flow(body.solver)) {
      table.complain(key, fmt::format("{}: needs solver.matrix = \"system\" and a method such as \"quasi-newton\" or "
                                      "\"newton\"; this one keeps what it knows of the rest shape",
                                      key));
    }
  }
}

}  // namespace supple
