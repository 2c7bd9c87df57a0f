// Writes small models with colours, as other programs leave them.
#pragma once

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "output/files/png_file.h"
#include "support/surfaces.h"
#include "support/text_file.h"

namespace supple::test {

// Returns a surface as an ASCII PLY file says it; color: three bytes of sRGB by vertex.
template <class Color>
std::string ply_text(const TriMesh& mesh, const Color& color) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      mesh.points.rows(), mesh.triangles.rows());
  for (Eigen::Index v = 0; v < mesh.points.rows(); ++v) {
    const Vec3 p = mesh.points.row(v);
    const std::array<int, 3> c = color(p);
    text += fmt::format("{} {} {} {} {} {}\n", p.x(), p.y(), p.z(), c[0], c[1], c[2]);
  }
  for (const auto& t : mesh.triangles.rowwise()) text += fmt::format("3 {} {} {}\n", t.x(), t.y(), t.z());
  return text;
}

// A ball whose texture goes once around it, from its south pole to the north: at u = 0 and u = 1 two places of the
// texture meet in one line of vertices.
struct TexturedBall {
  TriMesh mesh;                           // of places: the line is there once
  std::vector<std::array<double, 2>> uv;  // of corners, three a triangle
};

inline TexturedBall textured_ball(double radius, int around, int rings) {
  TexturedBall ball{sphere_surface(radius, around, rings), {}};
  for (Eigen::Index t = 0; t < ball.mesh.triangles.rows(); ++t) {
    double u[3], v[3];
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = ball.mesh.points.row(ball.mesh.triangles(t, k));
      u[k] = -std::atan2(p.z(), p.x()) / (2 * std::numbers::pi);
      u[k] -= std::floor(u[k] + 1e-9);
      v[k] = 0.5 + std::asin(std::clamp(p.y() / radius, -1.0, 1.0)) / std::numbers::pi;
    }
    const auto pole = [&](int k) { return v[k] < 1e-6 || v[k] > 1 - 1e-6; };
    double most = 0;
    for (int k = 0; k < 3; ++k) most = pole(k) ? most : std::max(most, u[k]);
    for (int k = 0; k < 3; ++k)
      if (!pole(k) && most - u[k] > 0.5) u[k] += 1;
    for (int k = 0; k < 3; ++k)
      if (pole(k)) u[k] = 0.5 * (u[(k + 1) % 3] + u[(k + 2) % 3]);
    for (int k = 0; k < 3; ++k) ball.uv.push_back({u[k], v[k]});
  }
  return ball;
}

inline std::string textured_obj(const TexturedBall& ball, const std::string& head) {
  std::string text = head;
  for (const auto& p : ball.mesh.points.rowwise()) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
  for (const auto& [u, v] : ball.uv) text += fmt::format("vt {} {}\n", u, v);
  for (Eigen::Index t = 0; t < ball.mesh.triangles.rows(); ++t) {
    text += "f";
    for (int k = 0; k < 3; ++k) text += fmt::format(" {}/{}", ball.mesh.triangles(t, k) + 1, 3 * t + k + 1);
    text += "\n";
  }
  return text;
}

// Makes a picture of squares whose red grows with u and whose green grows with v, with dark lines between them.
inline std::vector<std::uint8_t> squares_picture(int size, int squares) {
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const int i = x * squares / size, j = (size - 1 - y) * squares / size, edge = size / squares;
      const bool line = x % edge < edge / 8 || y % edge < edge / 8;
      const auto level = [&](int k) { return std::uint8_t(line ? 20 : 40 + 200 * k / (squares - 1)); };
      rgb.insert(rgb.end(), {level(i), level(j), std::uint8_t(line ? 20 : 90)});
    }
  }
  return rgb;
}

// Returns a GLB file of triangles with texture coordinates (v downward, as glTF has it), and a texture inside it.
inline std::string glb_text(const TriMesh& mesh, const std::vector<std::array<float, 2>>& uv, std::string picture,
                            const nlohmann::json& material) {
  const auto padded = [](std::string bytes, char with) {
    bytes.resize((bytes.size() + 3) / 4 * 4, with);
    return bytes;
  };
  const auto append = [](std::string& bytes, auto value) { bytes.append(reinterpret_cast<const char*>(&value), 4); };
  std::string places, coordinates, indices;
  for (const double x : mesh.points.reshaped<Eigen::RowMajor>()) append(places, float(x));
  for (const auto& [u, v] : uv) {
    append(coordinates, u);
    append(coordinates, v);
  }
  for (const std::int32_t v : mesh.triangles.reshaped<Eigen::RowMajor>()) append(indices, v);
  picture = padded(picture, '\0');
  const Vec3 low = mesh.points.colwise().minCoeff(), high = mesh.points.colwise().maxCoeff();
  nlohmann::json views = nlohmann::json::array();
  std::string binary;
  for (const std::string* part : {&places, &coordinates, &indices, &picture}) {
    views.push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", part->size()}});
    binary += *part;
  }
  const nlohmann::json text = {
      {"asset", {{"version", "2.0"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}}}},
      {"meshes",
       {{{"primitives", {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}, {"indices", 2}, {"material", 0}}}}}}},
      {"materials", {material}},
      {"textures", {{{"source", 0}}}},
      {"images", {{{"bufferView", 3}, {"mimeType", "image/png"}}}},
      {"accessors",
       {{{"bufferView", 0},
         {"componentType", 5126},
         {"count", mesh.points.rows()},
         {"type", "VEC3"},
         {"min", {low.x(), low.y(), low.z()}},
         {"max", {high.x(), high.y(), high.z()}}},
        {{"bufferView", 1}, {"componentType", 5126}, {"count", uv.size()}, {"type", "VEC2"}},
        {{"bufferView", 2}, {"componentType", 5125}, {"count", mesh.triangles.size()}, {"type", "SCALAR"}}}},
      {"bufferViews", views},
      {"buffers", {{{"byteLength", binary.size()}}}}};
  const std::string head = padded(text.dump(), ' ');
  std::string file = "glTF";
  append(file, std::uint32_t(2));
  append(file, std::uint32_t(12 + 8 + head.size() + 8 + binary.size()));
  append(file, std::uint32_t(head.size()));
  file += "JSON" + head;
  append(file, std::uint32_t(binary.size()));
  return file + std::string("BIN\0", 4) + binary;
}

}  // namespace supple::test
