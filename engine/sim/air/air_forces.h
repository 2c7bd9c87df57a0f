// Computes what the air around bodies and the gas in them adds to the objective of a step (solver/objective.h).
//
// Drag. A triangle of area A and normal n, whose mean velocity beyond the wind's is w, gets the force
//   -rho/2 c_n A |w_n| w_n - rho/2 c_t A |w_t| w_t,   w_n = n n^T w, w_t = w - w_n
// (the split into a share across the surface and one along it follows Wejchert and Haumann 1991, "Animation
// aerodynamics"), a third of it at each corner. The air is on both sides of a sheet, which meets it once, while a solid
// has a triangle on either side; each of these gets half, so that a thin plate has the same drag as a sheet. n and A
// are those at the step's start; w is that of the step itself, (x - q)/h, so that the force is minus the gradient of
//   D(x) = h rho A / 6 (c_n |w_n|^3 + c_t |w_t|^3)
// which is convex. A free triangle with mass m gets w_n' = w_n - k h |w_n'| w_n', k = rho c_n A / (2 m): backward Euler
// for drag, which neither overshoots nor gains energy, however light the sheet and strong the wind, whereas the force
// at the step's start turns the velocity around, and further each time, from k h |w_n| = 2 on. A body that is held or
// has come to its terminal speed feels the whole force, which a force that is made smaller for stability's sake would
// not give.
//
// Gas. The energy is that of gas_law.h in the volume V of a part's surface, evaluated at the same positions as the
// elements; its gradient is minus the pressure times dV/dx, a third of each triangle's area vector at each corner.
//
// Not here: the wind itself (wind_field.h).
#pragma once

#include "base/aligned.h"
#include "base/threads.h"
#include "sim/air/gas_law.h"
#include "sim/model/elastic_hessian.h"
#include "sim/model/inputs.h"

namespace supple {

// Holds what the air adds to g at x, or how that differs from what it adds at a reference.
struct AirChange {
  double value = 0;  // [J]
  double slope = 0;  // of the gradient along a direction, where the gradient was wanted [J]
};

class AirForces {
 public:
  // Begins a step from q (n x 3) at a time [s]: finds the parts that air has to do with, their triangles' normals, and
  // the wind there. Where StepInputs::air is empty there are none. Allocates only when the model's structure is not
  // that of the last call. The other functions are for this model and step.
  void begin(const Model& model, const StepInputs& inputs, const Positions& q, double time);

  bool act() const { return !parts_.empty(); }
  bool have_drag() const { return have_drag_; }
  bool have_gas() const { return have_gas_; }

  // Returns what the air adds to g at x, or its difference from that at a reference (null: none), summed triangle by
  // triangle. Adds to the gradient (null: not wanted), n_free x 3, and then also returns the slope along `direction`.
  AirChange add(const Model& model, Threads* threads, const Positions& x, const Positions* reference,
                const Positions& direction, Positions* gradient);

  // Holds what the air adds at one free vertex, for methods that move one vertex after the other.
  struct VertexShare {
    Vec3 slope;        // of g, by the vertex' position; with the gas' pressure of the last add() [N]
    double stiffness;  // a bound of the drag's second derivative [N/m]
  };
  VertexShare share_of(const Model& model, const Positions& x, std::int32_t vertex) const;

  // Returns the drag's share of g at x [J].
  double drag_energy(const Model& model, const Positions& x) const;
  // Returns the energy of all gas at x, against the rest shapes [J].
  double gas_energy(const Model& model, const Positions& x) const;
  // Returns what a step that ends at x gets from outside: the work of drag on free vertices, and that which held
  // vertices do on gas as they are moved, by the forces at the step's end and the ways of the vertices [J].
  double work(const Model& model, const Positions& x) const;

  // Adds the drag's second derivatives at x to the Hessian of g. Where it is not to be projected, those of the gas'
  // volumes are added too, which are of either sign. Left out is the rank-one share k u u^T of each fixed amount of
  // gas, which joins all vertices of a surface: gas_solve.h has it.
  void add_stiffness(const Model& model, const Positions& x, bool project, ElasticHessian& hessian) const;

  // Returns how many parts hold a fixed amount of gas.
  int fixed_amounts() const { return static_cast<int>(fixed_.size()); }
  // Returns k of a fixed amount at x [N/m^5], and writes u, the gradient of its volume, n_free x 3 [m^2].
  double rank_one_share(const Model& model, int amount, const Positions& x, Positions& u) const;

  // Adds to y = q + h v + ... the way on which drag takes the vertices where nothing holds them back [m].
  void add_free_way(const Model& model, Positions& y) const;

 private:
  struct ActivePart {
    std::size_t part;
    bool drags, has_gas;
    double across, along;  // rho c_n / 2 and rho c_t / 2, half of these for a solid [kg/m^3]
    double sign;           // of the signed volume at rest
    GasLaw law;
    double volume_slope;  // `sign` times dU/dV at the last add(); dU/dV is minus the pressure [Pa]
  };
  // Describes a triangle of a part that has drag, at the step's start.
  struct Facet {
    Vec3 normal;  // of length 1; zero where the triangle has no area
    Vec3 wind;    // [m/s]
    double area;  // [m^2]
  };

  void remember_structure(const Model& model);
  void set_facets(const Model& model, const ActivePart& part, const Wind& wind, double time);
  double evaluate_triangles(const Model& model, Threads* threads, ActivePart& part, const Positions& x,
                            const Positions* reference);
  double gather(const Model& model, Threads* threads, const ActivePart& part, const Positions& direction,
                Positions& gradient);

  // Returns the mean velocity of a triangle beyond the wind's, in a step that ends at x [m/s].
  Vec3 beyond_wind(const Model& model, Eigen::Index triangle, const Positions& x) const;
  Vec3 drag_force(const ActivePart& part, Eigen::Index triangle, const Vec3& beyond) const;    // on the triangle [N]
  double drag_value(const ActivePart& part, Eigen::Index triangle, const Vec3& beyond) const;  // share of D [J]
  // Returns where a vertex is when the gas is evaluated, in a step that ends at x [m].
  Vec3 middle(const Positions& x, std::int32_t vertex) const;
  Vec3 area_vector(const Model& model, Eigen::Index triangle, const Positions& x) const;  // in the middle [m^2]
  double volume(const Model& model, const ActivePart& part, const Positions& x) const;    // in the middle [m^3]
  const ActivePart* active_part_of(const Model& model, std::int32_t vertex) const;

  std::uint64_t structure_ = 0;
  std::vector<double> rest_volume_;            // of each part's surface, signed [m^3]
  std::vector<std::int32_t> fan_begin_, fan_;  // free vertex v has the triangles fan_[fan_begin_[v]..fan_begin_[v+1])
  std::vector<ActivePart> parts_;
  std::vector<std::size_t> fixed_;           // those of parts_ that hold a fixed amount of gas
  std::vector<Facet> facets_;                // by triangle
  std::vector<Vec3> third_of_drag_, areas_;  // by triangle: a corner's share of grad D [N]; the area vector [m^2]
  std::vector<double> partial_;              // sums by chunk
  Positions start_;                          // q, n x 3 [m]
  double h_ = 0;                             // [s]
  TimeScheme scheme_ = scheme_of(Integrator::backward_euler);
  bool have_drag_ = false, have_gas_ = false;
};

}  // namespace supple
