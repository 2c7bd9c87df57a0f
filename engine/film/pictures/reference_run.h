// Gives the positions of another run's bodies, with which a picture compares its own. Frames of both belong together by
// their number or, where one of the two goes on from an earlier run and both have the same rate, by the time on the
// clock.
#pragma once

#include <filesystem>
#include <vector>

#include "output/motion/point_cache.h"
#include "scene/building/assemble.h"

namespace supple {

struct SceneDef;

class ReferenceRun {
 public:
  // Opens the files of motion of a run. scene: of the pictures; bodies: of that scene. Throws InputError when the
  // folder is not a run's, and when a body has another number of vertices there.
  ReferenceRun(const std::filesystem::path& folder, const SceneDef& scene, const std::vector<Body>& bodies);

  // Returns where the body is in a frame of the scene, by vertex of its mesh [m]; after the run's last frame, where it
  // is in that one.
  Positions at(std::size_t body, int frame);
  // Throws InputError when the run does not have a frame of the scene.
  void require(int frame) const;

 private:
  std::filesystem::path folder_;
  int later_ = 0;                         // by how many frames the scene's clock starts later than that of the run
  std::vector<PointCacheReader> motion_;  // by body
  std::vector<Vec3> origin_;              // of the files of motion [m]
};

// Opens the runs with which a scene's pictures from one frame to another compare, so that a run that cannot be read or
// is too short is refused before anything is written. Throws InputError as ReferenceRun does.
void check_references(const SceneDef& scene, const std::vector<Body>& bodies, int first_frame, int last_frame);

}  // namespace supple
