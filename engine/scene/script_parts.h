// What a Script owns; only for script.cpp, which reads it, and script_check.cpp, which finds what is wrong with it.
#pragma once

#include <set>

#include "scene/script.h"

namespace supple {

constexpr double time_tolerance = 1e-9;          // of times that are given as seconds and counted in frames [s]
constexpr double at_start = 2 * time_tolerance;  // jumps at 0 are in force before the first frame [s]

struct Script::Parts {
  std::optional<Config> replay;
  Config scene_file;  // before any change
  SceneDef start;
  std::vector<TimedChange> changes;  // in the order of their beginnings
  std::vector<Problem> problems;     // of the replay, while it is read

  // The scene with the first `count` changes; one of them may be left out.
  Config document_at(double time, std::size_t count, std::optional<std::size_t> left_out = {}) const;
  bool at_work(const TimedChange& change, int frame) const;
  SceneDef read(Config& document) const;
  // Throws InputError when the scene cannot be read; what is wrong with the replay itself goes to `problems`.
  void read_replay(const std::filesystem::path& assets, const std::vector<std::string>& settings);

  // Puts a value of the replay into a document; false when its path leads nowhere, and then `problems` says so.
  bool put(Config& document, const std::string& path, const ConfigValue& value, const Problem& place);

  // All that is wrong with the changes. Those that are wrong are taken out, so that others can be looked at. Finds out
  // where ramps begin, and how the scene starts. Throws InputError with this and all earlier problems.
  void check_changes();

 private:
  struct Told {
    std::set<std::string> places, texts;
  };
  void tell(std::vector<Problem> more);
  void tell(Problem problem, const std::string& when, Told& told);
  void put_each();
  void prepare_ramps();
  std::vector<Problem> prepare(TimedChange& ramp, std::size_t index) const;
  void check_at(double time, const std::string& when, Told& told);
  std::optional<ConfigValue> value_at(const std::string& path, Config document) const;
};

// Tables that a scene may leave out, so that their keys are asked for too.
void open_tables(Config& document);

}  // namespace supple
