#include "film/record/pair_recorder.h"

#include <algorithm>

#include "base/trace.h"
#include "scene/building/warnings.h"
#include "scene/definition/meeting.h"

namespace supple {
namespace {

template <class List, class Value>
bool contains(const List& list, const Value& value) {
  return std::ranges::find(list, value) != list.end();
}

}  // namespace

PairRecorder::PairRecorder(const World& world, const FrameRows& earlier)
    : world_(world), passings_(world.bodies()), deep_(world.bodies()) {
  std::vector<Positions> start;
  for (const Body& body : world_.bodies()) start.push_back(first_positions(body));
  for (const BodyDepth& overlap : bodies_in_themselves(world_.bodies(), start))
    coming_apart_.push_back({overlap.a, overlap.b, names(overlap.a, overlap.b)});
  for (const BodyDepth& overlap : overlaps_of_bodies(world_.bodies(), start)) {
    coming_apart_.push_back({overlap.a, overlap.b, names(overlap.a, overlap.b)});
    deep_.leave_out(overlap.a, overlap.b);
  }
  std::vector<Names> met, deep;
  earlier.each([&](const FrameRow& row) {
    met.insert(met.end(), row.passing.begin(), row.passing.end());
    for (const DeepRow& pair : row.deep) deep.push_back(pair.bodies);
    note_who_came_apart(row);
  });
  leave_out_known(met, deep);
}

PairRecorder::Names PairRecorder::names(std::size_t a, std::size_t b) const {
  return {world_.bodies()[a].def.name, world_.bodies()[b].def.name};
}

// Tells whether one of both bodies says that overlaps are meant.
bool PairRecorder::is_meant(std::size_t a, std::size_t b) const {
  const std::vector<Body>& bodies = world_.bodies();
  return supple::is_meant(bodies[a].def, WarningKind::overlap) || supple::is_meant(bodies[b].def, WarningKind::overlap);
}

bool PairRecorder::is_coming_apart(const Names& names) const {
  return std::ranges::find(coming_apart_, names, &Overlap::names) != coming_apart_.end();
}

// Leaves out what is meant, and the pairs that an earlier run has found.
void PairRecorder::leave_out_known(const std::vector<Names>& met, const std::vector<Names>& deep) {
  for (std::size_t b = 0; b < world_.bodies().size(); ++b) {
    for (std::size_t a = 0; a <= b; ++a) {
      const bool meant = is_meant(a, b), is_known = contains(deep, names(a, b));
      if (meant || is_known || contains(met, names(a, b))) passings_.leave_out(a, b);
      if (a < b && (meant || is_known)) deep_.leave_out(a, b);
    }
  }
}

void PairRecorder::record(FrameRow& row) {
  const Zone zone("pairs of bodies");
  note_touches(row);
  find_crossed(row);
  if (passings_.none_left() && deep_.none_left()) return;
  std::vector<Positions> points;
  for (std::size_t b = 0; b < world_.size(); ++b)
    points.push_back(in_input_order(world_.body(b).model(), world_.body(b).state().x));
  find_passings(points, row);
  find_deep(points, row);
}

void PairRecorder::note_touches(FrameRow& row) {
  for (const BodyTouch& touch : world_.touches()) {
    const double size = std::min(world_.body(touch.a).model().size, world_.body(touch.b).model().size);
    row.pairs.push_back(
        {names(touch.a, touch.b), touch.contacts, touch.depth / size, touch.force.norm(), is_meant(touch.a, touch.b)});
  }
  note_who_came_apart(row);
  for (PairRow& pair : row.pairs) {
    pair.coming_apart = !pair.expected && is_coming_apart(pair.bodies);
    pair.expected = pair.expected || pair.coming_apart;
  }
}

// Forgets, of the pairs that overlapped at the start, those whose contacts are not deep in this frame. Contacts that
// are not found show nothing, so positions are asked about these pairs again.
void PairRecorder::note_who_came_apart(const FrameRow& row) {
  std::erase_if(coming_apart_, [&](const Overlap& overlap) {
    const auto pair = std::ranges::find(row.pairs, overlap.names, &PairRow::bodies);
    const bool is_apart = pair == row.pairs.end() || pair->penetration <= DeepBodies::deep;
    if (is_apart && overlap.a != overlap.b && !is_meant(overlap.a, overlap.b)) deep_.take_in(overlap.a, overlap.b);
    return is_apart;
  });
}

// Notes each cloth that has come to cross itself. This can only have happened where the cloth touched itself.
void PairRecorder::find_crossed(FrameRow& row) {
  for (const BodyTouch& touch : world_.touches()) {
    if (touch.a != touch.b) continue;
    const MovingBody& body = world_.body(touch.a);
    if (passings_.crosses_itself(touch.a, in_input_order(body.model(), body.state().x)))
      row.deep.push_back({names(touch.a, touch.a), 0, {0, 0, 0}});
  }
}

void PairRecorder::find_passings(const std::vector<Positions>& points, FrameRow& row) {
  const std::vector<Body>& bodies = world_.bodies();
  for (const auto& [a, b] : passings_.find(points)) {
    if (meet(bodies[a].def, bodies[b].def)) {
      row.deep.push_back({names(a, b), 0, {0, 0, 0}});
    } else {
      row.passing.push_back(names(a, b));
    }
  }
}

void PairRecorder::find_deep(const std::vector<Positions>& points, FrameRow& row) {
  for (const BodyDepth& found : deep_.find(points))
    row.deep.push_back({names(found.a, found.b), found.share, {found.place.x(), found.place.y(), found.place.z()}});
}

}  // namespace supple
