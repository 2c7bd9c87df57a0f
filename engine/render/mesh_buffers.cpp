#include "render/mesh_buffers.h"

#include <array>

namespace supple {

void delete_mesh_buffers(const GlTable& gl, const MeshBuffers& mesh) {
  const GLuint buffers[] = {mesh.positions, mesh.normals, mesh.fixed, mesh.indices};
  gl.DeleteBuffers(4, buffers);
  gl.DeleteVertexArrays(1, &mesh.array);
}

MeshBuffers make_mesh_buffers(const GlTable& gl, const DrawMesh& mesh) {
  MeshBuffers buffers;
  buffers.vertices = mesh.occlusion.size();
  buffers.count = static_cast<GLsizei>(mesh.triangles.size());
  gl.GenVertexArrays(1, &buffers.array);
  gl.BindVertexArray(buffers.array);
  const auto attribute = [&](GLuint index, GLint size, GLsizei stride, std::size_t offset) {
    gl.EnableVertexAttribArray(index);
    gl.VertexAttribPointer(index, size, GL_FLOAT, GL_FALSE, stride, reinterpret_cast<const void*>(offset));
  };
  for (auto [buffer, index] : {std::pair{&buffers.positions, 0u}, {&buffers.normals, 1u}}) {
    gl.GenBuffers(1, buffer);
    gl.BindBuffer(GL_ARRAY_BUFFER, *buffer);
    gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(buffers.vertices * 3 * sizeof(float)), nullptr,
                  GL_STREAM_DRAW);
    attribute(index, 3, 0, 0);
  }
  std::vector<float> fixed;
  for (std::size_t v = 0; v < buffers.vertices; ++v) {
    fixed.push_back(mesh.occlusion[v]);
    fixed.insert(fixed.end(), mesh.paint[v].begin(), mesh.paint[v].end());
    const std::array<float, 2> square = mesh.square.empty() ? std::array<float, 2>{} : mesh.square[v];
    fixed.insert(fixed.end(), square.begin(), square.end());
  }
  gl.GenBuffers(1, &buffers.fixed);
  gl.BindBuffer(GL_ARRAY_BUFFER, buffers.fixed);
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(fixed.size() * sizeof(float)), fixed.data(), GL_STATIC_DRAW);
  constexpr GLsizei stride = 11 * sizeof(float);
  attribute(2, 1, stride, 0);
  attribute(3, 4, stride, sizeof(float));
  attribute(4, 4, stride, 5 * sizeof(float));
  attribute(5, 2, stride, 9 * sizeof(float));
  gl.GenBuffers(1, &buffers.indices);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers.indices);
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.triangles.size() * sizeof(std::uint32_t)),
                mesh.triangles.data(), GL_STATIC_DRAW);
  gl.BindVertexArray(0);
  return buffers;
}

}  // namespace supple
