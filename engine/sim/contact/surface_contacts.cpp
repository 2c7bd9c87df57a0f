#include "sim/contact/surface_contacts.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "sim/contact/common_way.h"
#include "sim/contact/own_points.h"
#include "sim/contact/own_sheet_points.h"
#include "sim/contact/sheet_edges.h"
#include "sim/contact/sheet_pair.h"
#include "sim/contact/solid_edges.h"
#include "sim/contact/solid_pair.h"
#include "sim/contact/surface_work.h"
#include "sim/contact/touched_surface.h"
#include "sim/model/joined_model.h"

namespace supple {

SurfaceWork::SurfaceWork() = default;
SurfaceWork::~SurfaceWork() = default;
SurfaceWork::SurfaceWork(SurfaceWork&&) noexcept = default;
SurfaceWork& SurfaceWork::operator=(SurfaceWork&&) noexcept = default;

SurfaceWork::Parts& SurfaceWork::parts() {
  if (parts_ == nullptr) parts_ = std::make_unique<Parts>();
  return *parts_;
}

namespace {

using Work = SurfaceWork::Parts;

constexpr int points_a_chunk = 128;  // a thread takes so many; fixed, so that results do not depend on threads

// Returns the mean motion of some vertices from q to x [m].
Vec3 mean_motion(const std::vector<std::int32_t>& points, const Positions& q, const Positions& x) {
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t v : points) sum += (x.row(v) - q.row(v)).transpose();
  return sum / static_cast<double>(points.size());
}

// Returns how far vertices move beside a common motion at most [m].
double most_moved(const std::vector<std::int32_t>& points, const Positions& q, const Positions& x, const Vec3& common) {
  double most = 0;
  for (const std::int32_t v : points) most = std::max(most, ((x.row(v) - q.row(v)).transpose() - common).squaredNorm());
  return std::sqrt(most);
}

// Moves the surfaces to the positions of an iterate.
void move_surfaces(const Model& model, const Positions& q, const Positions& x, Work& work) {
  for (std::size_t p = 0; p < work.surfaces.size(); ++p) {
    Work::Surface& surface = work.surfaces[p];
    if (surface.moving == nullptr) continue;
    surface.carried = mean_motion(surface.points, q, x);
    surface.own_move = most_moved(surface.points, q, x, surface.carried);
    surface.moving->set_end(rows_of(model.parts[p], x));
  }
}

}  // namespace

void begin_surfaces(const Model& model, const StepInputs& inputs, const Positions& q, const Positions& y,
                    SurfaceWork& all) {
  if (inputs.meetings.empty()) return;
  Work& work = all.parts();
  make_surfaces(model, inputs, work);
  for (std::size_t p = 0; p < work.surfaces.size(); ++p) {
    Work::Surface& surface = work.surfaces[p];
    if (surface.moving == nullptr) continue;
    surface.moving->set_start(rows_of(model.parts[p], q));
    surface.carried_freely = mean_motion(surface.points, q, y);
    surface.free_move = most_moved(surface.points, q, y, surface.carried_freely);
  }
  work.only_sharp = only_sharp_points(model, inputs, work);
  work.beginnings.resize(inputs.meetings.size());
  work.beside_sheets.resize(inputs.meetings.size());
  work.common_ways.assign(inputs.meetings.size(), {});
  work.own_points.resize(model.parts.size());
  for (std::size_t m = 0; m < inputs.meetings.size(); ++m) {
    const Meeting& meeting = inputs.meetings[m];
    if (meeting.is_own()) {
      begin_own_points(model, inputs, meeting, q, y, work);
    } else {
      work.beginnings[m].clear();
      work.beside_sheets[m].clear();
    }
  }
}

double thinnest_layer(const StepInputs& inputs, SurfaceWork& all) {
  double least = infinity;
  if (inputs.meetings.empty()) return least;
  for (const Work::Surface& surface : all.parts().surfaces)
    if (surface.layer > 0) least = std::min(least, surface.layer);
  return least;
}

namespace {

// Writes what a search finds of its points to the lists from `first` on, on all threads; the lists do not depend on the
// number of threads. Returns the number of all lists then.
template <class Search>
std::size_t search_points(const Search& search, Threads* threads, std::size_t first, Work& work) {
  const int chunks = static_cast<int>((search.points() + points_a_chunk - 1) / points_a_chunk);
  if (work.by_chunk.size() < first + std::size_t(chunks)) work.by_chunk.resize(first + std::size_t(chunks));
  run_chunks(threads, chunks, long(search.points()) * 20, [&](int chunk) {
    std::vector<Contact>& list = work.by_chunk[first + std::size_t(chunk)];
    list.clear();
    const std::size_t end = std::min(search.points(), std::size_t(chunk + 1) * points_a_chunk);
    for (std::size_t i = std::size_t(chunk) * points_a_chunk; i < end; ++i) search.find(i, list);
  });
  return first + std::size_t(chunks);
}

// Orders contacts by a number that each has, from 0 on; those with the same number stay in their order.
template <class Number>
void order_by(const Number& number, const std::vector<const Contact*>& from, std::vector<const Contact*>& to,
              std::vector<std::size_t>& first_of) {
  first_of.clear();
  for (const Contact* contact : from) {
    const auto key = std::size_t(number(*contact)) + 1;
    if (first_of.size() <= key) first_of.resize(key + 1);
    ++first_of[key];
  }
  std::partial_sum(first_of.begin(), first_of.end(), first_of.begin());
  to.resize(from.size());
  for (const Contact* contact : from) to[first_of[std::size_t(number(*contact))]++] = contact;
}

// Adds the contacts of the first lists in their order (contact_order.h). There are some ten thousand of them where
// cloth lies on cloth, so that pointers are ordered, and each contact is copied once.
void add_in_order(std::size_t lists, Work& work, std::vector<Contact>& found) {
  work.unordered.clear();
  for (std::size_t i = 0; i < lists; ++i)
    for (const Contact& contact : work.by_chunk[i]) work.unordered.push_back(&contact);
  if (work.unordered.empty()) return;
  order_by([](const Contact& contact) { return contact.number; }, work.unordered, work.by_number, work.first_of);
  order_by([](const Contact& contact) { return contact.other.part; }, work.by_number, work.unordered, work.first_of);
  for (const Contact* contact : work.unordered) found.push_back(*contact);
}

// Returns the share of the ways at which the first of all points is deeper than it may be, or `least` where that is
// less.
template <class Search>
double first_share(const Search& search, double least) {
  for (std::size_t i = 0; i < search.points(); ++i) least = std::min(least, search.share_to_impact(i, least));
  return least;
}

// Calls visit(search) for each search that a meeting needs at an iterate. meeting: its number in the inputs. A search
// is a class with three functions, and a new kind of pair is a new search that is visited here:
//   points()                       returns how many points, pairs or edges it asks about
//   find(index, list)              adds the contacts of one of them to a list; threads share the indices
//   share_to_impact(index, least)  returns the share of its way at which it is as deep as it may be; 1, or `least`,
//                                  where that is not before `least`
template <class Visit>
void visit_searches(const Model& model, const StepInputs& inputs, std::size_t meeting, const Positions& q,
                    const Positions& y, const Positions& x, Work& work, const Visit& visit) {
  const Meeting& of = inputs.meetings[meeting];
  if (of.is_own()) {
    follow_own_points(model, inputs, of, q, x, work);
    if (model.parts[of.points].solid) return visit(OwnPoints(model, inputs, of, q, y, x, work));
    return visit(OwnSheetPoints(model, inputs, of, q, y, x, work));
  }
  if (are_apart(model, inputs, of, work)) return;
  if (model.parts[of.surface].solid) {
    find_common_way(model, inputs, meeting, q, y, x, work);
    visit(SolidPair(model, inputs, meeting, q, y, x, work));
    if (SolidEdges::are_asked(model, inputs, meeting)) visit(SolidEdges(model, inputs, meeting, q, y, x, work));
    return;
  }
  visit(SheetPair(model, inputs, meeting, q, y, x, work));
  if (SheetEdges::are_asked(model, inputs, meeting)) visit(SheetEdges(model, inputs, meeting, q, y, x, work));
}

}  // namespace

void find_surface_contacts(const Model& model, const StepInputs& inputs, const Positions& q, const Positions& y,
                           const Positions& x, Threads* threads, SurfaceWork& all, std::vector<Contact>& found) {
  if (inputs.meetings.empty()) return;
  Work& work = all.parts();
  move_surfaces(model, q, x, work);
  std::size_t lists = 0;
  for (std::size_t m = 0; m < inputs.meetings.size(); ++m)
    visit_searches(model, inputs, m, q, y, x, work,
                   [&](const auto& search) { lists = search_points(search, threads, lists, work); });
  add_in_order(lists, work, found);
}

void stop_at_surfaces(const Model& model, const StepInputs& inputs, const Positions& q, const Positions& x,
                      SurfaceWork& all, std::vector<double>& shares) {
  if (inputs.meetings.empty()) return;
  Work& work = all.parts();
  move_surfaces(model, q, x, work);
  for (std::size_t m = 0; m < inputs.meetings.size(); ++m) {
    const Meeting& meeting = inputs.meetings[m];
    double least = std::max(shares[meeting.points], shares[meeting.surface]);
    visit_searches(model, inputs, m, q, x, x, work, [&](const auto& search) { least = first_share(search, least); });
    shares[meeting.points] = std::min(shares[meeting.points], least);
    shares[meeting.surface] = std::min(shares[meeting.surface], least);
  }
}

}  // namespace supple
