// Defines how one tetrahedron flows: plastically, once its stress is above the yield stress, or viscously, as the
// Maxwell arm of a standard linear solid. Both work on the principal logarithmic (Hencky) strains of F_e (Simo 1992,
// "Algorithms for static and dynamic multiplicative plasticity that preserve the classical return mapping schemes of
// the infinitesimal theory"), where flow at constant volume scales the deviatoric part. The stress is that of
// Kirchhoff, tau_i = lambda_i dPsi/dlambda_i, so that every isotropic material can flow. Not here: the loop over
// elements, and what is kept (model/flow_step.h).
#pragma once

#include <algorithm>
#include <cmath>

#include "sim/elements/tetrahedron.h"
#include "sim/materials/flow_rules.h"

namespace supple {

// An element whose least elastic stretch is below this one, or that is inverted, does not flow: logarithms say little
// there, and the elastic energy has to unfold it first.
constexpr double least_flowing_stretch = 0.01;

// Finds the energy density of a material at principal stretches, and its derivatives by these.
template <class M>
double density_at_stretches(const M& material, const double (&s)[3], double (&slope)[3]) {
  if constexpr (M::needs == Needs::deformation_gradient) {
    Matrix3<double> f{}, stress;
    for (int i = 0; i < 3; ++i) f(i, i) = s[i];
    const double density = material.density(f, stress);
    for (int i = 0; i < 3; ++i) slope[i] = stress(i, i);
    return density;
  } else if constexpr (M::needs == Needs::stretch) {
    const Symmetric3<double> at{s[0], s[1], s[2], 0, 0, 0};
    Symmetric3<double> stress;
    const double density = material.density(at, stress);
    slope[0] = stress.xx;
    slope[1] = stress.yy;
    slope[2] = stress.zz;
    return density;
  } else {
    return material.density(s, slope);
  }
}

// Holds principal logarithmic strains as their mean and their deviatoric part.
struct LogStrains {
  double mean;
  double deviator[3];

  explicit LogStrains(const double (&s)[3]) {
    double log[3];
    for (int i = 0; i < 3; ++i) log[i] = std::log(s[i]);
    mean = (log[0] + log[1] + log[2]) / 3;
    for (int i = 0; i < 3; ++i) deviator[i] = log[i] - mean;
  }

  // Returns the length of the deviatoric part.
  double length() const { return std::hypot(deviator[0], deviator[1], deviator[2]); }

  // Finds the stretches once a share of the deviatoric part has flowed.
  void stretches(double flowed, double (&s)[3]) const {
    for (int i = 0; i < 3; ++i) s[i] = std::exp(mean + (1 - flowed) * deviator[i]);
  }
};

// Holds what a material has at some strains, by rest volume: its energy density, von Mises' equivalent of Kirchhoff's
// stress, and the product of this stress and the deviatoric strain [Pa].
struct StressAtStrains {
  double density, equivalent, work;
};

template <class M>
StressAtStrains stress_at(const M& material, const LogStrains& strains, double flowed) {
  double s[3], slope[3];
  strains.stretches(flowed, s);
  const double density = density_at_stretches(material, s, slope);
  double tau[3];
  for (int i = 0; i < 3; ++i) tau[i] = s[i] * slope[i];
  const double mean = (tau[0] + tau[1] + tau[2]) / 3;
  double squared = 0, work = 0;
  for (int i = 0; i < 3; ++i) {
    squared += (tau[i] - mean) * (tau[i] - mean);
    work += (tau[i] - mean) * strains.deviator[i];
  }
  return {density, std::sqrt(1.5 * squared), work};
}

// Returns the share of the deviatoric strain that flows, from 0 to 1: that after which the stress is the yield stress,
// which the flow has hardened (a return mapping, implicit in the flow). It is the root of stress - yield, by the
// Illinois form of regula falsi, or less where the plastic strain would pass its limit. Nothing flows where the
// deviatoric stress pulls against the strain, as that of St. Venant-Kirchhoff does under strong compression: flow would
// give energy there. weight: the share of the material's stress that yields. hardened: the plastic strain so far.
template <class M>
double plastic_share(const M& material, const Plasticity& rule, double weight, const LogStrains& strains,
                     double hardened) {
  constexpr double accuracy = 1e-12;  // of the stress, in yield stresses
  constexpr int most = 100;
  const double whole = std::sqrt(2.0 / 3) * strains.length();
  const auto above = [&](double flowed) {
    return weight * stress_at(material, strains, flowed).equivalent - rule.yield -
           rule.hardening * (hardened + flowed * whole);
  };
  double low = 0, high = 1, at_low = above(0), at_high = above(1);
  if (!(at_low > 0) || !(stress_at(material, strains, 0).work > 0)) return 0;
  double root = 1;
  for (int i = 0, kept = 0; i < most && high - low > 1e-15; ++i) {
    root = (low * at_high - high * at_low) / (at_high - at_low);
    const double at_root = above(root);
    if (std::abs(at_root) <= accuracy * rule.yield) break;
    const bool is_low = at_root > 0;
    (is_low ? low : high) = root;
    (is_low ? at_low : at_high) = at_root;
    // The value at a side that stays twice in a row is halved.
    if (kept == (is_low ? 1 : -1)) (is_low ? at_high : at_low) /= 2;
    kept = is_low ? 1 : -1;
  }
  const double allowed = whole > 0 ? std::max(0.0, rule.limit - hardened) / whole : 0;
  return std::min(root, allowed);
}

// Returns the share of the deviatoric strain of a Maxwell arm that flows in a time [s].
inline double viscous_share(const Creep& rule, double time) { return -std::expm1(-time / rule.time); }

// Adds the flow of a share of the deviatoric strain of F_e = U diag(s) V^T: `kept`, which is F_p, becomes V
// diag(exp(flowed deviator)) V^T F_p, and its determinant stays 1.
inline void add_flow(const Svd3<double>& parts, const LogStrains& strains, double flowed, double (&kept)[9]) {
  double factor[3], turned[3][3], result[9] = {};
  for (int i = 0; i < 3; ++i) factor[i] = std::exp(flowed * strains.deviator[i]);
  for (int p = 0; p < 3; ++p) {
    for (int j = 0; j < 3; ++j) {
      turned[p][j] = 0;
      for (int i = 0; i < 3; ++i) turned[p][j] += factor[p] * parts.v(i, p) * kept[3 * i + j];
    }
  }
  Matrix3<double> next;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int p = 0; p < 3; ++p) result[3 * i + j] += parts.v(i, p) * turned[p][j];
      next(i, j) = result[3 * i + j];
    }
  }
  const double size = std::cbrt(determinant(next, cofactor(next)));  // off from 1 by round-off alone
  for (int i = 0; i < 9; ++i) kept[i] = result[i] / size;
}

// Writes D_m^-1 F_p^-1 to `present`: in the place of D_m^-1 it gives an element's F_e in the place of F. rest: D_m^-1
// by rows, whose entries are `stride` numbers apart, as those of `present` are. kept: F_p by rows.
template <class T>
void flowed_rest_shape(const double* rest, std::size_t stride, const double* kept, T* present) {
  Matrix3<double> plastic;
  for (int i = 0; i < 9; ++i) plastic.m[i] = kept[i];
  const Matrix3<double> cofactors = cofactor(plastic);
  const double determ = determinant(plastic, cofactors);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) sum += rest[std::size_t(3 * i + k) * stride] * cofactors(j, k);
      present[std::size_t(3 * i + j) * stride] = static_cast<T>(sum / determ);
    }
  }
}

}  // namespace supple
