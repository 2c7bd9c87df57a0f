// Judges bodies that touch each other: by what symmetry, formulas and Coulomb's law say, and by cost and error. Every
// number stands beside its aim, also where it misses it.
#include "app/bench/sections.h"
#include "app/bench/touching_tables.h"

namespace supple {

ReportSection bench_touching(const BenchSetting& setting) {
  ReportSection section{"touching", "Bodies that meet: oracles, cost, error"};
  section.text =
      "Bodies whose ways come near each other make their steps together, as one model. The first six tables compare "
      "what such bodies do with what is known: two equal cubes are each other's wall, momentum is exchanged and not "
      "made, spheres flatten as Hertz says, a block holds or slides as Coulomb says, a stack carries its weight, "
      "linked rings stay linked, and a knot stays tied. Each column of numbers with an aim is followed by it; an aim "
      "that is missed is missed. The others have what it costs, where layers of cloth cross, how deep bodies come into "
      "themselves, and what it costs those that do not to be asked.\n\n"
      "All films have the solver of a scene that says nothing of it, with ten iterations a step, and h = 1/30 s over "
      "the number of steps a frame.";
  section.tables = {head_on_table(setting),       hertz_table(setting),        soft_slope_table(setting),
                    stack_table(setting),         linked_rings_table(setting), knot_table(setting),
                    touching_cost_table(setting), layers_table(setting),       self_table(setting),
                    self_question_table(setting)};
  RowOfBodies row = row_of_bodies(setting);
  section.tables.push_back(std::move(row.table));
  section.plots.push_back(std::move(row.plot));
  return section;
}

}  // namespace supple
