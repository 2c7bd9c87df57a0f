// Reads the table [camera].
#include <fmt/core.h>

#include <algorithm>

#include "scene/reading/table_readers.h"

namespace supple {
namespace {

// Both the camera and its keys can give these values.
constexpr Key position = {"position", "m", "of the eye"};
constexpr Key target = {"target", "m", "what the eye looks at"};
constexpr Key azimuth = {"azimuth", "degrees",
                         "direction in which the eye stands: 0 in front (+z), 90 to the right (+x)"};
constexpr Key elevation = {"elevation", "degrees", "how high the eye stands above the target"};
constexpr Key how_far = {"distance", "m", "from the eye to the target"};
constexpr Key fov = {"fov_deg", "degrees", "vertical field of view"};
const Range azimuths = Range::between(-36000, 36000), elevations = Range::between(-89, 89),
            fields_of_view = Range::between(1, 150);

CameraKey read_key(const ConfigTable& row) {
  CameraKey key;
  key.time = row.number({"t", "s", "when"}, std::nullopt, Range::at_least(0));
  key.position = row.vector_if_given(position);
  key.target = row.vector_if_given(target);
  key.azimuth_deg = row.number_if_given(azimuth, azimuths);
  key.elevation_deg = row.number_if_given(elevation, elevations);
  key.distance = row.number_if_given(how_far, Range::positive());
  key.fov_deg = row.number_if_given(fov, fields_of_view);
  return key;
}

std::vector<CameraKey> read_camera_keys(const ConfigTable& table) {
  std::vector<CameraKey> keys;
  for (const ConfigTable& row :
       table.tables({"keys", "", "the camera's way: a value that a key does not give goes on to the next that does"})) {
    const CameraKey key = read_key(row);
    if (!keys.empty() && key.time <= keys.back().time)
      row.complain("t", fmt::format("t = {:g}: keys must stand in order of time (the one before is at {:g})", key.time,
                                    keys.back().time));
    keys.push_back(key);
  }
  return keys;
}

// Complains of values that say the same thing twice.
void check_together(const ConfigTable& table, const CameraDef& camera) {
  const auto any_key = [&camera](auto has) { return std::ranges::any_of(camera.keys, has); };
  const bool placed = camera.position || any_key([](const CameraKey& key) { return key.position.has_value(); });
  const bool around =
      table.has("azimuth") || table.has("elevation") || camera.distance || camera.orbit_deg != 0 ||
      any_key([](const CameraKey& key) { return key.azimuth_deg || key.elevation_deg || key.distance; });
  if (placed && around)
    table.complain("position",
                   "position: azimuth, elevation, distance and orbit say where the eye is, too: give one or "
                   "the others");
  const bool aimed = camera.target || any_key([](const CameraKey& key) { return key.target.has_value(); });
  if (!camera.follow.empty() && aimed)
    table.complain("follow", "follow: the eye looks at what it follows: leave target out");
  if (camera.position && camera.target && *camera.position == *camera.target)
    table.complain("target", "target: must not be the camera's own position");
}

void read_lens(const ConfigTable& table, CameraDef& camera) {
  camera.shutter_deg = table.number({"shutter", "degrees",
                                     "how much of the time since the frame before the shutter is open, of 360: what "
                                     "moves meanwhile is blurred; 180 is usual in films"},
                                    camera.shutter_deg, Range::between(0, 360));
  camera.aperture = table.number({"aperture", "m",
                                  "diameter of the lens: what is nearer or farther than the focus is blurred, at twice "
                                  "the focus's distance by half of this; 0: all is sharp"},
                                 camera.aperture, Range::between(0, 1e4));
  const auto focus = table.text_or_number_if_given(
      {"focus", "m", "what is sharp: a body or collider, by its middle, or a distance from the eye"},
      "the name of a body or collider", Range::positive(), "the target");
  if (!focus) return;
  if (const auto* name = std::get_if<std::string>(&*focus)) camera.focus_on = *name;
  if (const auto* distance = std::get_if<double>(&*focus)) camera.focus_distance = *distance;
}

}  // namespace

CameraDef read_camera(const ConfigTable& table, CameraDef camera) {
  camera.position = table.vector_if_given(position);
  camera.target = table.vector_if_given(target);
  camera.azimuth_deg = table.number(azimuth, camera.azimuth_deg, azimuths);
  camera.elevation_deg = table.number(elevation, camera.elevation_deg, elevations);
  camera.distance = table.number_if_given(how_far, Range::positive());
  camera.fov_deg = table.number(fov, camera.fov_deg, fields_of_view);
  camera.frames = table.word<Framed>(
      {"frames", "",
       "what is in the picture: the bodies as they start, or their whole motion, by a first pass; auto: their whole "
       "motion if they leave the picture of the start and nothing else places the camera"},
      camera.frames);
  if (camera.frames == Framed::film) camera.margin = CameraDef::margin_of_motion;
  camera.has_usual_margin = !table.has("margin");
  camera.margin = table.number({"margin", "",
                                "air around what is framed, which all is without position and distance; the default is "
                                "1.05 for the whole motion"},
                               camera.margin, Range::between(0.5, 10));
  camera.orbit_deg = table.number({"orbit", "degrees/s", "how fast the eye goes round the target"}, camera.orbit_deg,
                                  Range::between(-3600, 3600));
  camera.follow = table.text({"follow", "", "name of a body or collider with which eye and target move along"}, "");
  camera.ease = read_ease(table);
  camera.keys = read_camera_keys(table);
  read_lens(table, camera);
  check_together(table, camera);
  return camera;
}

}  // namespace supple
