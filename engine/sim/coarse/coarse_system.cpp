#include "sim/coarse/coarse_system.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>

#include "base/error.h"
#include "sim/coarse/rest_moduli.h"
#include "sim/model/element_view.h"
#include "sim/model/vertex_chunks.h"

namespace supple {
namespace {

constexpr int functions = 4;                // of a cluster: w_c, and w_c (X - O)_j
constexpr int coordinates = 3 * functions;  // coordinates of displacements that are made of these functions

using FunctionBlock = Eigen::Matrix<double, coordinates, coordinates>;

// Returns how the rigid motions of a cluster are made of its functions: the shift along e_k is w e_k, and the turn e_k
// x (X - O) w is the sum of (e_k x e_j) w (X - O)_j.
Eigen::Matrix<double, coordinates, rigid_motions> motions_by_functions() {
  Eigen::Matrix<double, coordinates, rigid_motions> p;
  p.setZero();
  for (int k = 0; k < 3; ++k) {
    p(k, k) = 1;
    for (int j = 0; j < 3; ++j) p.block<3, 1>(3 * (1 + j), 3 + k) = Vec3::Unit(k).cross(Vec3::Unit(j));
  }
  return p;
}

// Returns the cluster with the largest sum of weights at the corners of an element, or the first of several that are
// equal but for round-off.
std::int32_t strongest(const Clusters& clusters, const ElementView& element) {
  std::map<std::int32_t, double> sums;
  for (const std::int32_t v : element.corner) {
    for (int k = 0; k < Clusters::most_of_vertex; ++k) sums[clusters.of[v][k]] += clusters.weight[v][k];
  }
  const auto most = std::max_element(sums.begin(), sums.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second * (1 - 1e-9); });
  return most->first;
}

int place_in(const std::vector<std::int32_t>& sorted, std::int32_t value) {
  return static_cast<int>(std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin());
}

// Sums masses up, for their moment of inertia.
struct PointMasses {
  double mass = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();

  void add(double of, const Vec3& at) {
    mass += of;
    first += of * at;
    second += of * at * at.transpose();
  }

  // Returns the moment of inertia about the axis through the centre of mass that has the least [kg m^2].
  double least_inertia() const {
    const Mat3 central = second - first * first.transpose() / mass;
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(central, Eigen::EigenvaluesOnly);
    return std::max(axes.eigenvalues()[0] + axes.eigenvalues()[1], 1e-300);
  }
};

}  // namespace

void CoarseSystem::make(const Model& model) {
  if (structure_ != model.structure) make_structure(model);
  if (model_ == model.id) return;
  for (Group& group : groups_) set_values(model, group);
  sheets_.set_values(model);
  patches_ = make_patches(model, clusters_);
  find_stretch_bounds(model);
  find_hampered(model);
  model_ = model.id;
}

// A cluster that turns by theta moves its vertices so that the sum of m |d|^2 is at least theta^2 times its least
// moment of inertia.
void CoarseSystem::find_stretch_bounds(const Model& model) {
  struct Turning {
    PointMasses masses;
    double stiffness = 0;
  };
  std::vector<Turning> turning(clusters_.count());
  for (const SheetPatch& patch : patches_) {
    Turning& of = turning[patch.cluster];
    of.stiffness += patch.stiffness;
    for (std::size_t i = 0; i < patch.vertex.size(); ++i)
      of.masses.add(patch.mass[i], model.rest.row(patch.vertex[i]).transpose());
  }
  for (const Group& group : groups_) {
    Turning& of = turning[group.cluster];
    of.stiffness += group.stiffness * group.volume;
    for (const std::int32_t v : group.vertex) of.masses.add(model.mass[v], model.rest.row(v).transpose());
  }
  stretch_bounds_.assign(std::size_t(parts()), 0.0);
  for (std::size_t c = 0; c < turning.size(); ++c) {
    if (turning[c].masses.mass <= 0) continue;
    const double inertia = turning[c].masses.least_inertia();
    stretch_bounds_[part_of_[c]] += turning[c].stiffness / (inertia * inertia);
  }
}

// A unit turn takes the energy k V of L, and that of kappa V/2 of fibres at most. Inertia has I/(2 h^2) about the axis
// with the least moment of inertia. Where L has less than inertia and drag, ten iterations turn the body, and a second
// level would mostly cost time: it knows less of how a soft body deforms than the pairs of L-BFGS find out
// (docs/method.md, "Bodies that turn"). With twice as much and more, balls of stable Neo-Hookean that roll are nearer
// to the solved ones with it.
void CoarseSystem::find_hampered(const Model& model) {
  std::vector<double> stiffness(std::size_t(parts()), 0.0);  // sum of (2 k + kappa) V [J]
  for (const Group& group : groups_) {
    const double kappa = model.fibres.empty() ? 0 : model.fibres[std::size_t(group.region)].kappa;
    stiffness[std::size_t(group.part)] += (2 * group.stiffness + kappa) * group.volume;
  }
  const double elastic = model.scheme.energy * model.scheme.theta * model.scheme.theta;
  const double inverse_h2 = model.scheme.inertia / (model.time_step * model.time_step);
  hampered_.assign(std::size_t(parts()), 1);
  for (int p = 0; p < parts(); ++p) {
    const Part& part = model.parts[p];
    PointMasses masses;
    for (const auto& [first, count] : {std::pair(part.first_free, part.free), std::pair(part.first_held, part.held)}) {
      for (int v = first; v < first + count; ++v) masses.add(model.mass[v], model.rest.row(v).transpose());
    }
    if (masses.mass <= 0 || sheets_.is_sheet(p)) continue;
    hampered_[p] = elastic * stiffness[p] > inverse_h2 * masses.least_inertia() + part.drag * stiffness[p];
  }
}

void CoarseSystem::make_structure(const Model& model) {
  groups_.clear();
  pieces_.clear();
  part_of_.clear();
  clusters_ = {};
  model_ = 0;
  structure_ = model.structure;
  clusters_ = make_clusters(model, wanted_clusters(model));
  for (int part = 0; part < parts(); ++part)
    part_of_.insert(part_of_.end(), std::size_t(columns_of(part) / rigid_motions), part);
  make_groups(model);
  add_gradients(model);
  sheets_.make_structure(model, clusters_);
  make_pieces(model);
}

// Cuts each part by itself, so that its sums are the same whatever it is joined with.
void CoarseSystem::make_pieces(const Model& model) {
  std::size_t numbers = 0;
  for (int p = 0; p < parts(); ++p) {
    const Part& part = model.parts[p];
    if (columns_of(p) == 0) continue;
    const int end = part.first_free + part.free;
    for (int first = part.first_free; first < end; first += vertices_a_chunk) {
      pieces_.push_back({p, first, std::min(end, first + vertices_a_chunk), numbers});
      numbers += numbers_a_cluster * std::size_t(columns_of(p) / rigid_motions);
    }
  }
  partial_.resize(numbers);
}

void CoarseSystem::make_groups(const Model& model) {
  std::map<std::pair<std::int32_t, int>, std::size_t> place;          // the group of a cluster and region
  std::vector<std::map<std::int32_t, std::pair<Vec3, double>>> sums;  // by group: V G and V/4 of each vertex
  group_of_.clear();
  for_each_element(model, [&](const ElementView& element) {
    if (element.kind != ElementKind::tetrahedron) return;
    const std::int32_t cluster = strongest(clusters_, element);
    const auto [entry, is_new] = place.try_emplace({cluster, element.region}, groups_.size());
    if (is_new) {
      groups_.emplace_back();
      sums.emplace_back();
      groups_.back().region = element.region;
      groups_.back().cluster = cluster;
      groups_.back().part = part_of_[cluster];
    }
    group_of_.push_back(static_cast<std::int32_t>(entry->second));
    const SystemTerm term = unit_term(element);
    groups_[entry->second].volume += term.weight;
    for (int k = 0; k < 4; ++k) {
      auto& [gradient, share] = sums[entry->second].try_emplace(element.corner[k], Vec3::Zero(), 0.0).first->second;
      gradient += term.weight * Vec3(term.row[k][0], term.row[k][1], term.row[k][2]);
      share += term.weight / 4;
    }
  });
  volume_.assign(std::size_t(clusters_.count()), 0.0);
  for (const Group& group : groups_) volume_[group.cluster] += group.volume;
  std::vector<char> taken(model.free, 0);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    Group& group = groups_[g];
    for (const auto& [v, sum] : sums[g]) {
      group.vertex.push_back(v);
      group.gradient.push_back(sum.first / group.volume);
      group.share.push_back(sum.second / group.volume);
      group.rest_center += group.share.back() * model.rest.row(v).transpose();
      if (v >= model.free) continue;
      for (int k = 0; k < Clusters::most_of_vertex; ++k) {
        if (clusters_.weight[v][k] > 0) group.clusters.push_back(clusters_.of[v][k]);
      }
      if (taken[v]) continue;
      taken[v] = 1;
      group.own.push_back(v);
    }
    std::sort(group.clusters.begin(), group.clusters.end());
    group.clusters.erase(std::unique(group.clusters.begin(), group.clusters.end()), group.clusters.end());
    const auto size = static_cast<Eigen::Index>(coordinates * group.clusters.size());
    group.gradients.setZero(size, size);
  }
}

namespace {

// Holds the derivatives of the functions of the clusters that an element's free corners belong to.
struct ElementFunctions {
  using Derivatives = Eigen::Matrix<double, coordinates, 1>;
  std::vector<int> place;                // of each cluster among the group's
  std::vector<Derivatives> derivatives;  // entry 3 j + a: d_a of function j [1/m], [1]

  Derivatives& of(int at) {
    const auto known = std::find(place.begin(), place.end(), at);
    if (known != place.end()) return derivatives[std::size_t(known - place.begin())];
    place.push_back(at);
    return derivatives.emplace_back(Derivatives::Zero());
  }
};

}  // namespace

void CoarseSystem::add_gradients(const Model& model) {
  std::size_t number = 0;
  ElementFunctions element_functions;
  for_each_element(model, [&](const ElementView& element) {
    if (element.kind != ElementKind::tetrahedron) return;
    Group& group = groups_[group_of_[number++]];
    const SystemTerm term = unit_term(element);
    auto& [place, derivatives] = element_functions;
    place.clear();
    derivatives.clear();
    for (int i = 0; i < 4; ++i) {
      const std::int32_t v = element.corner[i];
      if (v >= model.free) continue;
      const Vec3 offset = model.rest.row(v).transpose() - group.rest_center;
      const Vec3 row(term.row[i][0], term.row[i][1], term.row[i][2]);
      for (int k = 0; k < Clusters::most_of_vertex; ++k) {
        const double weight = clusters_.weight[v][k];
        if (weight <= 0) continue;
        ElementFunctions::Derivatives& to = element_functions.of(place_in(group.clusters, clusters_.of[v][k]));
        to.head<3>() += weight * row;
        for (int j = 0; j < 3; ++j) to.segment<3>(3 * (1 + j)) += weight * offset[j] * row;
      }
    }
    for (std::size_t c = 0; c < place.size(); ++c) {
      for (std::size_t d = 0; d < place.size(); ++d)
        group.gradients.block<coordinates, coordinates>(coordinates * place[c], coordinates * place[d]).noalias() +=
            term.weight * derivatives[c] * derivatives[d].transpose();
    }
  });
  group_of_ = {};
}

namespace {

// Holds the stiffness of a region at rest. Its energy is mu |e|^2 + lambda/2 tr^2 e + kappa/2 (d . e d)^2 with the
// strain e and the fibres' direction d; the energy of the paper's L is grad u : grad u K / 2.
struct RegionStiffness {
  RestModuli moduli;  // with a share of k, so that no material is without stiffness [Pa]
  double kappa = 0;   // [Pa]
  Vec3 fibre = Vec3::Zero();
  Mat3 constant = Mat3::Zero();  // K [Pa]
};

// Returns the stiffness of a region. A material such as the polynomial has no stiffness at rest, but resists within a
// step. So a tenth of the stiffness is that of k, which is fitted over an interval, in a form that costs no energy
// where an element turns.
RegionStiffness stiffness_of(const Model& model, int region) {
  constexpr double share_of_constant = 0.1;
  const double k = model.stiffness[region].k;
  RegionStiffness stiffness;
  stiffness.moduli = rest_moduli(model.materials[region]);
  stiffness.moduli.mu = (1 - share_of_constant) * stiffness.moduli.mu + share_of_constant * k / 2;
  stiffness.moduli.lambda *= 1 - share_of_constant;
  stiffness.constant = k * Mat3::Identity();
  if (model.fibres.empty()) return stiffness;
  const Fibre& fibre = model.fibres[region];
  stiffness.kappa = fibre.kappa;
  stiffness.fibre = Vec3(fibre.direction[0], fibre.direction[1], fibre.direction[2]);
  stiffness.constant += fibre.kappa * stiffness.fibre * stiffness.fibre.transpose();
  return stiffness;
}

// These return the stiffness of displacements that are made of two clusters' functions, where `gradients` has the
// integrals of the products of their derivatives.
FunctionBlock constant_stiffness(const FunctionBlock& gradients, const Mat3& constant) {
  FunctionBlock result;
  for (int i = 0; i < functions; ++i) {
    for (int j = 0; j < functions; ++j) {
      const double product = gradients.block<3, 3>(3 * i, 3 * j).cwiseProduct(constant).sum();
      result.block<3, 3>(3 * i, 3 * j) = product * Mat3::Identity();
    }
  }
  return result;
}

FunctionBlock rest_stiffness(const FunctionBlock& gradients, const RegionStiffness& stiffness) {
  const auto [mu, lambda] = stiffness.moduli;
  const Mat3 along = stiffness.kappa * stiffness.fibre * stiffness.fibre.transpose();
  FunctionBlock result;
  for (int i = 0; i < functions; ++i) {
    for (int j = 0; j < functions; ++j) {
      const Mat3 t = gradients.block<3, 3>(3 * i, 3 * j);
      result.block<3, 3>(3 * i, 3 * j) = mu * (t.trace() * Mat3::Identity() + t.transpose()) + lambda * t +
                                         stiffness.fibre.dot(t * stiffness.fibre) * along;
    }
  }
  return result;
}

// Returns the stiffness of masses and springs of handles, by pairs of functions; it is the same for x, y and z.
FunctionBlock point_stiffness(const Eigen::Ref<const Eigen::Matrix<double, functions, functions>>& products) {
  FunctionBlock result;
  for (int i = 0; i < functions; ++i) {
    for (int j = 0; j < functions; ++j) result.block<3, 3>(3 * i, 3 * j) = products(i, j) * Mat3::Identity();
  }
  return result;
}

}  // namespace

Eigen::MatrixXd CoarseSystem::point_products(const Model& model, const Group& group) const {
  const auto count = static_cast<Eigen::Index>(functions * group.clusters.size());
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(count, count);
  const double inverse_h2 = model.scheme.inertia / (model.time_step * model.time_step);
  const double elastic = model.scheme.energy * model.scheme.theta * model.scheme.theta;
  for (const std::int32_t v : group.own) {
    double stiffness = inverse_h2 * model.mass[v];
    if (!model.handle_stiffness.empty()) stiffness += elastic * model.handle_stiffness[v];
    Eigen::Vector4d values;
    values << 1, model.rest.row(v).transpose() - group.rest_center;
    for (int k = 0; k < Clusters::most_of_vertex; ++k) {
      for (int l = 0; l < Clusters::most_of_vertex; ++l) {
        const double weight = stiffness * clusters_.weight[v][k] * clusters_.weight[v][l];
        if (weight == 0) continue;
        products.block<functions, functions>(functions * place_in(group.clusters, clusters_.of[v][k]),
                                             functions * place_in(group.clusters, clusters_.of[v][l])) +=
            weight * values * values.transpose();
      }
    }
  }
  return products;
}

void CoarseSystem::set_values(const Model& model, Group& group) const {
  static const Eigen::Matrix<double, coordinates, rigid_motions> by_functions = motions_by_functions();
  const auto count = static_cast<Eigen::Index>(group.clusters.size());
  const double elastic = model.scheme.energy * model.scheme.theta * model.scheme.theta;
  const double drag = model.parts[group.part].drag;
  const RegionStiffness stiffness = stiffness_of(model, group.region);
  const Eigen::MatrixXd points = point_products(model, group);
  group.stiffness = model.stiffness[group.region].k;
  group.constant.resize(rigid_motions * count, rigid_motions * count);
  group.hessian.resize(rigid_motions * count, rigid_motions * count);
  for (Eigen::Index c = 0; c < count; ++c) {
    for (Eigen::Index d = 0; d < count; ++d) {
      const FunctionBlock gradients = group.gradients.block<coordinates, coordinates>(coordinates * c, coordinates * d);
      const FunctionBlock by_constant = constant_stiffness(gradients, stiffness.constant);
      const FunctionBlock in_both =
          point_stiffness(points.block<functions, functions>(functions * c, functions * d)) + drag * by_constant;
      group.constant.block<rigid_motions, rigid_motions>(rigid_motions * c, rigid_motions * d) =
          by_functions.transpose() * (in_both + elastic * by_constant) * by_functions;
      group.hessian.block<rigid_motions, rigid_motions>(rigid_motions * c, rigid_motions * d) =
          by_functions.transpose() * (in_both + elastic * rest_stiffness(gradients, stiffness)) * by_functions;
    }
  }
}

}  // namespace supple
