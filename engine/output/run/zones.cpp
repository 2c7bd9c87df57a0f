#include "output/run/zones.h"

#include <algorithm>

#include "base/error.h"

namespace supple {
namespace {

constexpr const char* frame_zone = "frame";

// Returns the frames of a run in order, or nothing when the thread makes none.
std::vector<const TraceEvent*> frames_of(const ThreadTrace& thread) {
  std::vector<const TraceEvent*> frames;
  for (const TraceEvent& event : thread.events) {
    if (event.depth == 0 && event.name == std::string_view(frame_zone)) frames.push_back(&event);
  }
  return frames;
}

// Returns the number of the frame that was being made at that time, or -1 before the first and after the last frame.
int frame_at(const std::vector<const TraceEvent*>& frames, std::int64_t ns) {
  const auto after = std::ranges::upper_bound(frames, ns, {}, [](const TraceEvent* f) { return f->begin_ns; });
  if (after == frames.begin() || ns > frames.back()->end_ns) return -1;
  return (*std::prev(after))->number;
}

bool lies_in(const TraceEvent& inner, const TraceEvent& outer) {
  return outer.depth < inner.depth && outer.begin_ns <= inner.begin_ns && inner.end_ns <= outer.end_ns;
}

double ms_of(const TraceEvent& event) { return 1e-6 * static_cast<double>(event.end_ns - event.begin_ns); }

}  // namespace

int ZoneTimes::depth() const { return static_cast<int>(std::ranges::count(path, '/')); }

std::string ZoneTimes::name() const { return path.substr(path.rfind('/') + 1); }

ZoneCollector::ZoneCollector(ProfiledRun run) { profile_.run = std::move(run); }

int ZoneCollector::node(const std::string& thread, int parent, const std::string& name) {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (nodes_[i].parent == parent && nodes_[i].name == name && nodes_[i].thread == thread) return static_cast<int>(i);
  }
  nodes_.push_back({thread, name, parent, 0, {}, {}});
  return static_cast<int>(nodes_.size()) - 1;
}

void ZoneCollector::add_setup(const TraceEvent& event) {
  auto at = std::ranges::find(profile_.setup, std::string(event.name), &SetupTimes::name);
  if (at == profile_.setup.end()) at = profile_.setup.insert(at, {event.name, {}});
  at->ms.resize(profile_.repeats);
  at->ms.back() += ms_of(event);
}

void ZoneCollector::add_thread(const ThreadTrace& thread, const std::vector<const TraceEvent*>& frames) {
  struct Open {
    const TraceEvent* event;
    int node, frame;
  };
  std::vector<Open> open;
  for (const TraceEvent& event : thread.events) {
    while (!open.empty() && !lies_in(event, *open.back().event)) open.pop_back();
    int frame = !open.empty() ? open.back().frame : event.number;
    if (open.empty() && frame < 0) frame = frame_at(frames, event.begin_ns);
    if (open.empty() && frame < 0 && thread.number == 0) add_setup(event);
    const int parent = open.empty() ? -1 : open.back().node;
    if (frame < 0) {
      open.push_back({&event, -1, -1});
      continue;
    }
    SUPPLE_CHECK(frame, <, profile_.run.frames);
    const int at = node(thread.name, parent, event.name);
    Node& zone = nodes_[at];
    zone.ms.resize(profile_.repeats, std::vector<double>(profile_.run.frames));
    zone.self_ms.resize(profile_.repeats, std::vector<double>(profile_.run.frames));
    zone.ms.back()[frame] += ms_of(event);
    zone.self_ms.back()[frame] += ms_of(event);
    if (parent >= 0) nodes_[parent].self_ms.back()[frame] -= ms_of(event);
    ++zone.calls;
    open.push_back({&event, at, frame});
  }
}

void ZoneCollector::add(const std::vector<ThreadTrace>& threads) {
  ++profile_.repeats;
  std::vector<const TraceEvent*> frames;
  for (const ThreadTrace& thread : threads) {
    if (frames.empty()) frames = frames_of(thread);
  }
  for (const ThreadTrace& thread : threads) add_thread(thread, frames);
}

void ZoneCollector::add_rows(const std::string& thread, int parent, const std::string& path,
                             ZoneProfile& profile) const {
  const auto repeats = static_cast<std::size_t>(profile.repeats);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& zone = nodes_[i];
    if (zone.parent != parent || zone.thread != thread) continue;
    ZoneTimes row{thread, path + zone.name, 0, zone.ms, zone.self_ms};
    row.calls = static_cast<double>(zone.calls) / static_cast<double>(repeats) / profile.run.frames;
    row.ms.resize(repeats, std::vector<double>(profile.run.frames));
    row.self_ms.resize(repeats, std::vector<double>(profile.run.frames));
    profile.zones.push_back(std::move(row));
    add_rows(thread, static_cast<int>(i), path + zone.name + "/", profile);
  }
}

ZoneProfile ZoneCollector::result() const {
  ZoneProfile profile = profile_;
  for (SetupTimes& row : profile.setup) row.ms.resize(profile.repeats);
  std::vector<std::string> threads;
  for (const Node& zone : nodes_) {
    if (std::ranges::find(threads, zone.thread) != threads.end()) continue;
    const bool makes_frames = zone.parent < 0 && zone.name == frame_zone;
    threads.insert(makes_frames ? threads.begin() : threads.end(), zone.thread);
  }
  for (const std::string& thread : threads) add_rows(thread, -1, "", profile);
  return profile;
}

void add_repeats(const ZoneProfile& more, ZoneProfile& profile) {
  const std::vector<double> idle(profile.run.frames, 0.0);  // the times of a zone in repeats where it did not run
  for (const ZoneTimes& zone : more.zones) {
    const bool known = std::any_of(profile.zones.begin(), profile.zones.end(),
                                   [&](const ZoneTimes& z) { return z.thread == zone.thread && z.path == zone.path; });
    if (known) continue;
    ZoneTimes added{zone.thread, zone.path, 0};
    added.ms.assign(profile.repeats, idle);
    added.self_ms.assign(profile.repeats, idle);
    // The zone comes after those that lie in the same zone as it, so that parents stay before children.
    const std::string parent =
        zone.path.substr(0, zone.path.find_last_of('/') == std::string::npos ? 0 : zone.path.find_last_of('/'));
    const auto sibling = std::find_if(profile.zones.rbegin(), profile.zones.rend(), [&](const ZoneTimes& z) {
      return z.thread == zone.thread && (parent.empty() || z.path == parent || z.path.starts_with(parent + "/"));
    });
    profile.zones.insert(sibling.base() == profile.zones.begin() ? profile.zones.end() : sibling.base(),
                         std::move(added));
  }
  const int repeats = profile.repeats + more.repeats;
  for (ZoneTimes& zone : profile.zones) {
    const auto same = std::find_if(more.zones.begin(), more.zones.end(),
                                   [&](const ZoneTimes& z) { return z.thread == zone.thread && z.path == zone.path; });
    const bool ran = same != more.zones.end();
    zone.calls = (zone.calls * profile.repeats + (ran ? same->calls * more.repeats : 0)) / repeats;
    for (int repeat = 0; repeat < more.repeats; ++repeat) {
      zone.ms.push_back(ran ? same->ms[repeat] : idle);
      zone.self_ms.push_back(ran ? same->self_ms[repeat] : idle);
    }
  }
  for (SetupTimes& part : profile.setup) {
    for (const SetupTimes& other : more.setup) {
      if (other.name == part.name) part.ms.insert(part.ms.end(), other.ms.begin(), other.ms.end());
    }
  }
  profile.repeats = repeats;
}

}  // namespace supple
