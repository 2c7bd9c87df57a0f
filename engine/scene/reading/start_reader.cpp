// Reads the table `start` of a body.
#include <array>
#include <cmath>

#include "base/names.h"
#include "base/text.h"
#include "scene/definition/rotation.h"
#include "scene/definition/scene_def.h"
#include "scene/reading/table_readers.h"

namespace supple {
namespace {

StartDef read_stretched(const ConfigTable& table, const char* key) {
  return Stretched{table.vector(
      {key, "", "factors along x, y and z about the middle; negative ones turn it inside out"}, Vec3(1, 1, 1))};
}

StartDef read_rotated(const ConfigTable& table, const char* key) {
  const Vec3 degrees = table.vector({key, "degrees", "about x, then y, then z, around the middle"}, Vec3(0, 0, 0));
  return Rotated{rotation_from_degrees(degrees).toRotationMatrix()};
}

StartDef read_twisted(const ConfigTable& table, const char* key) {
  return Twisted{
      table.number({key, "degrees", "about the longest axis, from one end to the other"}, 0.0, Range::any())};
}

StartDef read_random(const ConfigTable& table, const char* key) {
  return Random{table.vector({key, "m", "extent of a box around the middle in which each vertex starts anywhere"},
                             Vec3(1, 1, 1), Range::at_least(0))};
}

enum class FlatForm { plane, line, point };

}  // namespace

template <>
struct Names<FlatForm> {
  static constexpr std::array table = {Name{FlatForm::plane, "plane"}, Name{FlatForm::line, "line"},
                                       Name{FlatForm::point, "point"}};
};

namespace {

StartDef read_flattened(const ConfigTable& table, const char* key) {
  const FlatForm form = table.word<FlatForm>(
      {key, "", "onto a level plane, a line along x or a point, through the middle"}, FlatForm::plane);
  const double along_x = form == FlatForm::point ? 0 : 1, along_z = form == FlatForm::plane ? 1 : 0;
  return Flattened{Vec3(along_x, 0, along_z)};
}

struct StartKey {
  const char* name;
  StartDef (*read)(const ConfigTable& table, const char* key);
};

constexpr std::array start_keys = {
    StartKey{"stretch", read_stretched}, StartKey{"turn_deg", read_rotated},  StartKey{"twist_deg", read_twisted},
    StartKey{"random", read_random},     StartKey{"flatten", read_flattened},
};

}  // namespace

std::optional<EarlierFrame> read_from(const ConfigTable& root, const FrameRate& fps) {
  const auto table = root.table({"from", "", "the frame of an earlier run with whose end this film begins"});
  if (!table) return std::nullopt;
  EarlierFrame from;
  from.run =
      table->text({"run", "", "folder of the run: bodies of the same name go on from where they were"}, std::nullopt);
  from.frame = table->integer({"frame", "", "of that run, counted from 0"}, std::nullopt, Range::between(0, 1000000));
  from.clock = table->number_if_given(
      {"clock", "s", "time at the end of that frame; filled in where it is not (frame + 1) / fps of this film"},
      Range::at_least(0));
  from.place = table->place("run");
  constexpr double least = 1e-6;  // share of a frame, far above round-off
  const double frames = from.clock.value_or(0) * fps;
  if (std::abs(frames - std::round(frames)) > least)
    table->complain(
        "clock", fmt::format("frame {} of {} ends at {:g} s, which is between two frames of this film, at {} a second: "
                             "choose another frame, or another fps",
                             from.frame, from.run.string(), *from.clock, fps.text()));
  return from;
}

StartDef read_start(const ConfigTable& body) {
  StartDef start = AtRest{};
  const auto table = body.table({"start", "", "where it starts, if not at rest: exactly one of the keys below"});
  if (!table) return start;
  int given = 0;
  std::vector<std::string> names;
  for (const StartKey& key : start_keys) {
    names.emplace_back(key.name);
    if (!table->has(key.name)) continue;
    ++given;
    start = key.read(*table, key.name);
  }
  if (given != 1) table->complain(fmt::format("a start is exactly one of {}", word_list(names)));
  return start;
}

}  // namespace supple
