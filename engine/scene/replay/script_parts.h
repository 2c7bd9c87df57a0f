// Defines the parts that a Script owns. script.cpp reads it, script_check.cpp checks it, and script_writer.cpp writes
// it. live_keys.cpp uses table_of() alone; no other file includes this header.
#pragma once

#include <set>

#include "scene/config/config.h"
#include "scene/replay/script.h"

namespace supple {

// Times are given in seconds and counted in frames. They count as equal when they differ by less than this [s].
constexpr double time_tolerance = 1e-9;
// This time stands for the start of the film, when jumps at 0 have already taken effect [s].
constexpr double at_start = 2 * time_tolerance;

struct Script::Parts {
  SceneSource source;
  std::vector<std::string> settings;  // settings that were given beside the source
  std::optional<Config> replay;
  Config scene_file;  // the scene before any change
  SceneDef start;
  std::vector<TimedChange> changes;  // in the order of their beginnings
  std::vector<Problem> problems;     // problems of the replay, while it is read
  LiveEdits edits;                   // they are in scene_file and changes, too
  struct Unedited {
    Config scene_file;
    std::vector<TimedChange> changes;
  };
  std::optional<Unedited> unedited;        // what the edits are added to; nothing: there was no edit yet
  PlayedSession session;                   // what the replay holds of a live session
  std::vector<std::string> last_settings;  // settings that hold at any time, whatever changes (Script::with)

  // Returns the scene's document at a time, with the first `count` changes applied. One of them can be left out.
  Config document_at(double time, std::size_t count, std::optional<std::size_t> left_out = {}) const;
  bool at_work(const TimedChange& change, int frame) const;
  // Returns the time of the start of the film, when jumps at its beginning have already taken effect [s].
  double first_moment() const { return start.time_at_start() + at_start; }
  SceneDef read(Config& document) const;
  // Throws InputError when the scene cannot be read. Problems of the replay itself are added to `problems`.
  void read_replay(const std::filesystem::path& assets, const std::vector<std::string>& settings,
                   std::optional<std::size_t> sweep_point);

  // Puts a value of the replay into a document. When its path leads to nothing, returns false and adds to `problems`.
  bool put(Config& document, const std::string& path, const ConfigValue& value, const FilePlace& place);

  // Finds the values at which ramps begin, and all problems of the changes, also of the scene at the start. A change
  // that has a problem is removed, so that the others can still be checked. Throws InputError with all problems,
  // earlier ones too.
  void check_changes();

  // Adds a change of a film that is being made, and checks it in all frames from its beginning on.
  void add_change(TimedChange change);
  // Makes scene_file, changes and start from `unedited` and `edits`. Checks no more than the scene at the start. Throws
  // InputError.
  void apply_edits();

 private:
  // Holds the places and texts of the problems that have been reported, so that each is reported once.
  struct Reported {
    std::set<std::string> places, texts;
  };
  void add_problems(std::vector<Problem> more);
  void report(Problem problem, const std::string& when, Reported& reported);
  void put_each();
  void check_frames(int first, int end, Reported& reported);
  void prepare_ramps();
  std::vector<Problem> prepare(TimedChange& ramp, std::size_t index) const;
  void check_at(double time, const std::string& when, Reported& reported);
  std::optional<ConfigValue> value_at(const std::string& path, Config document) const;
};

// Returns a grab as [[grab]] of a replay has it.
Config document_of(const LiveGrab& grab);

// Adds the tables that a scene may omit, so that readers also ask for their keys.
void open_tables(Config& document);

// Returns the table that a path leads into; empty at the top.
std::string table_of(const std::string& path);

// Adds the table that a path leads into, where a scene may have such a table.
void open_table_of(Config& document, const std::string& path);

}  // namespace supple
