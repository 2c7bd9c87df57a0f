// Defines the module `supple._supple`. Its docstrings give shapes and units.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <fmt/format.h>

#include <thread>

#include "base/error.h"
#include "film/plan/shipped_files.h"
#include "model_face.h"
#include "output/files/png_file.h"
#include "output/video/video.h"
#include "world_face.h"

namespace supple::python {
namespace {

// Names a body of a world. It keeps the world.
struct BodyFace {
  std::shared_ptr<WorldFace> world;
  std::size_t index;
  std::string name;
};

void raise_input_error(const InputError& error) {
  const py::module_ package = py::module_::import("supple");
  const py::object kind = package.attr("InputError"), problem = package.attr("Problem");
  py::list problems;
  for (const Problem& one : error.problems())
    problems.append(problem(one.place.source, one.place.line, one.place.column, one.message));
  const py::object instance = kind(std::string(error.what()));
  instance.attr("problems") = problems;
  PyErr_SetObject(kind.ptr(), instance.ptr());
}

void raise_named(const char* name, const std::exception& error) {
  PyErr_SetString(py::object(py::module_::import("supple").attr(name)).ptr(), error.what());
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputError& error) {
    raise_input_error(error);
  } catch (const StepFailed& error) {
    raise_named("StepFailed", error);
  } catch (const RunError& error) {
    raise_named("RunError", error);
  } catch (const py::cast_error& error) {
    PyErr_SetString(PyExc_TypeError, error.what());
  }
}

// Makes a function of a member. An object that was not made by its __init__ has no holder, and is refused.
template <class Face, class Result, class... Arguments>
auto safe(Result (Face::*member)(Arguments...)) {
  return [member](const std::shared_ptr<Face>& self, Arguments... arguments) -> Result {
    return ((*self).*member)(std::forward<Arguments>(arguments)...);
  };
}
template <class Face, class Result, class... Arguments>
auto safe(Result (Face::*member)(Arguments...) const) {
  return [member](const std::shared_ptr<Face>& self, Arguments... arguments) -> Result {
    return ((*self).*member)(std::forward<Arguments>(arguments)...);
  };
}

py::array pixels_of(const Image& image) {
  const py::ssize_t channels = image.alpha.empty() ? 3 : 4, pixels = py::ssize_t(image.width) * image.height;
  py::array_t<std::uint8_t> array({py::ssize_t(image.height), py::ssize_t(image.width), channels});
  std::uint8_t* out = array.mutable_data();
  for (py::ssize_t i = 0; i < pixels; ++i) {
    for (int c = 0; c < 3; ++c) *out++ = image.rgb[std::size_t(3 * i + c)];
    if (channels == 4) *out++ = image.alpha[std::size_t(i)];
  }
  return array;
}

py::bytes png_of(const Image& image) {
  const std::vector<std::uint8_t> bytes = image.alpha.empty()
                                              ? png_bytes(image.width, image.height, image.rgb)
                                              : png_bytes(image.width, image.height, image.rgb, image.alpha);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::string> picture_settings(const py::object& camera, const py::object& size, const py::dict& set) {
  py::dict all;
  if (!camera.is_none()) all["camera"] = camera;
  if (!size.is_none()) {
    const auto [width, height] = size.cast<std::pair<int, int>>();
    all["output.width"] = width;
    all["output.height"] = height;
  }
  for (const auto& [path, value] : set) all[path] = value;
  return settings_of(all);
}

// Encodes a film of pictures. ffmpeg runs as long as the film is open.
class FilmFace {
 public:
  FilmFace(const py::object& path, double fps) : path_(path_of(path)), fps_(fps) {
    if (!(fps >= 0.001 && fps <= 1e6)) throw InputError("fps", "must be from 0.001 to 1000000");
    const std::string ending = path_.extension().string();
    const auto format = value_named<FilmFormat>(ending.empty() ? "" : ending.substr(1));
    if (!format || *format == FilmFormat::png) throw InputError(path_.string(), "a film ends in .mp4, .webm, .mov or .gif");
    coding_.format = *format;
  }

  void add(const py::array_t<std::uint8_t, py::array::c_style>& picture) {
    const Busy::Use use(busy_);
    if (thread_ != std::this_thread::get_id()) throw std::runtime_error("a film is made in one thread");
    if (closed_) throw std::runtime_error("the film is closed");
    if (picture.ndim() != 3 || picture.shape(2) != 3 || (encoder_ && size_ != size_of(picture)))
      throw InputError("picture", "must be an array of height x width x 3 bytes, as large as the first one");
    if (!encoder_) {
      size_ = size_of(picture);
      if (size_.first % 2 != 0 || size_.second % 2 != 0) throw InputError("picture", "width and height must be even");
      encoder_.emplace(path_, int(size_.second), int(size_.first), fps_, coding_);
    }
    const py::gil_scoped_release others_run;
    if (!encoder_->add({picture.data(), std::size_t(picture.size())})) end();
  }

  void close() {
    const Busy::Use use(busy_);
    if (thread_ != std::this_thread::get_id()) throw std::runtime_error("a film is made in one thread");
    if (!closed_ && !encoder_) warn(path_.string() + ": no picture was added, so there is no film");
    const py::gil_scoped_release others_run;
    if (!std::exchange(closed_, true) && encoder_) end();
  }

 private:
  static std::pair<py::ssize_t, py::ssize_t> size_of(const py::array& picture) {
    return {picture.shape(0), picture.shape(1)};
  }
  void end() {
    closed_ = true;
    const VideoResult result = encoder_->finish();
    encoder_.reset();
    if (result.outcome == VideoOutcome::written) return;
    throw RunError(fmt::format("{}: {} {}", path_.string(), result.reason, result.told));
  }

  Busy busy_;
  std::filesystem::path path_;
  double fps_;
  FilmCoding coding_;
  std::optional<VideoEncoder> encoder_;  // once there is a picture
  std::pair<py::ssize_t, py::ssize_t> size_;
  bool closed_ = false;
  std::thread::id thread_ = std::this_thread::get_id();
};

void define_world(py::module_& m) {
  py::class_<Snapshot, std::shared_ptr<Snapshot>>(m, "WorldState",
                                                  "A state of a world between two frames, for World.restore().")
      .def_property_readonly(
          "frame", [](const std::shared_ptr<Snapshot>& snapshot) { return snapshot->state.frames; },
          "Number of frames made.");
  py::class_<WorldFace, std::shared_ptr<WorldFace>>(m, "World", R"(A scene in time.

scene: the file of a scene, a replay or a model, the name of a scene that ships, or a dict that says what such a file
says. set: values in place of the scene's, by their paths, as --set takes them. threads: of the solver; 0: all cores.
Raises InputError with all that is wrong; a scene's warnings are given as SuppleWarning.)")
      .def(py::init<const py::object&, const py::dict&, int>(), py::arg("scene"), py::kw_only(),
           py::arg("set") = py::dict(), py::arg("threads") = 0)
      .def("step", safe(&WorldFace::step), py::arg("frames") = 1, py::kw_only(), py::arg("errors") = false,
           R"(Makes the steps of the next frames, 1 / fps seconds each.

errors: the last step of each frame is also solved to the end, so that error() knows how far off it was.
Other threads of Python run meanwhile. Raises StepFailed, and KeyboardInterrupt between two substeps; the next step()
then finishes the frame.)")
      .def_property_readonly("frame", safe(&WorldFace::frame), "Number of frames that were made.")
      .def_property_readonly("time", safe(&WorldFace::time), "Time after these frames [s].")
      .def_property_readonly("fps", safe(&WorldFace::fps), "Frames a second.")
      .def_property_readonly("report", safe(&WorldFace::report), R"(What the steps of the last frame know of themselves.

A dict with step_ms [ms], bodies (by name: milliseconds by phase, iterations, estimates of the errors, contacts; the
names are those of profile.json) and pairs (bodies that touch: contacts, depth [m], force of the first on the second
[N]).)")
      .def("error", safe(&WorldFace::error), R"(Returns how far the last step was from its solution, by body.

error: that of equation 12 of Liu et al. 2017, or None where the step began at its solution. motion_error: how far the
solved motion is, over the step's own motion. Raises RuntimeError unless step(errors=True) made the frame.)")
      .def_property_readonly("warnings", safe(&WorldFace::warnings), "What is legal but unwise in the scene, in words.")
      .def_property_readonly("live", safe(&WorldFace::live), "The paths of the values that set() can change.")
      .def_property_readonly(
          "bodies",
          [](const std::shared_ptr<WorldFace>& world) {
            py::dict bodies;
            std::size_t index = 0;
            for (const std::string& name : world->names()) bodies[name.c_str()] = BodyFace{world, index++, name};
            return bodies;
          },
          "The bodies by name, in the order of the scene.")
      .def("set", safe(&WorldFace::change), py::arg("path"), py::arg("value"), py::kw_only(), py::arg("over") = 0.0,
           py::arg("ease") = "smooth", py::arg("by") = "difference", py::arg("start") = py::none(),
           R"(Changes a value from the next frame on, as a [[change]] of a replay does.

path, value: as set in World(). over: how long the change takes [s]; 0: it jumps. ease: "smooth" or "linear". by:
"difference" or "ratio". start: where a ramp begins; else the value in force. Raises InputError; nothing changes then.)")
      .def("_grab", safe(&WorldFace::grab))
      .def("_move", safe(&WorldFace::move))
      .def("_release", safe(&WorldFace::release))
      .def("state", safe(&WorldFace::state), "Returns the state of the world, which restore() takes.")
      .def(
          "restore",
          [](const std::shared_ptr<WorldFace>& world, const std::shared_ptr<Snapshot>& state) {
            if (!state) throw py::type_error("state: None is no state");
            world->restore(*state);
          },
          py::arg("state"), R"(Goes back, or forward, to a state.

It may be of another world of the same scene. What was set and grabbed after it is forgotten.)")
      .def("hash", safe(&WorldFace::hash), "Returns the hash of all positions and velocities, as profile.json has it.")
      .def("save_replay", safe(&WorldFace::save_replay), py::arg("path"),
           R"(Writes all that was done to this world as a replay.

`supple replay` makes the same frames of it, to the last bit. A scene from a dict is written beside it.)")
      .def("_pixels", [](const std::shared_ptr<WorldFace>& world, const py::object& camera, const py::object& size,
                         const py::dict& set) { return pixels_of(world->draw(picture_settings(camera, size, set))); })
      .def("_png", [](const std::shared_ptr<WorldFace>& world, const py::object& camera, const py::object& size,
                      const py::dict& set) { return png_of(world->draw(picture_settings(camera, size, set))); });
  const auto array = [](py::array (WorldFace::*of)(std::size_t)) {
    return [of](const std::shared_ptr<BodyFace>& body) { return (*body->world.*of)(body->index); };
  };
  py::class_<BodyFace, std::shared_ptr<BodyFace>>(m, "Body",
                                                  "A body of a world. Rows are in the order of its mesh's vertices.")
      .def_property_readonly(
          "name", [](const std::shared_ptr<BodyFace>& body) { return body->name; }, "Its name in the scene.")
      .def_property_readonly(
          "world", [](const std::shared_ptr<BodyFace>& body) { return body->world; }, "The world that it is a part of.")
      .def_property_readonly("positions", array(&WorldFace::positions),
                             "Positions, n x 3 [m]: a view that always shows the present ones, read-only.")
      .def_property_readonly("velocities", array(&WorldFace::velocities), "Velocities, n x 3 [m/s]: a view like that.")
      .def_property_readonly("forces", array(&WorldFace::forces),
                             "Forces of contact at the end of the last step, n x 3 [N].")
      .def_property_readonly("rest", array(&WorldFace::rest), "Positions at rest, n x 3 [m].")
      .def_property_readonly("tetrahedra", array(&WorldFace::tetrahedra), "Vertices of the elements, m x 4.")
      .def_property_readonly("surface", array(&WorldFace::surface),
                             "Vertices of the triangles of the surface, m x 3, anticlockwise from outside.")
      .def_property_readonly("masses", array(&WorldFace::masses), "Mass of each vertex, n [kg].")
      .def_property_readonly(
          "deformation", [](const std::shared_ptr<BodyFace>& body) { return body->world->deformation(body->index); },
          "A dict with stretch (99.9th percentile), and numbers of inverted and collapsed elements.")
      .def(
          "field",
          [](const std::shared_ptr<BodyFace>& body, const std::string& name) {
            return body->world->field(body->index, name);
          },
          py::arg("quantity"), R"(Returns a quantity by vertex, n: "stretch", "compression", "volume", "energy" [J/m^3],
"stress" [Pa], "speed" [m/s], "depth" [m] or "force" [Pa].)");
}

void define_model(py::module_& m) {
  py::class_<CollidersFace, std::shared_ptr<CollidersFace>>(
      m, "Colliders", "Rigid obstacles: a list of dicts, each with the keys of [[collider]] in a scene.")
      .def(py::init<const py::list&>(), py::arg("colliders"));
  py::class_<StateFace, std::shared_ptr<StateFace>>(m, "State", "Where a model is. What is written counts.")
      .def_property_readonly("positions", safe(&StateFace::positions), "n x 3 [m], may be written.")
      .def_property_readonly("velocities", safe(&StateFace::velocities), "n x 3 [m/s], may be written.")
      .def_property_readonly("time", safe(&StateFace::time), "[s].");
  py::class_<ModelFace, std::shared_ptr<ModelFace>>(m, "Model", R"(A body made of arrays.

vertices: n x 3 [m]. tetrahedra: m x 4 vertices, counted from 0. material: what `material` of a scene's body is, the name
of a preset or a dict. density: [kg/m^3]; else the preset's, or 1000. time_step: [s]. pinned: vertices that follow
targets. pin_stiffness: of a spring at each of these [N/m]; None: they are held exactly. solver: keys of [solver].)")
      .def(py::init<const py::object&, const py::object&, const py::object&, const py::object&, double,
                    const py::object&, const py::object&, const py::dict&>(),
           py::arg("vertices"), py::arg("tetrahedra"), py::arg("material"), py::kw_only(),
           py::arg("density") = py::none(), py::arg("time_step") = 1.0 / 30, py::arg("pinned") = py::none(),
           py::arg("pin_stiffness") = py::none(), py::arg("solver") = py::dict())
      .def(
          "state",
          [](const std::shared_ptr<ModelFace>& model, int threads) {
            return std::make_shared<StateFace>(model, threads);
          },
          py::kw_only(), py::arg("threads") = 1, "Returns a state in which the body is at rest.")
      .def_property_readonly(
          "rest", [](const std::shared_ptr<ModelFace>& model) { return copy_of(model->rest); }, "n x 3 [m].")
      .def_property_readonly(
          "pinned", [](const std::shared_ptr<ModelFace>& model) { return model->pinned; }, "The pinned vertices.")
      .def_property_readonly(
          "time_step", [](const std::shared_ptr<ModelFace>& model) { return model->model.time_step; }, "[s].");
  m.def(
      "step",
      [](const std::shared_ptr<ModelFace>& model, const std::shared_ptr<StateFace>& state, const py::object& gravity,
         const std::shared_ptr<CollidersFace>& colliders, const py::object& targets) {
        if (!model || !state) throw py::type_error("model and state must not be None");
        return state->step(*model, gravity, colliders.get(), targets);
      },
      py::arg("model"), py::arg("state"), py::kw_only(), py::arg("gravity") = py::make_tuple(0.0, -9.81, 0.0),
      py::arg("colliders") = nullptr, py::arg("targets") = py::none(), R"(Makes a step of a model.

gravity: [m/s^2]. targets: where the pinned vertices are at the end of the step, in their order, k x 3 [m]; None: at
rest. Returns a dict: milliseconds, iterations, estimates of the errors, contacts. Raises StepFailed, which leaves the
state as it was.)");
}

}  // namespace
}  // namespace supple::python

PYBIND11_MODULE(_supple, m) {
  namespace python = supple::python;
  pybind11::register_exception_translator(python::translate);
  python::define_world(m);
  python::define_model(m);
  pybind11::class_<python::FilmFace, std::shared_ptr<python::FilmFace>>(
      m, "Film", "A film that is encoded while its pictures are made, by ffmpeg.")
      .def(pybind11::init<const pybind11::object&, double>(), pybind11::arg("path"), pybind11::arg("fps") = 30.0)
      .def("add", python::safe(&python::FilmFace::add), pybind11::arg("picture"),
           "Adds a picture, height x width x 3 bytes.")
      .def("close", python::safe(&python::FilmFace::close),
           "Ends the film and gives the file its name. Raises RunError.");
  m.def(
      "scenes", [] { return supple::shipped_names("scenes"); }, "Returns the names of the scenes that ship.");
  m.def(
      "replays", [] { return supple::shipped_names("replays"); }, "Returns the names of the replays that ship.");
}
