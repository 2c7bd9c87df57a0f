// Measures what docs/contact.md says of colliders that come to a body: the same impacts seen from both frames of
// reference, a paddle and a handle that turn far in a frame, for all materials. It prints markdown.
// Usage: supple_moving_collider_study
#include <fmt/format.h>

#include "scene/definition/presets.h"
#include "support/impact.h"

using namespace supple;
using test::FilmMeasures;
using test::Flies;

namespace {

struct Substance {
  std::string name;
  Material material;
  double density;
};

std::vector<Substance> substances() {
  const Lame lame = Lame::from_young(1e5, 0.4);
  std::vector<Substance> list;
  for (const Material& material :
       {Material{AsRigidAsPossible{lame.mu}}, Material{Polynomial{4 * lame.mu}}, Material{Corotated::from(lame)},
        Material{FixedCorotated::from(lame)}, Material{StVenantKirchhoff::from(lame)}, Material{NeoHookean::from(lame)},
        Material{StableNeoHookean::from(lame)}, Material{MooneyRivlin::from(lame)}, Material{Spline::preset_a(lame)},
        Material{Spline::preset_b(lame)}, Material{StrainLimiting{lame.mu, 0.9, 1.1, lame.mu, 0.7, 1.3}}})
    list.push_back({std::string(name_of(material)), material, 1000});
  for (const MaterialPreset& preset : material_presets)
    list.push_back({preset.name, preset.material(), preset.density});
  return list;
}

std::string numbers(const FilmMeasures& film) {
  if (film.failed) return "failed";
  return fmt::format("{:.4g} / {:.4g}, {:.4g} / {:.4g}, {} / {}", film.energy, film.end_energy, film.stretch,
                     film.end_stretch, film.inverted, film.end_inverted);
}

void print_impacts() {
  fmt::print(
      "Largest and last: energy in the box's frame of reference [J], stretch, inverted elements; the deepest "
      "vertex.\n\n| material | m/s | the cube flies | the box flies | energy | stretch | deepest | deepest "
      "|\n|---|---|---|---|---|---|---|---|\n");
  for (const Substance& s : substances()) {
    for (const double speed : {3.75, 7.5, 15.0, 30.0}) {
      const FilmMeasures cube = film_of_impact(s.material, s.density, speed, Flies::cube);
      const FilmMeasures box = film_of_impact(s.material, s.density, speed, Flies::box);
      fmt::print("| {} | {:g} | {} | {} | {:.3g} | {:.3g} | {:.1e} | {:.1e} |\n", s.name, speed, numbers(cube),
                 numbers(box), box.energy / cube.energy, box.stretch / cube.stretch, cube.deepest, box.deepest);
    }
  }
}

void print_turns() {
  fmt::print(
      "\n| material | paddle, one step a frame | 40 steps a frame | handle, one step a frame | 40 steps a frame "
      "|\n|---|---|---|---|---|\n");
  for (const Substance& s : substances()) {
    fmt::print("| {} | {} | {} | {} | {} |\n", s.name, numbers(test::film_of_paddle(s.material, s.density, 10)),
               numbers(test::film_of_paddle(s.material, s.density, 10, 40)),
               numbers(test::film_of_handle(s.material, s.density, 2.0944)),
               numbers(test::film_of_handle(s.material, s.density, 2.0944, 40)));
  }
}

}  // namespace

int main() {
  print_impacts();
  print_turns();
}
