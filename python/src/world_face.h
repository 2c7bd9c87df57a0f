// Offers a World to Python: steps while other threads of Python run, views of its bodies, changes, pictures.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/solvers.h"
#include "film/pictures/world_pictures.h"
#include "film/record/world_errors.h"
#include "guard.h"
#include "output/run/profile.h"
#include "values.h"
#include "world/world.h"

namespace supple::python {

// Raises a SuppleWarning.
void warn(const std::string& text);

// Reports a step that failed.
class StepFailed : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Holds a state of a world, and tells of which scene it is.
struct Snapshot {
  WorldState state;
  std::uint64_t scene;   // hash of the scene that it is of
  bool foreign = false;  // whether it comes from a state of another scene
};

class WorldFace {
 public:
  // source: the file of a scene, replay or model, the name of one that ships, or a dict. threads: 0: all cores.
  WorldFace(const py::object& source, const py::dict& set, int threads);
  ~WorldFace();

  void step(int frames, bool errors);
  int frame();
  double time();
  double fps() { return locked()->world.scene().fps; }
  py::dict report();
  py::dict error();
  std::vector<std::string> warnings() const { return warnings_; }
  std::vector<std::string> live();

  void change(const std::string& path, const py::object& value, double over, const std::string& ease,
              const std::string& by, const py::object& start);
  std::string grab(const std::string& body, const py::object& vertices, double stiffness, std::string name);
  void move(const std::string& body, const std::string& handle, const py::object& move, const py::object& turn_deg);
  void release(const std::string& body, const std::string& handle) { locked()->world.release(body, handle); }

  Snapshot state() { return {whole()->world.state(), scene_, foreign_}; }
  void restore(const Snapshot& snapshot);
  std::uint64_t hash() { return locked()->world.hash(); }
  void save_replay(const py::object& path);
  Image draw(const std::vector<std::string>& settings);

  // Names the bodies in the order of the scene.
  std::vector<std::string> names();
  py::array positions(std::size_t body) { return view(body, &Views::x); }
  py::array velocities(std::size_t body) { return view(body, &Views::v); }
  py::array forces(std::size_t body);
  py::array field(std::size_t body, const std::string& quantity);
  py::array rest(std::size_t body) { return copy_of(of_scene(body).description.mesh.rest); }
  py::array tetrahedra(std::size_t body) { return copy_of(of_scene(body).description.mesh.tets); }
  py::array surface(std::size_t body) { return copy_of(surface_of(of_scene(body))); }
  py::array masses(std::size_t body);
  py::dict deformation(std::size_t body);

 private:
  struct Views {
    std::shared_ptr<Positions> x, v;
    py::object x_array, v_array;
  };
  // Holds all that must not be touched in a process that inherited it.
  struct Held {
    Threads threads;
    World world;
    FilmSolvers solvers = all_solvers();
    std::optional<WorldErrors> errors;
    std::unique_ptr<WorldPictures> pictures;

    Held(int thread_count, Script script, std::vector<Body> bodies)
        : threads(thread_count), world(std::move(script), std::move(bodies)) {}
    WorldPictures& drawn();
  };
  struct Lock {
    Busy::Use use;
    Held* held;
    Held* operator->() const { return held; }
  };
  Lock locked();
  Lock whole();  // throws std::runtime_error within a frame
  const Body& of_scene(std::size_t body) { return locked()->world.bodies().at(body); }
  py::array view(std::size_t body, std::shared_ptr<Positions> Views::*rows);
  void refresh();
  void take_frame(bool errors);

  Busy busy_;
  pid_t process_ = getpid();
  std::unique_ptr<Held> held_;
  std::vector<Views> views_;                             // by body
  std::vector<StepRow> rows_;                            // by body, of the last frame
  std::vector<int> contacts_;                            // by body
  std::vector<std::optional<MeasuredErrors>> measured_;  // by body; empty: not asked for
  std::vector<std::string> warnings_;
  std::vector<Eigen::Index> own_handled_;  // by body: how many vertices the scene's own handles hold
  std::vector<std::size_t> own_handles_;   // by body: how many handles the scene has, without added ones
  bool warned_ = false;                    // whether it was said that a step is not solved
  int grabs_ = 0;                          // how many were given names here
  std::uint64_t scene_ = 0;                // hash of the scene
  bool foreign_ = false;                   // the world goes on from a state of another scene
  bool failed_ = false;                    // whether a step has failed, until a state is restored
};

}  // namespace supple::python
