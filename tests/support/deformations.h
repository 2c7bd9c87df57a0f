// Provides deformation gradients of every kind that an element can meet.
#pragma once

#include <Eigen/Geometry>
#include <random>

#include "base/types.h"

namespace supple::test {

inline Mat3 random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return q.normalized().toRotationMatrix();
}

// Lists kinds of stretches; the smallest stretch has the sign of det F.
struct Kind {
  const char* name;
  Vec3 (*stretches)(std::mt19937&);
};

inline double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline const Kind kinds[] = {
    {"near rest",
     [](std::mt19937& r) { return Vec3(uniform(r, 0.99, 1.01), uniform(r, 0.99, 1.01), uniform(r, 0.99, 1.01)); }},
    {"random", [](std::mt19937& r) { return Vec3(uniform(r, 0.3, 2), uniform(r, 0.3, 2), uniform(r, 0.3, 2)); }},
    {"inverted",
     [](std::mt19937& r) { return Vec3(uniform(r, 0.8, 2), uniform(r, 0.8, 1.5), uniform(r, -0.6, -0.1)); }},
    {"two equal stretches",
     [](std::mt19937& r) {
       const double s = uniform(r, 0.4, 1.6);
       return Vec3(s, s, uniform(r, 0.4, 1.6));
     }},
    {"three equal stretches", [](std::mt19937& r) { return Vec3(Vec3::Constant(uniform(r, 0.4, 1.6))); }},
    {"nearly flat",
     [](std::mt19937& r) { return Vec3(uniform(r, 0.8, 1.5), uniform(r, 0.8, 1.5), uniform(r, -1e-3, 1e-3)); }},
    {"small",
     [](std::mt19937& r) { return Vec3(uniform(r, 0.01, 0.05), uniform(r, 0.01, 0.05), uniform(r, 0.01, 0.05)); }},
    {"huge", [](std::mt19937& r) { return Vec3(uniform(r, 20, 50), uniform(r, 20, 50), uniform(r, 20, 50)); }},
};

inline Mat3 deformation(const Kind& kind, std::mt19937& random) {
  return random_rotation(random) * kind.stretches(random).asDiagonal() * random_rotation(random);
}

}  // namespace supple::test
