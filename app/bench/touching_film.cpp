#include "app/bench/touching_film.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "app/bench/comparison.h"
#include "base/interrupts.h"
#include "base/timing.h"
#include "scene/building/assemble.h"
#include "sim/measures/energies.h"

namespace supple {

TouchingFilm::TouchingFilm(const SceneDef& scene, std::vector<Body> bodies, Threads& threads)
    : world_(scene, std::move(bodies)) {
  world_.start(scenes_own_solver(), &threads);
  scratch_.threads = &threads;
}

TouchingFilm::TouchingFilm(const std::string& text, Threads& threads)
    : TouchingFilm(scene_of_text(text, "touching bodies"), assemble(scene_of_text(text, "touching bodies")), threads) {}

bool TouchingFilm::play(const StepWatch& watch) {
  if (interrupted()) throw BenchInterrupted{};
  work_ = {};
  const auto made = [&](std::size_t body, int substep) {
    const MovingBody& moved = world_.body(body);
    const bool is_joined = moved.is_in_island();
    if (is_joined) work_.largest_island = std::max(work_.largest_island, world_.joined_step().bodies.size());
    if (!is_joined || world_.joined_step().bodies.front() == body) {
      work_.iterations += moved.report().iterations;
      work_.trials += moved.report().line_search;
    }
    if (watch.made) watch.made(body, substep);
  };
  const Stopwatch stopwatch;
  if (!world_.play(frames_, {watch.prepared, made})) return false;
  work_.ms = stopwatch.elapsed_ms();
  ++frames_;
  for (const BodyTouch& touch : world_.touches()) {
    work_.contacts += touch.contacts;
    work_.depths.push_back(touch.depth / std::min(size(touch.a), size(touch.b)));
  }
  for (std::size_t b = 0; b < world_.size(); ++b) {
    for (const Contact& contact : world_.body(b).workspace().current.contacts)
      work_.collider_contacts += contact.other.is_collider() && contact.depth > 0;
  }
  return true;
}

bool TouchingFilm::play_until(int frames) {
  while (frames_ < frames) {
    if (!play()) return false;
  }
  return true;
}

double TouchingFilm::time() const { return world_.scene().fps.time_of(frames_); }

Positions TouchingFilm::places(std::size_t body) const {
  return in_input_order(world_.body(body).model(), world_.body(body).state().x);
}

Vec3 TouchingFilm::center(std::size_t body) const {
  const Model& model = world_.body(body).model();
  Vec3 sum = Vec3::Zero();
  for (int v = 0; v < model.free; ++v) sum += model.mass[v] * world_.body(body).state().x.row(v).transpose();
  return sum / model.total_mass;
}

Vec3 TouchingFilm::momentum(std::size_t body) const {
  const Model& model = world_.body(body).model();
  Vec3 sum = Vec3::Zero();
  for (int v = 0; v < model.free; ++v) sum += model.mass[v] * world_.body(body).state().v.row(v).transpose();
  return sum;
}

Vec3 TouchingFilm::velocity(std::size_t body) const { return momentum(body) / world_.body(body).model().total_mass; }

Vec3 TouchingFilm::momentum() const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t b = 0; b < world_.size(); ++b) sum += momentum(b);
  return sum;
}

Vec3 TouchingFilm::angular_momentum() const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t b = 0; b < world_.size(); ++b) {
    const Model& model = world_.body(b).model();
    const State& state = world_.body(b).state();
    for (int v = 0; v < model.free; ++v) {
      const Vec3 x = state.x.row(v).transpose(), velocity = state.v.row(v).transpose();
      sum += model.mass[v] * x.cross(velocity);
    }
  }
  return sum;
}

double TouchingFilm::kinetic_energy() const {
  double sum = 0;
  for (std::size_t b = 0; b < world_.size(); ++b) {
    const Model& model = world_.body(b).model();
    for (int v = 0; v < model.free; ++v) sum += 0.5 * model.mass[v] * world_.body(b).state().v.row(v).squaredNorm();
  }
  return sum;
}

double TouchingFilm::energy() {
  double sum = 0;
  for (std::size_t b = 0; b < world_.size(); ++b) {
    const MovingBody& body = world_.body(b);
    scratch_.prepare(body.model(), body.inputs().solver);
    const Energies parts = energies(body.model(), body.state(), Vec3::Zero(), scratch_);
    sum += parts.kinetic + parts.elastic;
  }
  return sum;
}

std::string ground_text(double friction) {
  return fmt::format(
      "[[collider]]\nname = \"ground\"\nshape = {{ half_space = {{ normal = [0, 1, 0] }} }}\nfriction = {:g}\n",
      friction);
}

double rank_of(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  std::ranges::sort(values);
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[std::clamp<std::size_t>(rank, 1, values.size()) - 1];
}

}  // namespace supple
