// Holds a drawn surface in OpenGL's memory: positions and normals that change each frame, and attributes that stay.
#pragma once

#include "render/draw_list.h"
#include "render/gl_table.h"

namespace supple {

struct MeshBuffers {
  GLuint array = 0, positions = 0, normals = 0, fixed = 0, indices = 0;
  GLsizei count = 0;
  std::size_t vertices = 0;
  std::vector<float> normal_data;
};

// Makes the buffers; positions and normals are uploaded later.
MeshBuffers make_mesh_buffers(const GlTable& gl, const DrawMesh& mesh);
void delete_mesh_buffers(const GlTable& gl, const MeshBuffers& mesh);

}  // namespace supple
