// Computes g of docs/method.md a second time, from the files of a state's folder alone: with plain loops, Eigen's SVD,
// and the Valanis-Landel functions as the literature tabulates them. It uses no code of the program.
#pragma once

#include <Eigen/Dense>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace supple::test {

class StoredProblem {
 public:
  using Table = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

  explicit StoredProblem(const std::filesystem::path& folder);

  nlohmann::json json;
  Points q, v, y, rest;  // n x 3, in the order of the input file [m], [m/s], [m], [m]

  struct Value {
    double objective = 0;  // g(x) [J]
    double size = 0;       // sum of the magnitudes of its terms, to which round-off is relative [J]
    Points gradient;       // n x 3, zero for held vertices [N]
    int inverted = 0;      // number of elements that are inverted at x
    int crushed = 0;       // number of elements with det F below 0.1, inverted or not
  };
  // Evaluates g at x, after held vertices have been moved to their targets.
  Value at(Points x) const;

 private:
  // Holds a function with its derivative.
  struct Term {
    std::function<double(double)> value, slope;
  };
  struct Region {
    Term a, b, c;
    Term norm;         // of the squared norm of F
    double fibre = 0;  // kappa [Pa]
    Eigen::Vector3d direction = Eigen::Vector3d::UnitY();
    double stiffness = 0;  // k [Pa]
  };
  static Term power(double factor, double center, int exponent);
  static Term sum(const Term& first, const Term& second);
  static Term log_volume(double linear, double lambda);
  static Term limited(double mu, double low, double high);
  static Term curve(const nlohmann::json& points);
  static Region region_of(const nlohmann::json& json);

  struct Scheme;
  void add_tetrahedra(const Scheme& scheme, const Points& middle, const Points& moved, Value& value) const;
  void add_springs(const Scheme& scheme, const Points& middle, const Points& moved, Value& value) const;
  void add_handles(const Scheme& scheme, const Points& middle, Value& value) const;

  std::vector<Region> regions_;
  Table tets_, region_of_tet_, mass_, springs_, spring_values_, handled_, handle_stiffness_;
  Points targets_, middle_targets_;
};

}  // namespace supple::test
