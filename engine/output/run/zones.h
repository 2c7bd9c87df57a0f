// Holds where a film's time went, zone by zone and frame by frame, over repeats of the same run: collected from traces,
// stored as zones.json, and shown as a table. docs/profiling.md explains it to users.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/trace.h"

namespace supple {

// Describes what was run: the values that two profiles must have in common to be compared, and those that may differ.
struct ProfiledRun {
  std::string scene;                                        // its name
  std::string scene_json;                                   // as resolved after --set
  std::string replay_json;                                  // the file of a replay, else empty
  std::vector<std::pair<std::string, std::string>> meshes;  // body and XXH64
  int frames = 0;
  double fps = 0;
  int threads = 1;
  std::string pictures;  // what draws them; empty when none are drawn
  std::string cpu, kernels;
  std::string version, build;  // may differ
  std::string state_hash;      // of the last frame; may differ
};

// Holds the times of a zone, which is identified by all the zones that it lies in. Frames in which it did not run hold
// zeros.
struct ZoneTimes {
  std::string thread;                             // threads with the same task, such as workers, are summed
  std::string path;                               // "frame/step/iterate/direction"
  double calls = 0;                               // calls in a frame, on average
  std::vector<std::vector<double>> ms = {};       // by repeat, then by frame
  std::vector<std::vector<double>> self_ms = {};  // without the zones within

  int depth() const;
  std::string name() const;  // the last part of the path
};

// Holds the times of work that is done once, before the frames or after them.
struct SetupTimes {
  std::string name;
  std::vector<double> ms;  // by repeat
};

struct ZoneProfile {
  ProfiledRun run;
  int repeats = 0;
  std::vector<SetupTimes> setup;
  // The thread that makes the frames comes first: the frame as a whole, then what lies in it, parents before children.
  std::vector<ZoneTimes> zones;
};

// Collects repeats one by one; result() may be called once there is one.
class ZoneCollector {
 public:
  explicit ZoneCollector(ProfiledRun run);
  void add(const std::vector<ThreadTrace>& threads);
  const ProfiledRun& run() const { return profile_.run; }
  ZoneProfile result() const;

 private:
  struct Node {
    std::string thread, name;
    int parent;  // -1 when it has none
    long calls = 0;
    std::vector<std::vector<double>> ms, self_ms;
  };
  int node(const std::string& thread, int parent, const std::string& name);
  void add_thread(const ThreadTrace& thread, const std::vector<const TraceEvent*>& frames);
  void add_setup(const TraceEvent& event);
  void add_rows(const std::string& thread, int parent, const std::string& path, ZoneProfile& profile) const;

  ZoneProfile profile_;
  std::vector<Node> nodes_;  // parents before children
};

// Adds the repeats of another profile of the same run to this profile's.
void add_repeats(const ZoneProfile& more, ZoneProfile& profile);

// Writes and reads zones.json. Reading throws InputError with the name of the file when it cannot be read or is not
// such a text.
std::string zones_json(const ZoneProfile& profile);
ZoneProfile read_zones(const std::filesystem::path& path);

}  // namespace supple
