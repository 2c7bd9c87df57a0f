// Pulls at the ends of a bar with an overhand knot in it: the bar must not come through itself.
#include "app/bench/case_text.h"
#include "app/bench/knotted_bar.h"
#include "app/bench/names.h"
#include "app/bench/sections.h"
#include "app/bench/touching_film.h"
#include "app/bench/touching_tables.h"
#include "scene/building/body.h"

namespace supple {
namespace {

constexpr double way = 0.55;  // of each end [m]

std::string knot_text(double speed, double young, int substeps, bool touches_itself) {
  return fmt::format(
      "gravity = [0, 0, 0]\nsubsteps = {}\n[[body]]\nname = \"bar\"\nshape = \"shapes/knot.toml\"\nvertices = 3000\n"
      "material = {{ model = \"stable-neo-hookean\", young = {:g}, poisson = 0.4 }}\n"
      "contact = {{ friction = 0.2, self = {} }}\n"
      "[[body.handles]]\nname = \"left\"\nselect = {{ box = [[0, 0, 0], [0.04, 1, 1]] }}\n"
      "keys = [{{ t = 0 }}, {{ t = {:g}, move = [-{:g}, 0, 0] }}]\n"
      "[[body.handles]]\nname = \"right\"\nselect = {{ box = [[0.96, 0, 0], [1, 1, 1]] }}\n"
      "keys = [{{ t = 0 }}, {{ t = {:g}, move = [{:g}, 0, 0] }}]\n",
      substeps, young, touches_itself, way / speed, way, way / speed, way);
}

// Returns what became of the knot half a second after the pull.
std::string pulled(double speed, double young, int substeps, bool touches_itself, Threads& threads) {
  TouchingFilm film(knot_text(speed, young, substeps, touches_itself), threads);
  const Body& body = film.world().bodies().front();
  const int frames = static_cast<int>(30 * way / speed) + 15;
  for (int frame = 0; frame < frames; ++frame) {
    if (!film.play()) return fmt::format("step failed in frame {}", frame);
    const int knot = knot_determinant(middle_line_of_bar(surface_of(body), body.description.mesh.rest, film.places(0)));
    if (knot != 3) return fmt::format("open in frame {}", frame);
  }
  return "knotted";
}

}  // namespace

ReportTable knot_table(const BenchSetting& setting) {
  ReportTable table{"touching-knot", "A bar with an overhand knot whose ends are pulled apart"};
  table.note =
      "A bar of 2.7 m with a radius of 2.5 cm and 3,000 vertices, stable Neo-Hookean, Poisson's ratio 0.4, 1000 "
      "kg/m^3, "
      "friction 0.2, without gravity. Each end is pulled by 0.55 m at the mean speed of the row. The knot's "
      "determinant is "
      "that of the bar's middle line in each frame: 3 for an overhand knot, 1 for a bar that has come through itself "
      "and "
      "is open. The last row is the same bar with self = false, which shows that the pull would open the knot.";
  table.columns = {"speed [m/s]", "Young's modulus [Pa]", "1 step a frame", "4 steps a frame", "aim"};
  for (const double young : {2e5, 2e6}) {
    for (const double speed : {0.15, 0.5, 1.5}) {
      say_doing(setting, fmt::format("a knot pulled at {:g} m/s, {:g} Pa", speed, young));
      table.rows.push_back({number_text(speed), number_text(young), pulled(speed, young, 1, true, *setting.threads),
                            pulled(speed, young, 4, true, *setting.threads), "knotted"});
    }
  }
  table.rows.push_back({"0.5", "2e5, self = false", pulled(0.5, 2e5, 1, false, *setting.threads),
                        pulled(0.5, 2e5, 4, false, *setting.threads), "open"});
  return table;
}

}  // namespace supple
