// Presses two equal spheres together and compares force, radius of the patch and approach with Hertz's formulas
// (Johnson 1985, "Contact mechanics", sections 4.2 and 4.3).
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/bench/sections.h"
#include "app/bench/subject.h"
#include "app/bench/touching_film.h"
#include "app/bench/touching_tables.h"
#include "geometry/meshes/mesh.h"
#include "scene/building/assemble.h"

namespace supple {
namespace {

constexpr double sphere_radius = 0.1, sphere_young = 2e4, sphere_poisson = 0.4;
constexpr double pressed_seconds = 2, pressed_rate = 30, most_approach = 0.02 * sphere_radius;  // [m]
constexpr int pressed_frames = static_cast<int>(pressed_seconds * pressed_rate);

// This is the stiffness of a touching vertex, over its mass / h^2. Vertices at the pole have so little mass that with
// the default of 1e4 they would sink in by a tenth of the approach.
constexpr double pressed_stiffness = 1e5;

// Of two equal spheres: 1 / E* = 2 (1 - nu^2) / E, and 1 / R = 1 / R1 + 1 / R2.
constexpr double hertz_modulus = sphere_young / (2 * (1 - sphere_poisson * sphere_poisson));
constexpr double hertz_radius = sphere_radius / 2;

// These are equations 4.22 to 4.24 of Johnson: the radius of the patch and the approach under a force.
double hertz_patch(double force) { return std::cbrt(3 * force * hertz_radius / (4 * hertz_modulus)); }
double hertz_approach(double force) { return hertz_patch(force) * hertz_patch(force) / hertz_radius; }

// The elements at the pole where a sphere is met become smaller by (1 - b) / (1 + b), where b is this number.
constexpr double pole_shift = 0.6;

// Returns the text of one of the spheres. side: -1 for the left one, 1 for the right one, which is turned so that no
// vertex of one meets a vertex of the other, but at the poles. The far half of each is held and moved to the middle.
std::string pressed_sphere(const char* name, int side, int vertices) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nshape = \"shapes/sphere.toml\"\nscale = {:g}\nvertices = {}\n"
      "position = [{:g}, {:g}, 0]\nturn_deg = {}\ncontact = {{ friction = 0 }}\n"
      "material = {{ model = \"corotated\", young = {:g}, poisson = {:g} }}\ndensity = 1000\n"
      "[[body.handles]]\nname = \"far-half\"\nselect = {{ box = [[0, 0, 0], [0.5, 1, 1]] }}\nease = \"linear\"\n"
      "keys = [{{ t = 0 }}, {{ t = {:g}, move = [{:g}, 0, 0] }}]\n",
      name, sphere_radius, vertices, side * sphere_radius, -sphere_radius, side < 0 ? "[0, 0, 0]" : "[37, 180, 0]",
      sphere_young, sphere_poisson, pressed_seconds, -0.5 * side * most_approach);
}

// Makes the mesh of a sphere finer towards the pole where it is met, by a map of the ball onto itself that keeps the
// angles of small elements: with p from the middle of the sphere to the pole, it moves the point -b p to the middle
// (Ahlfors 1981, "Moebius transformations in several dimensions", chapter 2). Vertices of the surface are put onto
// the sphere first, which is then what contact sees and what is drawn. The half that is held is found anew. side: as of
// pressed_sphere.
void make_fine_at_pole(BodyDescription& sphere, int side) {
  Positions& rest = sphere.mesh.rest;
  const Vec3 middle(side * sphere_radius, 0, 0), moved_to_middle(side * pole_shift, 0, 0);
  for (const std::int32_t v : boundary_faces(sphere.mesh.tets).reshaped()) {
    const Vec3 from_middle = rest.row(v).transpose() - middle;
    rest.row(v) = (middle + sphere_radius * from_middle.normalized()).transpose();
  }
  sphere.overhang.clear();
  sphere.drawn_offset.resize(0, 3);
  Handle& far_half = sphere.handles.front();
  far_half.vertices.clear();
  const double square = moved_to_middle.squaredNorm();
  for (std::int32_t v = 0; v < rest.rows(); ++v) {
    const Vec3 x = (rest.row(v).transpose() - middle) / sphere_radius, apart = x - moved_to_middle;
    const Vec3 to = ((1 - square) * apart - apart.squaredNorm() * moved_to_middle) /
                    (1 - 2 * x.dot(moved_to_middle) + x.squaredNorm() * square);
    rest.row(v) = (middle + sphere_radius * to).transpose();
    if (side * to.x() > 0) far_half.vertices.push_back(v);
  }
}

// Holds what is seen of the spheres after a frame.
struct Pressed {
  double approach = 0;  // of the held halves, since the surfaces met [m]
  double force = 0;     // [N]
  double patch = 0;     // radius of the patch by its pressure [m]
  int points = 0;       // that carry the force
};

// Finds the force and the radius of the patch. The radius follows from how far the patch's points lie from their
// middle, weighted by force: Hertz's pressure p0 sqrt(1 - r^2/a^2) has the mean square radius 2/5 a^2.
Pressed seen_of_patch(TouchingFilm& film) {
  Pressed seen;
  double carried = 0;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  double second = 0;
  for (std::size_t b = 0; b < film.world().size(); ++b) {
    const Positions& x = film.world().body(b).state().x;
    for (const Contact& contact : film.world().body(b).workspace().current.contacts) {
      const double above = gap(contact, x);
      // Both spheres list a contact. The one whose triangle is touched has weights below zero, and is left out.
      if (contact.stencil.weight[0] < 0 || above >= 0) continue;
      const double force = -2 * contact.stiffness * above;
      const Eigen::Vector2d place = x.row(contact.stencil.vertex[0]).tail<2>().transpose();
      carried += force;
      first += force * place;
      second += force * place.squaredNorm();
      ++seen.points;
    }
  }
  for (const BodyTouch& touch : film.world().touches()) seen.force += std::abs(touch.force.x());
  if (carried > 0) seen.patch = std::sqrt(2.5 * std::max(0.0, second / carried - (first / carried).squaredNorm()));
  return seen;
}

std::vector<Pressed> pressed_spheres(int vertices, Threads& threads, int& counted) {
  const SceneDef scene =
      scene_of_text(fmt::format("frames = {}\nfps = {:g}\ngravity = [0, 0, 0]\n[solver.contact]\nstiffness = {:g}\n",
                                pressed_frames, pressed_rate, pressed_stiffness) +
                        pressed_sphere("left", -1, vertices) + pressed_sphere("right", 1, vertices),
                    "two spheres");
  std::vector<Body> bodies = assemble(scene);
  make_fine_at_pole(bodies[0].description, -1);
  make_fine_at_pole(bodies[1].description, 1);
  TouchingFilm film(scene, std::move(bodies), threads);
  counted = film.world().body(0).model().vertices;
  // Spheres of triangles meet a little later than true ones.
  const double gap_at_start = film.places(1).col(0).minCoeff() - film.places(0).col(0).maxCoeff();
  std::vector<Pressed> list;
  while (film.frames() < pressed_frames && film.play()) {
    list.push_back(seen_of_patch(film));
    list.back().approach = most_approach * film.time() / pressed_seconds - gap_at_start;
  }
  return list;
}

// Fits approach = c F^(2/3) + d F to the later two thirds of the frames by least squares, and returns c over Hertz's.
// The first term is what the patch itself gives way; the second is what the rest of a sphere does, which Hertz's half
// spaces, whose far parts do not move, do not have.
double approach_of_patch_alone(const std::vector<Pressed>& list) {
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t i = list.size() / 3; i < list.size(); ++i) {
    const Eigen::Vector2d terms(hertz_approach(list[i].force), list[i].force);
    squares += terms * terms.transpose();
    right += terms * list[i].approach;
  }
  // The two terms have very different units, so that the plain determinant tells nothing of how well they differ.
  const Eigen::Vector2d scale = squares.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::Matrix2d scaled = scale.asDiagonal() * squares * scale.asDiagonal();
  const Eigen::Vector2d scaled_right = scale.asDiagonal() * right;
  const double determinant = scaled.determinant();
  if (!(determinant > 0)) return std::nan("");
  return scale[0] * (scaled(1, 1) * scaled_right[0] - scaled(0, 1) * scaled_right[1]) / determinant;
}

}  // namespace

ReportTable hertz_table(const BenchSetting& setting) {
  ReportTable table{"touching-hertz", "Two equal spheres that are pressed together, against Hertz's formulas"};
  table.note = fmt::format(
      "Radius R = {:g} m, corotated, E = {:g} Pa, Poisson's ratio {:g}, without friction. The far halves are held and "
      "approach each other by {:g} % of the radius within {:g} s. The meshes are finer towards the pole that is met, "
      "where elements are a quarter as large, and contact is ten times as stiff as by default. With E* = E / (2 (1 - "
      "nu^2)) and R* = R / 2, a force F makes a patch of radius a = (3 F R* / (4 E*))^(1/3) and an approach of a^2 / "
      "R* "
      "(Johnson 1985, Contact Mechanics, equations 4.22 to 4.24). The radius is that of the measured force by place: "
      "Hertz's pressure has a "
      "mean square radius of 2/5 a^2.\n\n"
      "Hertz's spheres are half spaces as far as they deform. What is held here lies only a radius away from the "
      "patch, "
      "so the measured approach lacks what lies beyond, some 0.8 a / R of it; this share grows with the force itself, "
      "and not with its power 2/3. The last column but one has the factor of F^(2/3) alone, by least squares over the "
      "later two thirds of the film.",
      sphere_radius, sphere_young, sphere_poisson, 100 * most_approach / sphere_radius, pressed_seconds);
  table.columns = {"vertices of a sphere",
                   "approach [% of R]",
                   "force [N]",
                   "points that carry it",
                   "patch, a / R",
                   "radius over Hertz's",
                   "approach over Hertz's",
                   "approach of the patch alone over Hertz's",
                   "aim: 1 within"};
  for (const int vertices : {5000, 20000}) {
    say_doing(setting, fmt::format("two spheres of {} vertices", vertices));
    int counted = 0;
    const std::vector<Pressed> list = pressed_spheres(vertices, *setting.threads, counted);
    const std::string alone = number_text(approach_of_patch_alone(list));
    for (const int third : {1, 2, 3}) {
      const auto at = static_cast<std::size_t>(third * pressed_frames / 3 - 1);
      if (at >= list.size()) continue;
      const Pressed& seen = list[at];
      table.rows.push_back({std::to_string(counted), number_text(100 * seen.approach / sphere_radius),
                            number_text(seen.force), std::to_string(seen.points),
                            number_text(seen.patch / sphere_radius), number_text(seen.patch / hertz_patch(seen.force)),
                            number_text(seen.approach / hertz_approach(seen.force)), alone, "0.1"});
    }
  }
  return table;
}

}  // namespace supple
