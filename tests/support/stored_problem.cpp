#include "support/stored_problem.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <regex>
#include <stdexcept>

namespace supple::test {
namespace {

using Table = StoredProblem::Table;

// Reads any array of one or two dimensions, as doubles.
Table load(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const std::size_t start =
      10 + static_cast<unsigned char>(bytes.at(8)) + 256 * static_cast<unsigned char>(bytes.at(9));
  const std::string header = bytes.substr(10, start - 10);
  std::smatch shape;
  if (!std::regex_search(header, shape, std::regex("\\((\\d+),( (\\d+))?\\)"))) throw std::runtime_error(path);
  Table table(std::stol(shape[1]), shape[3].matched ? std::stol(shape[3]) : 1);
  const bool real = header.find("<f8") != std::string::npos;
  for (Eigen::Index i = 0; i < table.size(); ++i) {
    if (real) {
      std::memcpy(table.data() + i, &bytes.at(start + 8 * i), 8);
    } else {
      std::int32_t value = 0;
      std::memcpy(&value, &bytes.at(start + 4 * i), 4);
      table.data()[i] = value;
    }
  }
  return table;
}

double zero(double) { return 0; }

}  // namespace

// Holds the coefficients of w/(2 h^2) |x-y|^2_M + e E(theta x + (1-theta) q) + beta/(2h) tr((x-q)^T L (x-q)).
struct StoredProblem::Scheme {
  double h, w, e, theta, beta;
};

StoredProblem::StoredProblem(const std::filesystem::path& folder) {
  std::ifstream(folder / "state.json") >> json;
  const auto table = [&](const char* name) { return load(folder / (std::string(name) + ".npy")); };
  q = table("q");
  v = table("v");
  y = table("y");
  rest = table("rest");
  tets_ = table("tets");
  region_of_tet_ = table("regions");
  mass_ = table("mass");
  handled_ = table("handled");
  handle_stiffness_ = table("handle_stiffness");
  targets_ = table("targets");
  if (json.at("springs") > 0) {
    springs_ = table("springs");
    spring_values_ = table("spring_values");
  }
  if (json.at("integrator") == "implicit-midpoint") middle_targets_ = table("middle_targets");
  for (const auto& region : json.at("regions")) regions_.push_back(region_of(region));
}

StoredProblem::Term StoredProblem::power(double factor, double center, int exponent) {
  return {[=](double s) { return factor * std::pow(s - center, exponent); },
          [=](double s) { return factor * exponent * std::pow(s - center, exponent - 1); }};
}

StoredProblem::Term StoredProblem::sum(const Term& first, const Term& second) {
  return {[=](double s) { return first.value(s) + second.value(s); },
          [=](double s) { return first.slope(s) + second.slope(s); }};
}

// Returns -linear log J + lambda/2 log^2 J; below 0.1 it is the parabola that agrees there to second order.
StoredProblem::Term StoredProblem::log_volume(double linear, double lambda) {
  const double at = 0.1, log_at = std::log(at);
  const double value = -linear * log_at + lambda / 2 * log_at * log_at, slope = (lambda * log_at - linear) / at;
  const double curvature = (lambda + linear - lambda * log_at) / (at * at);
  return {[=](double j) {
            if (j < at) return value + slope * (j - at) + curvature / 2 * (j - at) * (j - at);
            return -linear * std::log(j) + lambda / 2 * std::pow(std::log(j), 2);
          },
          [=](double j) { return j < at ? slope + curvature * (j - at) : (lambda * std::log(j) - linear) / j; }};
}

StoredProblem::Term StoredProblem::limited(double mu, double low, double high) {
  const auto beyond = [=](double s) { return s < low ? s - low : s > high ? s - high : 0.0; };
  return {[=](double s) { return mu * beyond(s) * beyond(s); }, [=](double s) { return 2 * mu * beyond(s); }};
}

// The slope is the natural cubic spline through the points, straight beyond its ends; the value is its integral from 1.
StoredProblem::Term StoredProblem::curve(const nlohmann::json& json) {
  const auto p = json.get<std::vector<std::array<double, 2>>>();
  const auto n = static_cast<Eigen::Index>(p.size());
  Eigen::MatrixXd system = Eigen::MatrixXd::Identity(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    const double before = p[i][0] - p[i - 1][0], after = p[i + 1][0] - p[i][0];
    system.row(i).segment(i - 1, 3) << before, 2 * (before + after), after;
    right[i] = 6 * ((p[i + 1][1] - p[i][1]) / after - (p[i][1] - p[i - 1][1]) / before);
  }
  const Eigen::VectorXd bend = system.fullPivLu().solve(right);
  const auto slope = [p, n, bend](double x) {
    if (x < p[0][0]) {
      const double width = p[1][0] - p[0][0];
      return p[0][1] + (x - p[0][0]) * ((p[1][1] - p[0][1]) / width - width * bend[1] / 6);
    }
    if (x > p[n - 1][0]) {
      const double width = p[n - 1][0] - p[n - 2][0];
      return p[n - 1][1] + (x - p[n - 1][0]) * ((p[n - 1][1] - p[n - 2][1]) / width + width * bend[n - 2] / 6);
    }
    Eigen::Index i = 0;
    while (i + 2 < n && x > p[i + 1][0]) ++i;
    const double width = p[i + 1][0] - p[i][0], v = (x - p[i][0]) / width, u = 1 - v;
    return u * p[i][1] + v * p[i + 1][1] +
           width * width / 6 * ((u * u * u - u) * bend[i] + (v * v * v - v) * bend[i + 1]);
  };
  // Simpson's rule is exact for cubics, so between control points nothing is lost.
  const auto integral = [p, slope](double x) {
    const double low = std::min(x, 1.0), high = std::max(x, 1.0);
    std::vector<double> seams = {low};
    for (const auto& point : p) {
      if (point[0] > low && point[0] < high) seams.push_back(point[0]);
    }
    seams.push_back(high);
    double total = 0;
    for (std::size_t i = 0; i + 1 < seams.size(); ++i) {
      const double from = seams[i], to = seams[i + 1];
      total += (to - from) / 6 * (slope(from) + 4 * slope((from + to) / 2) + slope(to));
    }
    return x < 1 ? -total : total;
  };
  return {integral, slope};
}

StoredProblem::Region StoredProblem::region_of(const nlohmann::json& json) {
  const nlohmann::json& m = json.at("material");
  const std::string model = m.at("model");
  const auto number = [&](const char* key) { return m.value(key, 0.0); };
  const double mu = number("mu"), lambda = number("lambda"), mu_1 = number("mu_1"), mu_2 = number("mu_2");
  const Term none{zero, zero}, square = power(mu, 1, 2);
  const auto constant = [](double value) { return Term{[=](double) { return value; }, zero}; };
  // Returns s^2 - 1, times a factor.
  const auto excess = [&](double factor) { return sum(power(factor, 0, 2), constant(-factor)); };
  Region region{none, none, none, none};
  if (model == "as-rigid-as-possible") {
    region.a = square;
  } else if (model == "polynomial") {
    region.a = power(mu, 1, 4);
  } else if (model == "corotated") {
    region.a = sum(square, sum(power(lambda / 2, 0, 2), sum(power(-3 * lambda, 0, 1), constant(1.5 * lambda))));
    region.b = power(lambda, 0, 1);
  } else if (model == "st-venant-kirchhoff") {
    const Term quartic = sum(power(mu / 4, 0, 4), sum(power(-mu / 2, 0, 2), constant(mu / 4)));
    region.a = sum(quartic, sum(power(lambda / 8, 0, 4), sum(power(-0.75 * lambda, 0, 2), constant(0.375 * lambda))));
    region.b = power(lambda / 4, 0, 2);
  } else if (model == "neo-hookean") {
    region.a = excess(mu / 2);
    region.c = log_volume(mu, lambda);
  } else if (model == "mooney-rivlin") {
    region.a = excess(mu_1 / 2);
    region.b = excess(mu_2 / 2);
    region.c = log_volume(mu_1 + 2 * mu_2, lambda);
  } else if (model == "fixed-corotated") {
    region.a = square;
    region.c = power(lambda / 2, 1, 2);
  } else if (model == "stable-neo-hookean") {
    region.a = excess(mu / 2);
    region.c = sum(power(-0.75 * mu, 1, 1), power(lambda / 2, 1, 2));
    region.norm = {[=](double i) { return -mu / 2 * std::log((i + 1) / 4); },
                   [=](double i) { return -mu / (2 * i + 2); }};
  } else if (model == "spline") {
    if (m.contains("a")) region.a = curve(m["a"]);
    if (m.contains("b")) region.b = curve(m["b"]);
    if (m.contains("c")) region.c = curve(m["c"]);
  } else if (model == "strain-limiting") {
    region.a = sum(limited(mu_1, m.at("low_1"), m.at("high_1")), limited(mu_2, m.at("low_2"), m.at("high_2")));
  } else {
    throw std::runtime_error("no formula for " + model);
  }
  region.stiffness = json.at("system_stiffness");
  if (json.contains("fibre")) {
    region.fibre = json["fibre"].at("kappa");
    for (int i = 0; i < 3; ++i) region.direction[i] = json["fibre"].at("direction")[i];
  }
  return region;
}

StoredProblem::Value StoredProblem::at(Points x) const {
  const bool midpoint = json.at("integrator") == "implicit-midpoint";
  const Scheme scheme{json.at("time_step"), midpoint ? 2.0 : 1.0, midpoint ? 2.0 : 1.0, midpoint ? 0.5 : 1.0,
                      json.at("damping")};
  std::vector<char> held(x.rows(), 0);
  for (Eigen::Index i = 0; i < handled_.rows(); ++i) {
    if (handle_stiffness_(i) > 0) continue;
    const auto vertex = Eigen::Index(handled_(i));
    held[vertex] = 1;
    x.row(vertex) = targets_.row(i);
  }
  Value value;
  value.gradient = Points::Zero(x.rows(), 3);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    if (held[i]) continue;
    const double weight = scheme.w * mass_(i) / (scheme.h * scheme.h);
    value.objective += weight / 2 * (x.row(i) - y.row(i)).squaredNorm();
    value.gradient.row(i) += weight * (x.row(i) - y.row(i));
  }
  value.size = value.objective;
  const Points middle = scheme.theta * x + (1 - scheme.theta) * q, moved = x - q;
  add_tetrahedra(scheme, middle, moved, value);
  add_springs(scheme, middle, moved, value);
  add_handles(scheme, middle, value);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    if (held[i]) value.gradient.row(i).setZero();
  }
  return value;
}

void StoredProblem::add_tetrahedra(const Scheme& scheme, const Points& middle, const Points& moved,
                                   Value& value) const {
  for (Eigen::Index t = 0; t < tets_.rows(); ++t) {
    Eigen::Index corner[4];
    for (int k = 0; k < 4; ++k) corner[k] = Eigen::Index(tets_(t, k));
    const auto edges = [&](const Points& points) {
      Eigen::Matrix3d columns;
      for (int k = 0; k < 3; ++k) columns.col(k) = (points.row(corner[k + 1]) - points.row(corner[0])).transpose();
      return columns;
    };
    const Eigen::Matrix3d at_rest = edges(rest), inverse = at_rest.inverse(), f = edges(middle) * inverse;
    const double volume = at_rest.determinant() / 6;
    value.inverted += f.determinant() < 0;
    value.crushed += f.determinant() < 0.1;
    Eigen::JacobiSVD<Eigen::Matrix3d> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d left = svd.matrixU(), right = svd.matrixV();
    Eigen::Vector3d s = svd.singularValues(), slope;
    for (Eigen::Matrix3d* side : {&left, &right}) {
      if (side->determinant() > 0) continue;
      side->col(2) *= -1;
      s[2] *= -1;
    }
    const Region& region = regions_.at(std::size_t(region_of_tet_(t)));
    const double product = s.prod();
    const double norm = s.squaredNorm(), of_norm = region.norm.value(norm);
    double density = region.c.value(product) + of_norm, size = std::abs(region.c.value(product)) + std::abs(of_norm);
    for (int i = 0; i < 3; ++i) {
      const double other = s[(i + 1) % 3], third = s[(i + 2) % 3];
      for (const double part : {region.a.value(s[i]), region.b.value(other * third)}) {
        density += part;
        size += std::abs(part);
      }
      slope[i] = region.a.slope(s[i]) + region.b.slope(s[i] * other) * other + region.b.slope(s[i] * third) * third +
                 region.c.slope(product) * other * third + 2 * s[i] * region.norm.slope(norm);
    }
    Eigen::Matrix3d stress = left * slope.asDiagonal() * right.transpose();
    if (region.fibre > 0) {
      const Eigen::Vector3d along = f * region.direction;
      density += region.fibre / 2 * std::pow(along.norm() - 1, 2);
      stress += region.fibre * (along.norm() - 1) * along.normalized() * region.direction.transpose();
    }
    value.objective += scheme.e * volume * density;
    value.size += scheme.e * volume * size;
    Eigen::Matrix3d total = scheme.e * scheme.theta * stress;
    if (scheme.beta > 0) {
      const double drag = scheme.beta / scheme.h;
      const Eigen::Matrix3d change = edges(moved) * inverse;
      const Eigen::Vector3d along = change * region.direction;
      value.objective +=
          drag / 2 * volume * (region.stiffness * change.squaredNorm() + region.fibre * along.squaredNorm());
      total += drag * (region.stiffness * change + region.fibre * along * region.direction.transpose());
    }
    const Eigen::Matrix3d force = volume * total * inverse.transpose();
    for (int k = 0; k < 3; ++k) {
      value.gradient.row(corner[k + 1]) += force.col(k).transpose();
      value.gradient.row(corner[0]) -= force.col(k).transpose();
    }
  }
}

void StoredProblem::add_springs(const Scheme& scheme, const Points& middle, const Points& moved, Value& value) const {
  for (Eigen::Index s = 0; s < springs_.rows(); ++s) {
    const auto from = Eigen::Index(springs_(s, 0)), to = Eigen::Index(springs_(s, 1));
    const double length = spring_values_(s, 0), stiffness = spring_values_(s, 1), drag = scheme.beta / scheme.h;
    const Eigen::RowVector3d edge = middle.row(to) - middle.row(from), change = moved.row(to) - moved.row(from);
    const double energy = scheme.e * stiffness / 2 * std::pow(edge.norm() - length, 2);
    value.objective += energy + drag / 2 * stiffness * change.squaredNorm();
    value.size += energy;
    const Eigen::RowVector3d force =
        scheme.e * scheme.theta * stiffness * (edge.norm() - length) * edge.normalized() + drag * stiffness * change;
    value.gradient.row(to) += force;
    value.gradient.row(from) -= force;
  }
}

void StoredProblem::add_handles(const Scheme& scheme, const Points& middle, Value& value) const {
  const Points& targets = middle_targets_.size() > 0 ? middle_targets_ : targets_;
  for (Eigen::Index i = 0; i < handled_.rows(); ++i) {
    if (handle_stiffness_(i) <= 0) continue;
    const auto vertex = Eigen::Index(handled_(i));
    const Eigen::RowVector3d away = middle.row(vertex) - targets.row(i);
    const double energy = scheme.e * handle_stiffness_(i) / 2 * away.squaredNorm();
    value.objective += energy;
    value.size += energy;
    value.gradient.row(vertex) += scheme.e * scheme.theta * handle_stiffness_(i) * away;
  }
}

}  // namespace supple::test
