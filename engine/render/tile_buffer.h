// Draws tiles of the picture with the program in use.
#pragma once

#include <vector>

#include "render/gl_table.h"

namespace supple {

class TileBuffer {
 public:
  explicit TileBuffer(const GlTable& gl) : gl_(gl) {
    gl_.GenVertexArrays(1, &array_);
    gl_.BindVertexArray(array_);
    gl_.GenBuffers(1, &buffer_);
    gl_.BindBuffer(GL_ARRAY_BUFFER, buffer_);
    gl_.EnableVertexAttribArray(0);
    gl_.VertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, nullptr);
  }
  ~TileBuffer() {
    gl_.DeleteVertexArrays(1, &array_);
    gl_.DeleteBuffers(1, &buffer_);
  }
  TileBuffer(const TileBuffer&) = delete;
  TileBuffer& operator=(const TileBuffer&) = delete;

  // Draws triangles. corners: x y by corner, in clip coordinates, in the form that Tiles::corners() returns.
  void draw(const std::vector<float>& corners) const {
    gl_.BindVertexArray(array_);
    gl_.BindBuffer(GL_ARRAY_BUFFER, buffer_);
    gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(float)), corners.data(),
                   GL_STREAM_DRAW);
    gl_.DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size() / 2));
  }

 private:
  const GlTable& gl_;
  GLuint array_ = 0, buffer_ = 0;
};

}  // namespace supple
