// What a film is told to do, frame by frame: a scene, and timed changes of its values (a replay). The scene of a frame
// is a function of its number alone, so that a film may go on anywhere.
#pragma once

#include "scene/live.h"
#include "scene/scene_def.h"

namespace supple {

// One value on its way to another.
struct TimedChange {
  std::string path;    // as --set takes it
  std::string object;  // name of the body or collider that it is of; empty: of the whole scene
  double at = 0;       // when it begins [s]
  double over = 0;     // how long it takes; 0: a jump [s]
  Ease ease = Ease::smooth;
  bool by_ratio = false;
  bool whole = false;  // only whole numbers on the way
  ChangeCost cost;
  std::optional<ConfigValue> from;  // of ramps
  ConfigValue to;
  Problem place;

  // How much of it is done at a time [s], 0 to 1; nothing while it has not begun.
  std::optional<double> done_at(double time) const;
};

class Script {
 public:
  // A scene's file, or a replay's: one that names its `scene`. Settings are --set's, over the scene as the film starts.
  // sweep_point: of the scene's sweep, which has as many. Throws InputError with all that is wrong at any time.
  static Script load(const std::filesystem::path& path, const std::filesystem::path& assets,
                     const std::vector<std::string>& settings, std::optional<std::size_t> sweep_point = {});
  Script(Script&&) noexcept;
  ~Script();

  bool is_replay() const;
  const SceneDef& scene() const;  // as the film starts
  const std::vector<TimedChange>& changes() const;

  // The changes that are at work between the start and the end of a frame.
  std::vector<const TimedChange*> at_work(int frame) const;
  // The scene at the end of a frame; its start when no change is at work.
  SceneDef scene_at(int frame) const;

  // What is legal and does nothing, or not all of what it says.
  std::vector<Problem> warnings() const;

  std::string scene_json() const;   // as the film starts
  std::string replay_json() const;  // the replay's own file; empty for a scene
  std::vector<LiveKey> live() const;

 private:
  struct Parts;
  explicit Script(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace supple
