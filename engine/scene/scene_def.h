// A scene as its file describes it: plain nested structs with defaults, SI units, angles in degrees where the name says
// so. Nothing is built yet (assemble.h), and nothing here knows TOML.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/shape.h"
#include "sim/state.h"

namespace supple {

// A box, ball, half space or region that picks vertices of a body, in coordinates relative to its rest bounding box (0
// to 1 along each axis).
struct Selection {
  enum class Kind { region, box, sphere, plane } kind = Kind::box;
  std::string region;
  Vec3 lower = Vec3::Zero(), upper = Vec3::Ones();  // box
  Vec3 center = Vec3::Zero();                       // sphere; a point of the plane
  double radius = 0;                                // sphere; relative to the longest side
  Vec3 normal = Vec3::UnitY();                      // plane: picks the side that it points to
  Problem place;                                    // where it stands, for messages that come when the mesh is known
};

struct HandleKey {
  double time = 0;               // [s]
  Vec3 move = Vec3::Zero();      // from rest [m]
  Vec3 turn_deg = Vec3::Zero();  // about the handle's centre
};

enum class Ease { smooth, linear };

struct HandleDef {
  std::string name;
  Selection select;
  double spring = 0;  // 0: hard [N/m]
  Ease ease = Ease::smooth;
  std::vector<HandleKey> keys;
};

struct RegionDef {
  std::string name;
  Material material;
  Problem place;
};

struct BodyDef {
  std::string name;
  std::string label;
  // One of the two. A mesh file's regions are named by their reference numbers.
  std::filesystem::path shape;
  std::filesystem::path mesh;
  int vertices = 0;              // of the tetrahedra made from a shape
  std::optional<double> size;    // longest side; otherwise the file's units are metres [m]
  Vec3 position = Vec3::Zero();  // of the middle of the bounding box's bottom [m]
  Vec3 turn_deg = Vec3::Zero();
  std::optional<double> density;     // [kg/m^3]
  std::optional<double> total_mass;  // spread over the volume [kg]
  Material material;
  std::vector<RegionDef> regions;
  std::vector<HandleDef> handles;
  SolverSettings solver;
  StretchInterval fit;
  Precision precision = Precision::single_precision;
  std::optional<Vec3> color;  // over the shape's own [sRGB]
  double skin_cells = 0;      // cells of the drawn skin along the longest side
  Problem place;
};

struct CameraDef {
  std::optional<Vec3> position;  // [m]; without it the camera frames all bodies
  std::optional<Vec3> target;
  double fov_deg = 30;   // vertical
  double margin = 1.25;  // air around the bodies when they are framed
};

struct LookDef {
  Vec3 ground = Vec3(0.914, 0.894, 0.863);      // sRGB
  Vec3 background = Vec3(0.851, 0.871, 0.902);  // sRGB
  double exposure = 1;
  bool show_labels = true;
};

struct OutputDef {
  int width = 1280;
  int height = 720;
  int samples = 4;  // of antialiasing, a pixel
};

struct SceneDef {
  std::string name;  // of the file, without folder and ending
  std::string title;
  int frames = 120;
  double fps = 30;
  int substeps = 1;
  Vec3 gravity = Vec3(0, -9.81, 0);
  std::vector<BodyDef> bodies;
  CameraDef camera;
  LookDef look;
  OutputDef output;
  std::filesystem::path assets;

  double time_step() const { return 1 / (fps * substeps); }
};

}  // namespace supple
