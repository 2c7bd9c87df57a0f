#include "sim/contact/contact_direction.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace supple {

namespace {

// A contact sticks where its friction is at least this share of the stiffness of its normal.
constexpr double least_friction_that_sticks = 0.01;

// Tells whether all parts are cloth that hardly moves at these velocities (n x 3) [m/s].
bool is_cloth_that_lies(const Model& model, const Positions& v) {
  constexpr double little = 1e-3;  // root mean square of a step's way, in sizes
  return std::all_of(model.parts.begin(), model.parts.end(), [&](const Part& part) {
    const double most = little * part.size / model.time_step;
    return !part.solid && v.middleRows(part.first_free, part.free).squaredNorm() <= most * most * part.free;
  });
}

}  // namespace

void find_stiff_directions(const Model& model, const std::vector<Contact>& contacts, const Positions& x,
                           ContactCorrection& correction) {
  std::vector<StiffDirection>& stiff = correction.wanted;
  stiff.clear();
  correction.sticking.clear();
  correction.loose.clear();
  const bool may_stick = correction.may_stick;
  const auto friction_that_sticks = [&](const Contact& contact) {
    if (!may_stick || contact.depth <= 0 || contact.friction <= 0) return 0.0;
    const double along = friction_stiffness(contact, x);
    return along >= least_friction_that_sticks * 2 * contact.stiffness ? along : 0.0;
  };
  for (const Contact& contact : contacts) {
    if (contact.depth <= 0) continue;
    stiff.push_back({contact.stencil, contact.normal, 2 * contact.stiffness});
    if (const double along = friction_that_sticks(contact); along > 0) {
      correction.sticking.push_back({contact.stencil, std::max(2 * contact.stiffness, along)});
    } else if (may_stick) {
      correction.loose.push_back(stiff.back());
    }
  }
  correction.normals = stiff.size();
  for (const Contact& contact : contacts) {
    if (contact.friction <= 0) continue;  // friction is lagged: a point may have left and still be rubbed
    const double along = friction_stiffness(contact, x);
    // Inertia is the limit even where the elements around the point are stiffer, because together they hold a body
    // that would slide as a whole.
    if (along < model.scheme.inertia * contact.stencil.mass(model.mass) / (model.time_step * model.time_step)) continue;
    const Vec3 n = contact.normal;
    const Vec3 side = n.cross(std::abs(n.y()) < 0.7 ? Vec3::UnitY() : Vec3::UnitX()).normalized();
    stiff.push_back({contact.stencil, side, along});
    stiff.push_back({contact.stencil, n.cross(side), along});
    if (may_stick && friction_that_sticks(contact) == 0)
      correction.loose.insert(correction.loose.end(), stiff.end() - 2, stiff.end());
  }
}

// Factoring n directions takes a number of operations that grows as n^3. With 250 directions that is a fraction of a
// millisecond; a large body may have more, as many as are factored in about half the time of a solve with A.
std::size_t most_coupled_directions(const Model& model) {
  const double numbers = static_cast<double>(model.factor.stored_numbers());
  return std::max<std::size_t>(250, static_cast<std::size_t>(std::cbrt(45 * numbers)));
}

namespace {

const System& system_of(const Model& model, const ContactCorrection& c) {
  return c.matrix != nullptr ? *c.matrix : model;
}

// Orders vertices so that every beginning of the order is spread evenly over their numbers (van der Corput's sequence),
// and therefore over the body, in whose order of elimination neighbours stay together. The order does not change from
// step to step, so that only few vertices are ever chosen.
std::uint32_t rank_of(std::int32_t vertex) {
  auto bits = static_cast<std::uint32_t>(vertex);
  std::uint32_t reversed = 0;
  for (int i = 0; i < 32; ++i, bits >>= 1) reversed = reversed << 1 | (bits & 1);
  return reversed;
}

// Returns how many operations factoring the system of a joined model may take: some milliseconds for a pile of 18
// bodies with 900 contacts. A cloth of 3,200 vertices that lies on a soft bunny takes 1.3 times as many evaluations as
// with a complete system, and half as long.
double most_operations(const Model& model) {
  constexpr double of_a_part = 2e7, of_all = 2e9;
  const double numbers = static_cast<double>(model.factor.stored_numbers());
  return std::max(std::min(of_all, of_a_part * static_cast<double>(model.parts.size())), 15 * numbers);
}

// Counts the operations that factor the system of these directions, if all that act on a common part are coupled.
double operations_of(const Model& model, const std::vector<StiffDirection>& directions) {
  const VertexParts parts(model.parts);
  std::map<GroupKey, Eigen::Index> groups;
  for (const StiffDirection& direction : directions) ++groups[parts.of(direction.stencil)];
  std::vector<GroupKey> keys;
  std::vector<Eigen::Index> sizes;
  for (const auto& [key, size] : groups) {
    keys.push_back(key);
    sizes.push_back(size);
  }
  return factor_operations(keys, sizes);
}

// Returns how many of the wanted directions the system may have, so that it does not exceed its limit.
std::size_t affordable(const Model& model, const std::vector<StiffDirection>& wanted) {
  if (model.parts.size() > 1) {
    const double share = std::cbrt(most_operations(model) / std::max(operations_of(model, wanted), 1.0));
    return share >= 1 ? wanted.size() : static_cast<std::size_t>(share * static_cast<double>(wanted.size()));
  }
  std::vector<CoupledDirections> lists;
  for (std::size_t i = 0; i < wanted.size(); ++i) couple(wanted[i], static_cast<Eigen::Index>(i), lists);
  const std::size_t most = most_coupled_directions(model);
  std::size_t largest = 0;
  for (const CoupledDirections& list : lists) largest = std::max(largest, list.members.size());
  return largest <= most ? wanted.size() : wanted.size() * most / largest;
}

// Takes some tangents out of the wanted directions of a joined model when there are more than `most` directions: those
// of the points of lowest rank stay. The first `normals` of the directions are normals, and stay: without some of them,
// a search of bodies that lie on each other comes to a stand. Returns the tangents that were taken out, which are to be
// scaled by themselves. Without that, points slide where they should stick, and of a cloth on a soft body nine of ten
// full steps are refused.
std::vector<StiffDirection> take_out_tangents(std::size_t normals, std::size_t most,
                                              std::vector<StiffDirection>& wanted) {
  constexpr double least_share = 0.25;  // of `most`, for tangents
  constexpr double room_used = 0.95;    // what stays is spread less evenly, and its work is not quite as estimated
  if (wanted.size() <= most) return {};
  const auto all = static_cast<std::size_t>(room_used * double(most));
  const std::size_t tangents = wanted.size() - normals;
  const std::size_t room = std::max(all - std::min(all, normals), static_cast<std::size_t>(least_share * double(most)));
  if (tangents <= room) return {};
  std::vector<std::uint32_t> ranks;
  for (std::size_t i = normals; i < wanted.size(); ++i) ranks.push_back(rank_of(wanted[i].stencil.vertex[0]));
  std::nth_element(ranks.begin(), ranks.begin() + static_cast<std::ptrdiff_t>(room), ranks.end());
  const std::uint32_t limit = ranks[room];
  const auto stays = [&](const StiffDirection& s) { return rank_of(s.stencil.vertex[0]) < limit; };
  const auto left = std::stable_partition(wanted.begin() + static_cast<std::ptrdiff_t>(normals), wanted.end(), stays);
  std::vector<StiffDirection> taken(left, wanted.end());
  wanted.erase(left, wanted.end());
  return taken;
}

// Splits the wanted directions: those of the vertices of lowest rank enter the system, as many as it may have, and also
// represent their neighbours there.
void split(ContactCorrection& c, std::size_t most) {
  c.together = c.wanted;
  c.rest.clear();
  if (c.wanted.size() > most) {
    std::vector<std::uint32_t> ranks;
    for (const StiffDirection& s : c.wanted) ranks.push_back(rank_of(s.stencil.vertex[0]));
    std::nth_element(ranks.begin(), ranks.begin() + static_cast<std::ptrdiff_t>(most), ranks.end());
    const auto last = std::stable_partition(c.together.begin(), c.together.end(), [&](const StiffDirection& s) {
      return rank_of(s.stencil.vertex[0]) < ranks[most];
    });
    c.rest.assign(last, c.together.end());
    c.together.erase(last, c.together.end());
    for (StiffDirection& s : c.together)
      s.stiffness *= static_cast<double>(c.wanted.size()) / static_cast<double>(c.together.size());
  }
  std::stable_sort(c.together.begin(), c.together.end(), [](const StiffDirection& a, const StiffDirection& b) {
    return a.stencil.vertex[0] < b.stencil.vertex[0];
  });
}

FactorPart part_of(const System& system, const std::vector<StiffDirection>& directions) {
  std::vector<std::int32_t> vertices;
  for (const StiffDirection& s : directions)
    vertices.insert(vertices.end(), s.stencil.vertex.begin(), s.stencil.vertex.begin() + s.stencil.free);
  return paths_to_root(system.factor, vertices);
}

// Returns the entry of a matrix with this diagonal for the motion of a point along n / |n|: the mean of the diagonal,
// by the squared weights.
double diagonal_at(const std::vector<double>& diagonal, const ContactStencil& stencil) {
  if (stencil.is_vertex()) return diagonal[stencil.vertex[0]];
  double sum = 0;
  for (int k = 0; k < stencil.free; ++k) sum += stencil.weight[k] * stencil.weight[k] * diagonal[stencil.vertex[k]];
  return sum / stencil.weights_squared();
}

// Returns the share of its motion along a direction of the rest that a point keeps, sqrt(a / (a + k)).
double share(const std::vector<double>& diagonal, const StiffDirection& s) {
  const double a = diagonal_at(diagonal, s.stencil);
  return std::sqrt(a / (a + s.stencil.weights_squared() * s.stiffness));
}

// Scales a motion by the factor of T that belongs to one direction of the rest. When a vertex has several directions
// that are not at right angles, their factors are applied one after the other, and in the opposite order on the way
// back.
void scale_rest(const std::vector<double>& diagonal, const StiffDirection& s, Positions& r) {
  s.add(-(1 - share(diagonal, s)) * s.along(r) / s.stencil.weights_squared(), r);
}

// Computes z = H r with H = P A^-1 P + N diag(1 / (a + k)) N^T, for n of unit length.
void apply_diagonal(const Model& model, ContactCorrection& c, SolveScratch& scratch, Positions& r, Positions& z) {
  c.answer.resize(static_cast<Eigen::Index>(c.wanted.size()));
  for (std::size_t i = 0; i < c.wanted.size(); ++i) {
    const StiffDirection& s = c.wanted[i];
    const double part = s.along(r), squared = s.stencil.weights_squared();
    s.add(-part / squared, r);
    c.answer[static_cast<Eigen::Index>(i)] =
        static_cast<float>(part / (diagonal_at(system_of(model, c).diagonal, s.stencil) + squared * s.stiffness));
  }
  solve_system(model, system_of(model, c), r, z, scratch);
  for (std::size_t i = c.wanted.size(); i-- > 0;) {
    const StiffDirection& s = c.wanted[i];
    s.add((c.answer[static_cast<Eigen::Index>(i)] - s.along(z)) / s.stencil.weights_squared(), z);
  }
}

// Adds the forces -N answer to a solve in progress and to its right-hand side.
void add_answer(ContactCorrection& c, const FactorPart& part, Positions& r) {
  c.solve.clear_addition(part);
  for (Eigen::Index i = 0; i < c.answer.size(); ++i) {
    const StiffDirection& s = c.system.directions()[i];
    const Vec3 force = -static_cast<double>(c.answer[i]) * s.axis;
    for (int k = 0; k < s.stencil.free; ++k) c.solve.add(s.stencil.vertex[k], s.stencil.weight[k] * force);
    s.stencil.spread(force, r);
  }
  c.solve.pass_on(part);
}

// Says which motions the system has in addition to A^-1: those of the second level.
void add_second_level(ContactCorrection& c) {
  SecondLevel* const second = c.second;
  if (second == nullptr) return c.system.add_motions(nullptr);
  const CoarseSystem& coarse = second->system();
  c.motions.pose = second->pose();
  c.motions.first_column.clear();
  for (int part = 0; part <= coarse.parts(); ++part) c.motions.first_column.push_back(coarse.first_column(part));
  c.motions.add_row = [second](const StiffDirection& s, double* row) {
    for (int k = 0; k < s.stencil.free; ++k)
      second->restrict_one(s.stencil.vertex[k], s.stencil.weight[k] * s.axis, row);
  };
  c.motions.difference = [second](int part) -> const Eigen::MatrixXd& { return second->difference(part); };
  c.system.add_motions(&c.motions);
}

void finish(const Model& model, ContactCorrection& c, const Positions& r, Positions& z) {
  c.solve.finish(z.data());
  restore_translation(model, r, z);
}

// Computes z = (A + K')^-1 r; r gets the forces at the contacts.
void apply_low_rank(const Model& model, ContactCorrection& c, Positions& r, Positions& z) {
  c.solve.begin(system_of(model, c).factor, r.data());
  c.solve.look(c.part);
  const std::vector<StiffDirection>& directions = c.system.directions();
  c.answer.resize(static_cast<Eigen::Index>(directions.size()));
  for (Eigen::Index i = 0; i < c.answer.size(); ++i) {
    const ContactStencil& stencil = directions[i].stencil;
    Vec3 seen = stencil.weight[0] * c.solve.seen(stencil.vertex[0]);
    for (int k = 1; k < stencil.free; ++k) seen += stencil.weight[k] * c.solve.seen(stencil.vertex[k]);
    c.answer[i] = static_cast<float>(seen.dot(directions[i].axis));
  }
  if (c.second != nullptr) c.answer += c.system.seen_by_directions(c.second->difference_times(c.coarse));
  c.system.solve(c.answer);
  add_answer(c, c.part, r);
  finish(model, c, r, z);
  if (c.second == nullptr) return;
  c.coarse -= c.system.seen_by_motions(c.answer);
  c.second->add(model, c.coarse, c.threads, z);
}

void apply_both_levels(const Model& model, ContactCorrection& c, SolveScratch& scratch, const Positions& r,
                       Positions& z) {
  solve_system(model, system_of(model, c), r, z, scratch);
  if (c.second != nullptr) c.second->add_to(model, r, c.threads, z);
}

// Computes z = H r with what sticks in the matrix. Overwrites r.
void apply_stuck(ContactCorrection& c, Positions& r, Positions& z) {
  c.system.clear();
  for (const StiffDirection& s : c.loose) scale_rest(c.stuck.diagonal(), s, r);
  c.stuck.solve(r, z);
  for (std::size_t i = c.loose.size(); i-- > 0;) scale_rest(c.stuck.diagonal(), c.loose[i], z);
}

}  // namespace

void begin_corrections(const Model& model, ContactCorrection& c) {
  c.stuck.clear();
  c.system.begin_step(system_of(model, c), model.parts);
}

void begin_sticking(const Model& model, const Positions& v, ContactCorrection& c) {
  c.may_stick = is_cloth_that_lies(model, v);
}

void choose_sticking_system(const Model& model, const ContactSettings& settings, const Positions& x,
                            ContactCorrection& c) {
  constexpr double least_share = 0.5;  // of the contacts that press
  if (settings.direction != ContactDirection::low_rank) return;
  if (!c.stuck.serves()) {
    if (c.sticking.empty() || double(c.sticking.size()) < least_share * double(c.normals)) return;
    if (affordable(model, c.wanted) < c.wanted.size()) c.stuck.make(system_of(model, c), c.sticking, x);
    return;
  }
  // Contacts that began to stick after the matrix was made are scaled by themselves along all axes.
  for (const StickingSystem::Spring& spring : c.sticking) {
    if (c.stuck.has(spring.stencil)) continue;
    for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())})
      c.loose.push_back({spring.stencil, axis, spring.stiffness});
  }
}

bool solve_with_all_contacts(const Model& model, ContactCorrection& c, const Positions& r, Positions& z) {
  constexpr int most_iterations = 60;
  constexpr double small = 1e-4;  // of r^T H r
  const auto product = [](const Positions& a, const Positions& b) { return (a.array() * b.array()).sum(); };
  const Eigen::SparseMatrix<double>& matrix = system_of(model, c).matrix;
  Positions left = r, right(r.rows(), 3), ahead(r.rows(), 3), pushed(r.rows(), 3);
  const auto precondition = [&] {
    right = left;
    apply_stuck(c, right, ahead);
    return product(left, ahead);
  };
  z.setZero(r.rows(), 3);
  const double first = precondition();
  double before = first;
  Positions direction = ahead;
  for (int i = 0; i < most_iterations && before > small * first; ++i) {
    pushed = matrix.selfadjointView<Eigen::Lower>() * direction;
    for (const StiffDirection& s : c.wanted) s.add(s.stiffness * s.along(direction), pushed);
    const double length = before / product(direction, pushed);
    z += length * direction;
    left -= length * pushed;
    const double now = precondition();
    direction = ahead + now / before * direction;
    before = now;
  }
  return before >= 0 && before <= small * first;
}

void apply_inverse(const Model& model, const ContactSettings& settings, ContactCorrection& c, SolveScratch& scratch,
                   Positions& r, Positions& z) {
  add_second_level(c);
  if (c.wanted.empty()) {
    c.system.clear();
    return apply_both_levels(model, c, scratch, r, z);
  }
  if (settings.direction == ContactDirection::diagonal) return apply_diagonal(model, c, scratch, r, z);
  if (c.stuck.serves()) return apply_stuck(c, r, z);
  std::vector<StiffDirection> tangents;
  if (model.parts.size() > 1) tangents = take_out_tangents(c.normals, affordable(model, c.wanted), c.wanted);
  split(c, affordable(model, c.wanted));
  if (!c.system.set(system_of(model, c), c.together, c.threads)) c.rest = c.wanted;
  c.rest.insert(c.rest.end(), tangents.begin(), tangents.end());
  c.part = part_of(system_of(model, c), c.system.directions());
  for (const StiffDirection& s : c.rest) scale_rest(system_of(model, c).diagonal, s, r);
  if (c.system.directions().empty()) {
    apply_both_levels(model, c, scratch, r, z);
  } else {
    if (c.second != nullptr) c.second->restrict(model, r, c.threads, c.coarse);
    apply_low_rank(model, c, r, z);
  }
  for (std::size_t i = c.rest.size(); i-- > 0;) scale_rest(system_of(model, c).diagonal, c.rest[i], z);
}

namespace {

// Returns how far above its plane a point is after moving from x along a direction.
double gap_after(const Contact& contact, const Positions& x, const Positions& direction) {
  return contact.normal.dot(contact.stencil.at(x) + contact.stencil.of_free(direction)) - contact.offset;
}

// Adds to a motion the correction after which it minimises the quadratic model again. off: how far the motion has come
// off the planes of the system, in the order of its directions [m]; ahead, gaps: further planes, and how far the motion
// would lead through them [m].
void bend(const Model& model, const Eigen::VectorXf& off, const std::vector<StiffDirection>& ahead,
          const std::vector<float>& gaps, ContactCorrection& c, Positions& motion) {
  const Eigen::Index before = off.size();
  if (!c.system.append(system_of(model, c), ahead, c.threads)) return;
  c.answer.resize(static_cast<Eigen::Index>(c.system.directions().size()));
  c.answer.head(before) = off;
  std::copy(gaps.begin(), gaps.end(), c.answer.data() + before);
  c.system.solve(c.answer);
  const FactorPart part = part_of(system_of(model, c), c.system.directions());
  c.push.setZero(model.free, 3);
  c.back.resize(model.free, 3);
  c.solve.begin_from_zero(system_of(model, c).factor, c.answer.cwiseAbs().maxCoeff());
  add_answer(c, part, c.push);
  finish(model, c, c.push, c.back);
  if (c.second != nullptr) {
    c.coarse = -c.system.seen_by_motions(c.answer);
    c.second->add(model, c.coarse, c.threads, c.back);
  }
  for (const StiffDirection& s : c.rest) scale_rest(system_of(model, c).diagonal, s, c.back);
  motion += c.back;
}

}  // namespace

bool foresee_contacts(const Model& model, const ContactSettings& settings, const std::vector<Contact>& contacts,
                      const Positions& x, ContactCorrection& c, Positions& direction) {
  if (settings.direction != ContactDirection::low_rank) return false;
  std::vector<StiffDirection> ahead;
  std::vector<float> gaps;
  for (const Contact& contact : contacts) {
    if (contact.depth > 0) continue;
    const double gap = gap_after(contact, x, direction);
    if (gap >= 0) continue;
    ahead.push_back({contact.stencil, contact.normal, 2 * contact.stiffness});
    gaps.push_back(static_cast<float>(gap));
  }
  if (ahead.empty()) return false;
  c.unbent = direction;
  std::vector<StiffDirection> all = c.system.directions();
  all.insert(all.end(), ahead.begin(), ahead.end());
  if (!c.stuck.serves() && affordable(model, all) == all.size()) {
    bend(model, Eigen::VectorXf::Zero(std::ssize(c.system.directions())), ahead, gaps, c, direction);
    return true;
  }
  for (const Contact& contact : contacts) {
    if (contact.depth > 0) continue;
    const double gap = gap_after(contact, x, direction);
    if (gap < 0) contact.stencil.spread(-gap / contact.stencil.weights_squared() * contact.normal, direction);
  }
  return true;
}

void keep_bow_on_planes(const Model& model, const ContactSettings& settings, const std::vector<Contact>& contacts,
                        const Positions& x, const Positions& direction, ContactCorrection& c, Positions& bow) {
  if (settings.direction != ContactDirection::low_rank || contacts.empty()) return;
  const std::vector<StiffDirection>& held = c.system.directions();
  Eigen::VectorXf off(std::ssize(held));
  for (Eigen::Index i = 0; i < off.size(); ++i) off[i] = static_cast<float>(held[i].along(bow));
  const Positions end = direction + bow;
  std::vector<StiffDirection> ahead;
  std::vector<float> gaps;
  for (const Contact& contact : contacts) {
    if (contact.depth > 0) continue;
    const double gap = gap_after(contact, x, end);
    if (gap >= 0) continue;
    const bool is_held = std::any_of(held.begin(), held.end(), [&](const StiffDirection& s) {
      return s.stencil == contact.stencil && s.axis == contact.normal;
    });
    if (is_held) continue;
    ahead.push_back({contact.stencil, contact.normal, 2 * contact.stiffness});
    gaps.push_back(static_cast<float>(gap));
  }
  if (off.size() == 0 && ahead.empty()) return;
  std::vector<StiffDirection> all = held;
  all.insert(all.end(), ahead.begin(), ahead.end());
  if (affordable(model, all) == all.size()) bend(model, off, ahead, gaps, c, bow);
}

}  // namespace supple
