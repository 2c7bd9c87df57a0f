// Represents the input of a film, frame by frame: a scene, and timed changes of its values (a replay). The scene of a
// frame depends on the frame's number alone, so that a film can be resumed at any frame.
#pragma once

#include "scene/definition/scene_def.h"
#include "scene/reading/scene_source.h"
#include "scene/replay/live_keys.h"

namespace supple {

// Describes a change of one value while the film runs.
struct TimedChange {
  std::string path;    // as --set takes it
  std::string object;  // the name of the body or collider that the value belongs to; empty: the whole scene
  double at = 0;       // when the change begins [s]
  double over = 0;     // how long the change takes; 0: a jump [s]
  Ease ease = Ease::smooth;
  RampRule by = RampRule::difference;
  bool whole = false;  // the values of a ramp are rounded to whole numbers
  ChangeCost cost;
  std::optional<ConfigValue> from;  // where a ramp begins
  ConfigValue to;
  FilePlace place;

  // Returns the share of the change that is done at a time [s], 0 to 1, or nothing before the change begins.
  std::optional<double> done_at(double time) const;
};

// Returns all that these changes require to be recomputed for one body or collider.
ChangeCost cost_for(const std::string& name, const std::vector<TimedChange>& changes);

class Script {
 public:
  // Loads a scene file, or a replay, which is a file that names its `scene`. `settings` are those of --set and apply to
  // the scene at the start of the film. `sweep_point` is a point of the scene's sweep. Throws InputError with all that
  // is wrong at any time of the film.
  static Script load(const SceneSource& source, const std::filesystem::path& assets,
                     const std::vector<std::string>& settings, std::optional<std::size_t> sweep_point = {});
  Script(Script&&) noexcept;
  ~Script();

  bool is_replay() const;
  const SceneDef& scene() const;  // as the film starts
  const std::vector<TimedChange>& changes() const;

  // Returns the changes that alter a value between the start and the end of a frame.
  std::vector<const TimedChange*> at_work(int frame) const;
  // Returns the scene at the end of a frame. When no change is at work, this is also the scene at the start of the
  // frame.
  SceneDef scene_at(int frame) const;

  // Returns warnings about changes and handles that are legal but have no effect in this film, or less than they
  // specify.
  std::vector<Problem> warnings() const;

  std::string scene_json() const;   // as the film starts
  std::string replay_json() const;  // the file of the replay itself; empty for a scene
  std::vector<LiveKey> live() const;

 private:
  struct Parts;
  explicit Script(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace supple
