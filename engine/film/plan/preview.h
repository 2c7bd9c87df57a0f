// Makes a scene cheaper, for a first look at it: pictures of a quarter of the width and height, and coarse meshes where
// the scene says how fine they are. Mesh files stay as they are. Every other frame is drawn, at half the rate; all are
// simulated, because fewer steps would move differently.
#pragma once

#include <string>
#include <vector>

namespace supple {

struct OutputDef;
struct SceneDef;

// Returns settings that replace those of the scene. share: roughly the share of its vertices that a solid keeps; 1
// leaves the meshes as they are.
std::vector<std::string> preview_settings(const SceneDef& scene, double share);

// Returns the settings that give the pictures of a scene this size [pixels].
std::vector<std::string> picture_settings(const OutputDef& output, int width, int height);

}  // namespace supple
