// Represents the input of a film, frame by frame: a scene, and timed changes of its values (a replay). The scene of a
// frame depends on the frame's number alone, so that a film can be resumed at any frame.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "scene/definition/scene_def.h"
#include "scene/reading/scene_source.h"
#include "scene/replay/live_edits.h"
#include "scene/replay/played_session.h"

namespace supple {

// Holds the text of a replay, and that of its scene where no file has this scene.
struct ReplayFiles {
  std::string replay_text;
  std::filesystem::path scene;  // the file that scene_text is for; empty: the replay names a scene that exists
  std::string scene_text;
};

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
  // Returns what the live session that wrote this replay has noted; empty where no session wrote it.
  const PlayedSession& session() const;

  // Returns the changes that alter a value between the start and the end of a frame.
  std::vector<const TimedChange*> at_work(int frame) const;
  // Returns the scene at the end of a frame. When no change is at work, this is also the scene at the start of the
  // frame.
  SceneDef scene_at(int frame) const;

  // Returns warnings about changes and handles that are legal but have no effect in this film, or less than they
  // specify.
  std::vector<Problem> warnings() const;

  // The functions from here to set_edits() edit the film while it is made: a film of the replay that replay_files()
  // returns is the same to the last bit. They throw InputError with all that is wrong, and then change nothing.
  //
  // Adds a change as if the replay's file had it behind all others that begin at that time, which must be the beginning
  // of a frame. Fills in its object, its cost and, for a ramp, where it begins.
  void add(TimedChange change);
  // Adds a handle to a body, behind those that it has.
  void add(const LiveGrab& grab);
  // Ends a grab at a time [s], which must be later than its beginning.
  void end_grab(const std::string& body, const std::string& name, double until);
  const LiveEdits& edits() const;
  // Replaces all edits by those that were in force at another time. Throws InputError, and changes nothing, where they
  // are of another scene.
  void set_edits(LiveEdits edits);
  // Returns the replay with all edits, which `file` will have. frames: the length of its film; session: what the frames
  // so far have left. A file in the root folder names its scene with the whole path, so that it can be read anywhere.
  // Throws InputError where `file`, or the one beside it that the scene needs, is the scene that was loaded.
  ReplayFiles replay_files(const std::filesystem::path& file, int frames, const PlayedSession& session = {}) const;
  // Returns a copy of the script with settings, as --set takes them, that hold at any time, whatever changes. Throws
  // InputError.
  Script with(const std::vector<std::string>& settings) const;

  std::string scene_json() const;              // as the film starts
  std::string scene_json_at(int frame) const;  // at the end of a frame
  std::string replay_json() const;             // the file of the replay itself; empty for a scene
  // Lists what can change, with the values at the start of the film, or at the end of a frame.
  std::vector<LiveKey> live(std::optional<int> frame = {}) const;

 private:
  struct Parts;
  explicit Script(std::unique_ptr<Parts> parts);
  // Returns a replay with the name of the scene's file and with the settings in [set]; nothing where that does not give
  // the same scene.
  std::optional<std::string> with_the_scene_named(Config replay, const std::string& scene,
                                                  const std::filesystem::path& file) const;
  std::unique_ptr<Parts> parts_;
};

}  // namespace supple
