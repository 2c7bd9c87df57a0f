// Declares the readers and writers of mesh_file.h, one pair for each format. They check indices and numbers; what all
// formats have in common is checked in mesh_file.cpp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

struct RawMesh {
  TetMesh mesh;
  std::vector<int> lines;  // the line of each element in the file; empty where the format has none
  std::vector<std::string> notes;
};

inline constexpr long long largest_reference = 1'000'000;  // the largest region tag of an element

// Returns a file's text without a byte-order mark. Where all lines end with \r alone, they end with \n instead.
std::string mesh_text(const std::filesystem::path& path);

// Returns the note that so many elements with a volume were left out.
std::string left_out_note(long long elements);

RawMesh read_medit(std::string text, const std::string& name);
RawMesh read_gmsh(std::string text, const std::string& name);  // versions 2.2 and 4.1, as text
RawMesh read_legacy_vtk(std::string text, const std::string& name);
RawMesh read_vtu(std::string text, const std::string& name);
RawMesh read_tetgen(std::string nodes, const std::string& nodes_name, std::string elements,
                    const std::string& elements_name);

std::string medit_text(const TetMesh& mesh);
std::string gmsh_text(const TetMesh& mesh);  // version 4.1, with one volume for each region
std::string legacy_vtk_text(const TetMesh& mesh);
std::string vtu_text(const TetMesh& mesh);
std::string tetgen_nodes(const TetMesh& mesh);
std::string tetgen_elements(const TetMesh& mesh);

}  // namespace supple
