// Makes bodies of the pieces of a surface: one body for each piece, with the settings of the table that names the
// surface.
#pragma once

#include "geometry/skins/surface_colors.h"
#include "geometry/solids/surface_pieces.h"
#include "scene/config/config.h"
#include "scene/definition/body_def.h"

namespace supple {

// Holds a surface as a scene's body uses it.
struct BodySurface {
  std::vector<SolidSurface> pieces;  // the largest first; those that are left out are not among them
  std::vector<SourceFile> sources;   // source of each piece
  std::vector<double> volumes;       // volume of each piece [m^3]
  std::vector<std::shared_ptr<const SurfaceColors>> colors;   // colours of each piece's skin; null: the file has none
  std::vector<std::shared_ptr<const SurfaceParts>> parts;     // named parts by skin; null: no handle asks for names
  std::vector<std::shared_ptr<const TextureCorners>> places;  // texture coordinates by skin; null: no handle has a mask
  std::vector<std::vector<std::string>> names;                // names of each part of the file
  std::string found;                                          // which colours the file has, in words; empty: none
  std::vector<std::string> notes;
  bool touching = false;  // whether parts of a piece are near each other without an overlap
  Bounds box;             // box of all that was read [m]
  Positions whole;        // the vertices of all pieces together
};

// Reads a surface and takes it apart into pieces, by the body's rule (Pieces). Throws InputError.
BodySurface read_body_surface(const BodyDef& body);

// Returns the body itself or, where its surface has several pieces, one body for each piece. These share the body's
// number of vertices by volume, and have its name with a number. The surfaces of a scene are read once for a Config and
// its copies. Problems are recorded in the table's Config.
std::vector<BodyDef> bodies_of(const ConfigTable& table, BodyDef body);

}  // namespace supple
