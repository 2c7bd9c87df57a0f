// Declares the tables of the section `touching` (touching.cpp), each of which plays its own scenes.
#pragma once

#include "app/bench/bench.h"
#include "output/pages/report_page.h"

namespace supple {

// touching_impacts.cpp
ReportTable head_on_table(const BenchSetting& setting);
ReportTable linked_rings_table(const BenchSetting& setting);
// touching_knot.cpp
ReportTable knot_table(const BenchSetting& setting);
// touching_spheres.cpp
ReportTable hertz_table(const BenchSetting& setting);
// touching_at_rest.cpp
ReportTable soft_slope_table(const BenchSetting& setting);
ReportTable stack_table(const BenchSetting& setting);
// touching_cost.cpp
ReportTable touching_cost_table(const BenchSetting& setting);
// touching_layers.cpp
ReportTable layers_table(const BenchSetting& setting);
// touching_self.cpp
ReportTable self_table(const BenchSetting& setting);
ReportTable self_question_table(const BenchSetting& setting);
// touching_row.cpp
struct RowOfBodies {
  ReportTable table;
  ReportPlot plot;
};
RowOfBodies row_of_bodies(const BenchSetting& setting);

}  // namespace supple
