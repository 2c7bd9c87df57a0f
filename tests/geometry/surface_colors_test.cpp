// Tests the colours of surfaces from files: what each format says of them, what is missing or too large, and how they
// come along when a surface is repaired, refined and made coarser.
#include "geometry/skins/surface_colors.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "geometry/files/surface_file.h"
#include "geometry/skins/simplify.h"
#include "geometry/triangles/refine_surface.h"
#include "output/files/child_program.h"
#include "output/files/colored_obj.h"
#include "render/color.h"
#include "support/bodies.h"
#include "support/colored_files.h"

namespace supple {
namespace surface_colors_test {

class ColoredFiles : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    test::write_text(folder_.path / name, text);
    return folder_.path / name;
  }
  void write_squares(const std::string& name) const {
    write_png(folder_.path / name, 32, 32, test::squares_picture(32, 4));
  }
  std::string png() const {
    const std::vector<std::uint8_t> bytes = png_bytes(32, 32, test::squares_picture(32, 4));
    return {bytes.begin(), bytes.end()};
  }
  // A ball with a texture of this name, and what its materials say.
  ColoredSurface ball_with(const std::string& materials) const {
    write("ball.mtl", materials);
    return read_colored_surface(
        write("ball.obj", test::textured_obj(test::textured_ball(1, 12, 6), "mtllib ball.mtl\nusemtl skin\n")));
  }
  test::TemporaryFolder folder_;
};

void expect_color(const SurfaceColor& found, double red, double green, double blue) {
  EXPECT_NEAR(found.red, red, 1e-4);
  EXPECT_NEAR(found.green, green, 1e-4);
  EXPECT_NEAR(found.blue, blue, 1e-4);
}

TEST_F(ColoredFiles, NamesOfTexturesAreToldAsTheyAreWritten) {
  write_squares("t\xc3\xbcr.png");
  EXPECT_EQ(ball_with("newmtl skin\nmap_Kd t\xc3\xbcr.png\n").found, "1 material, texture 't\xc3\xbcr.png' of 32 x 32");
  const ColoredSurface lost = ball_with("newmtl skin\nmap_Kd v\xc3\xb6llig-\x1b[2J.png\n");
  ASSERT_FALSE(lost.remarks.empty());
  EXPECT_NE(lost.remarks.front().find("v\xc3\xb6llig-\\x1b[2J.png"), std::string::npos) << lost.remarks.front();
}

TEST_F(ColoredFiles, VerticesOfAPlyFileHaveTheirColoursInLinearLight) {
  const TriMesh box = test::box_surface(Vec3(1, 2, 3));
  const ColoredSurface read =
      read_colored_surface(write("box.ply", test::ply_text(box, [](const Vec3& p) {
                                   return std::array{p.x() > 0 ? 255 : 0, p.y() > 0 ? 128 : 0, 10};
                                 })));
  ASSERT_EQ(std::ssize(read.colors), read.mesh.points.rows());
  for (Eigen::Index v = 0; v < read.mesh.points.rows(); ++v)
    expect_color(read.colors[std::size_t(v)], read.mesh.points(v, 0) > 0 ? 1 : 0,
                 read.mesh.points(v, 1) > 0 ? linear_of(128 / 255.0) : 0, linear_of(10 / 255.0));
  EXPECT_EQ(read.found, "of vertices");
  EXPECT_EQ(read.textures, nullptr);
  EXPECT_TRUE(read.remarks.empty());
}

TEST_F(ColoredFiles, AnObjFileHasTheMaterialsAndTheTextureBesideIt) {
  write_squares("squares.png");
  const test::TexturedBall ball = test::textured_ball(1, 12, 6);
  std::string text = test::textured_obj(ball, "mtllib ball.mtl\nusemtl skin\n");
  text += "usemtl red\n" + std::string("v 5 0 0\nv 6 0 0\nv 5 1 0\nf -3 -2 -1\n");
  write("ball.mtl", "newmtl skin\nKd 0 0 0\nmap_Kd squares.png\nnewmtl red\nKd 0.5 0 0\n");
  const ColoredSurface read = read_colored_surface(write("ball.obj", text));
  ASSERT_TRUE(read.textures);
  ASSERT_EQ(read.textures->size(), 1u);
  EXPECT_EQ((*read.textures)[0].rgb, test::squares_picture(32, 4));
  EXPECT_EQ((*read.textures)[0].name, "squares.png");
  EXPECT_EQ(read.found, "2 materials, texture 'squares.png' of 32 x 32");
  EXPECT_TRUE(read.remarks.empty());
  int textured = 0, red = 0;
  for (Eigen::Index v = 0; v < read.mesh.points.rows(); ++v) {
    const SurfaceColor& color = read.colors[std::size_t(v)];
    const Vec3 p = read.mesh.points.row(v);
    if (p.x() > 4) {
      expect_color(color, linear_of(0.5), 0, 0);
      EXPECT_EQ(color.texture, -1);
      ++red;
      continue;
    }
    expect_color(color, 1, 1, 1);  // the black of the material is not seen through the texture
    EXPECT_EQ(color.texture, 0);
    EXPECT_NEAR(color.v, 0.5 + std::asin(p.y()) / std::numbers::pi, 1e-5);
    ++textured;
  }
  EXPECT_EQ(red, 3);
  EXPECT_EQ(textured, 3 * ball.mesh.triangles.rows());
}

TEST_F(ColoredFiles, AGlbFileHasItsTextureInsideAndItsFactorIsLinear) {
  const TriMesh box = test::box_surface(Vec3(1, 1, 1));
  std::vector<std::array<float, 2>> uv;
  for (const auto& p : box.points.rowwise()) uv.push_back({float(p.x() > 0), p.y() > 0 ? 0.25f : 0.75f});
  const nlohmann::json material = {
      {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"baseColorFactor", {0.5, 0.25, 1, 1}}}}};
  const ColoredSurface read = read_colored_surface(write("box.glb", test::glb_text(box, uv, png(), material)));
  ASSERT_TRUE(read.textures);
  EXPECT_EQ(read.textures->front().rgb, test::squares_picture(32, 4));
  EXPECT_EQ(read.textures->front().wrap_u, Wrap::repeat);
  for (Eigen::Index v = 0; v < read.mesh.points.rows(); ++v) {
    const SurfaceColor& color = read.colors[std::size_t(v)];
    expect_color(color, 0.5, 0.25, 1);
    EXPECT_FLOAT_EQ(color.u, read.mesh.points(v, 0) > 0 ? 1 : 0);
    EXPECT_FLOAT_EQ(color.v, read.mesh.points(v, 1) > 0 ? 0.75 : 0.25);  // counted from below
  }
  EXPECT_TRUE(read.remarks.empty()) << read.remarks.front();
}

TEST_F(ColoredFiles, AColladaFileHasAJpegBesideIt) {
  const auto made = run_program({"ffmpeg", "-v", "error", "-f", "lavfi", "-i", "color=c=0x2060c0:s=24x16", "-frames:v",
                                 "1", "-y", (folder_.path / "blue sky.jpg").string()});
  ASSERT_TRUE(made && made->status == 0);
  const std::string text = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>Y_UP</up_axis></asset>
<library_images><image id="img"><init_from>blue%20sky.jpg</init_from></image></library_images>
<library_effects><effect id="fx"><profile_COMMON>
<newparam sid="s"><surface type="2D"><init_from>img</init_from></surface></newparam>
<newparam sid="t"><sampler2D><source>s</source></sampler2D></newparam>
<technique sid="common"><lambert><diffuse><texture texture="t" texcoord="UV"/></diffuse></lambert></technique>
</profile_COMMON></effect></library_effects>
<library_materials><material id="mat"><instance_effect url="#fx"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common>
<accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<source id="u"><float_array id="ua" count="8">0 0 1 0 0 1 0.5 0.5</float_array><technique_common>
<accessor source="#ua" count="4" stride="2"><param name="S" type="float"/><param name="T" type="float"/>
</accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4" material="m"><input semantic="VERTEX" source="#v" offset="0"/>
<input semantic="TEXCOORD" source="#u" offset="1" set="0"/>
<p>0 0 2 2 1 1 0 0 1 1 3 3 0 0 3 3 2 2 1 1 2 2 3 3</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="vs"><node id="n"><instance_geometry url="#g"><bind_material>
<technique_common><instance_material symbol="m" target="#mat"><bind_vertex_input semantic="UV"
input_semantic="TEXCOORD" input_set="0"/></instance_material></technique_common></bind_material></instance_geometry>
</node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#vs"/></scene></COLLADA>
)";
  const ColoredSurface read = read_colored_surface(write("t.dae", text));
  ASSERT_TRUE(read.textures) << (read.remarks.empty() ? "" : read.remarks.front());
  const Texture& texture = read.textures->front();
  EXPECT_EQ(texture.width, 24);
  EXPECT_EQ(texture.height, 16);
  const int expected[] = {0x20, 0x60, 0xc0};
  for (std::size_t i = 0; i < texture.rgb.size(); ++i) EXPECT_NEAR(texture.rgb[i], expected[i % 3], 6);
  for (Eigen::Index v = 0; v < read.mesh.points.rows(); ++v) {
    const Vec3 p = read.mesh.points.row(v);
    if (p.z() > 0.5) continue;  // its place in the texture is the middle
    EXPECT_FLOAT_EQ(read.colors[std::size_t(v)].u, p.x() > 0.5 ? 1 : 0);
    EXPECT_FLOAT_EQ(read.colors[std::size_t(v)].v, p.y() > 0.5 ? 1 : 0);
  }
}

TEST_F(ColoredFiles, FilesWithoutColoursHaveNone) {
  const TriMesh box = test::box_surface(Vec3(1, 1, 1));
  for (const auto& path :
       {write("plain.obj", test::obj_text(box)), write("plain.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
        write("plain.stl",
              "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
              "endloop\nendfacet\nendsolid s\n")}) {
    const ColoredSurface read = read_colored_surface(path);
    EXPECT_TRUE(read.colors.empty()) << path;
    EXPECT_EQ(read.found, "") << path;
    EXPECT_TRUE(read.remarks.empty()) << path;
    EXPECT_EQ(colors_on(read.mesh, read), nullptr);
  }
}

TEST_F(ColoredFiles, WhatIsMissingOrBrokenIsNamedAndTheBaseColourIsDrawn) {
  const std::string material = "newmtl skin\nKd 1 0 0\nmap_Kd squares.png\n";
  const auto expect_base = [](const ColoredSurface& read, const std::string& remark) {
    ASSERT_EQ(read.remarks.size(), 1u) << remark;
    EXPECT_NE(read.remarks[0].find(remark), std::string::npos) << read.remarks[0];
    EXPECT_EQ(read.textures, nullptr);
    ASSERT_FALSE(read.colors.empty());
    expect_color(read.colors[0], 1, 0, 0);
    EXPECT_EQ(read.colors[0].texture, -1);
  };
  expect_base(ball_with(material), "texture 'squares.png' is missing: there is no such file beside the model");
  write("squares.png", "");
  expect_base(ball_with(material), "is neither PNG, JPEG, TGA nor BMP");
  write("squares.png", "GIF89a and so on");
  expect_base(ball_with(material), "is neither PNG, JPEG, TGA nor BMP");
  for (const std::size_t cut : {5u, 20u, 40u, 90u, 130u}) {
    ASSERT_LT(cut, png().size());
    write("squares.png", png().substr(0, cut));
    expect_base(ball_with(material), "PNG");
  }
  write("squares.png", "\xff\xd8\xff\xe0 and so on");
  expect_base(ball_with(material), "is a damaged JPEG");
  // The head alone says that it is large: 30000 x 30000 pixels, with the check sum of such a head.
  std::string large = png().substr(0, 16) + std::string("\0\0\x75\x30\0\0\x75\x30\x08\x02\0\0\0\xe9\x45\x6f\xed", 17);
  write("squares.png", large + png().substr(33));
  expect_base(ball_with(material), "has 30000 x 30000 pixels");
}

// Four pixels in two rows, the lower one first: blue, green; red, white.
const std::string bgr_pixels("\xff\0\0\0\xff\0\0\0\xff\xff\xff\xff", 12);
const std::vector<std::uint8_t> rgb_pixels = {255, 0, 0, 255, 255, 255, 0, 0, 255, 0, 255, 0};

std::string tga_head(char kind) {
  return std::string("\0\0", 2) + kind + std::string("\0\0\0\0\0\0\0\0\0\2\0\2\0\x18\0", 15);
}

std::string bmp_bytes() {
  const std::string head("BM\x46\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\2\0\0\0\2\0\0\0\1\0\x18\0", 30);
  const std::string rest(24, '\0'), pad(2, '\0');  // rows are filled up to four bytes
  return head + rest + bgr_pixels.substr(0, 6) + pad + bgr_pixels.substr(6) + pad;
}

TEST_F(ColoredFiles, TexturesMayBeTgaOrBmp) {
  const std::string runs = std::string("\1", 1) + bgr_pixels.substr(0, 6) + std::string("\x80", 1) +
                           bgr_pixels.substr(6, 3) + std::string("\x80", 1) + bgr_pixels.substr(9);
  const struct {
    const char* name;
    std::string bytes;
  } cases[] = {{"plain.tga", tga_head(2) + bgr_pixels}, {"runs.tga", tga_head(10) + runs}, {"plain.bmp", bmp_bytes()}};
  for (const auto& [name, bytes] : cases) {
    const std::string material = std::string("newmtl skin\nKd 1 0 0\nmap_Kd ") + name + "\n";
    write(name, bytes);
    const ColoredSurface read = ball_with(material);
    EXPECT_TRUE(read.remarks.empty()) << name << ": " << read.remarks[0];
    ASSERT_TRUE(read.textures) << name;
    EXPECT_EQ(read.textures->front().width, 2) << name;
    EXPECT_EQ(read.textures->front().rgb, rgb_pixels) << name;
    for (const std::size_t missing : {std::size_t(3), std::size_t(7), bytes.size() - 17}) {
      write(name, bytes.substr(0, bytes.size() - missing));
      const ColoredSurface cut = ball_with(material);
      ASSERT_EQ(cut.remarks.size(), 1u) << name << " without " << missing;
      EXPECT_EQ(cut.textures, nullptr) << name << " without " << missing;
    }
  }
  std::string large = tga_head(2);
  large[13] = large[15] = '\x7f';
  write("plain.tga", large + bgr_pixels);
  EXPECT_EQ(ball_with("newmtl skin\nmap_Kd plain.tga\n").remarks.at(0).find("texture 'plain.tga' has 32514 x 32514"),
            0u);
}

TEST_F(ColoredFiles, MissingMaterialsAndTransparencyAreNamed) {
  write("ball.obj", test::textured_obj(test::textured_ball(1, 12, 6), "mtllib gone.mtl\nusemtl skin\n"));
  const ColoredSurface bare = read_colored_surface(folder_.path / "ball.obj");
  ASSERT_EQ(bare.remarks.size(), 1u);
  EXPECT_EQ(bare.remarks[0], "its materials are missing: there is no file 'gone.mtl' beside it");
  EXPECT_TRUE(bare.colors.empty());
  std::vector<std::uint8_t> alpha(32 * 32, 255);
  alpha[17] = 9;
  const std::vector<std::uint8_t> bytes = png_bytes(32, 32, test::squares_picture(32, 4), alpha);
  write("squares.png", {bytes.begin(), bytes.end()});
  const ColoredSurface clear = ball_with("newmtl skin\nd 0.4\nmap_Kd squares.png\n");
  ASSERT_TRUE(clear.textures);
  EXPECT_EQ(clear.textures->front().rgb, test::squares_picture(32, 4));
  EXPECT_EQ(clear.remarks, (std::vector<std::string>{"transparency of texture 'squares.png' is not drawn",
                                                     "transparency of its materials is not drawn"}));
}

TEST_F(ColoredFiles, ATextureIsFoundByItsNameBesideAModelFromAnotherMachine) {
  write_squares("squares.png");
  const ColoredSurface read = ball_with("newmtl skin\nmap_Kd C:\\Users\\somebody\\squares.png\n");
  EXPECT_TRUE(read.remarks.empty());
  EXPECT_TRUE(read.textures);
}

// The colour is a linear function of the place, so that it is known everywhere.
ColoredSurface with_known_colors(const TriMesh& mesh) {
  ColoredSurface file{mesh, {}, nullptr, {}, {}, {}, "of vertices"};
  for (const auto& p : mesh.points.rowwise())
    file.colors.push_back({float(0.5 + 0.1 * p.x()), float(0.5 + 0.1 * p.y()), float(0.5 + 0.1 * p.z())});
  return file;
}

double error_of(const SurfaceColor& color, const Vec3& p) {
  return Vec3(color.red - 0.5 - 0.1 * p.x(), color.green - 0.5 - 0.1 * p.y(), color.blue - 0.5 - 0.1 * p.z())
      .cwiseAbs()
      .maxCoeff();
}

double largest_error(const TriMesh& surface, const SurfaceColors& colors) {
  double worst = 0;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k)
      worst = std::max(worst, error_of(colors.corners[std::size_t(t)][std::size_t(k)],
                                       surface.points.row(surface.triangles(t, k)).transpose()));
  return worst;
}

TEST(SurfaceColors, ComeAlongWhenASurfaceIsRepaired) {
  const TriMesh ball = test::sphere_surface(1, 24, 12);
  const ColoredSurface file = with_known_colors(test::without_triangle(test::inside_out(ball), 100));
  for (const Closing close : {Closing::caps, Closing::winding}) {
    SurfaceOptions options;
    options.close = close;
    const SolidSurface solid = solid_surface(file.mesh, options, "ball", nullptr);
    const auto colors = colors_on(solid.skin(), file);
    ASSERT_TRUE(colors);
    ASSERT_EQ(std::ssize(colors->corners), solid.skin().triangles.rows());
    // What closes the hole has the colours of its rim, which is a tenth of the ball away at most.
    EXPECT_LT(largest_error(solid.skin(), *colors), 0.04) << name_of(close);
    EXPECT_LT(largest_error(file.mesh, *colors_on(file.mesh, file)), 1e-6);
  }
  SurfaceOptions thick;
  thick.thickness = 0.02;
  const SolidSurface shell = solid_surface(file.mesh, thick, "ball", nullptr);
  EXPECT_LT(largest_error(shell.skin(), *colors_on(shell.skin(), file)), 0.01);
}

TEST(SurfaceColors, AreLinearWithinTheTrianglesThatAreRefined) {
  const TriMesh box = test::box_surface(Vec3(1, 2, 3));
  const ColoredSurface file = with_known_colors(box);
  const Skin skin = colored_skin(box, *colors_on(box, file), 0.4, 100000, 0.5);
  EXPECT_GT(skin.rest.triangles.rows(), 500);
  ASSERT_EQ(std::ssize(skin.color), skin.rest.points.rows());
  ASSERT_EQ(std::ssize(skin.smooth), skin.rest.points.rows());
  ASSERT_EQ(std::ssize(skin.square), skin.rest.points.rows());
  for (Eigen::Index v = 0; v < skin.rest.points.rows(); ++v)
    EXPECT_LT(error_of(skin.color[std::size_t(v)], skin.rest.points.row(v).transpose()), 1e-6);
  // Without a border of colours no vertex is split but by creases, as without colours.
  std::vector<std::int32_t> vertex_of;
  const TriMesh fine = refined(box, 0.4, 100000).mesh;
  const Skin plain = skin_of_surface(fine.points, fine.triangles, 0.5, vertex_of);
  EXPECT_EQ(skin.rest.points.rows(), plain.rest.points.rows());
  EXPECT_EQ(skin.rest.triangles.rows(), plain.rest.triangles.rows());
}

TEST(SurfaceColors, VerticesAreSplitWhereATextureBeginsAndKeepOneNormal) {
  const test::TexturedBall ball = test::textured_ball(1, 16, 8);
  SurfaceColors colors;
  for (std::size_t i = 0; i < ball.uv.size(); i += 3) {
    std::array<SurfaceColor, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = {1, 1, 1, 0, float(ball.uv[i + k][0]), float(ball.uv[i + k][1])};
    colors.corners.push_back(corners);
  }
  const Skin skin = colored_skin(ball.mesh, colors, 0.2, 100000, 0);
  std::map<std::array<double, 3>, std::vector<std::int32_t>> at;  // by place: its vertices
  for (std::int32_t v = 0; v < skin.rest.points.rows(); ++v)
    at[{skin.rest.points(v, 0), skin.rest.points(v, 1), skin.rest.points(v, 2)}].push_back(v);
  int split = 0;
  for (const auto& [place, vertices] : at) {
    for (const std::int32_t v : vertices) EXPECT_EQ(skin.smooth[std::size_t(v)], skin.smooth[std::size_t(vertices[0])]);
    const bool on_line = std::abs(place[2]) < 1e-9 && place[0] > 0;  // u = 0 and u = 1
    const bool by_pole = std::abs(place[1]) > 0.93;  // there, each triangle has a place in the texture of its own
    if (by_pole) continue;
    EXPECT_EQ(vertices.size(), on_line ? 2u : 1u) << place[0] << ' ' << place[1] << ' ' << place[2];
    split += vertices.size() > 1 ? 1 : 0;
  }
  EXPECT_GT(split, 10);
}

TEST_F(ColoredFiles, AColouredSkinIsWrittenAsObjWithItsTextures) {
  const test::TexturedBall ball = test::textured_ball(1, 12, 6);
  SurfaceColors colors;
  colors.textures = std::make_shared<std::vector<Texture>>(
      1, Texture{"squares", 32, 32, Wrap::repeat, Wrap::repeat, test::squares_picture(32, 4)});
  for (std::size_t i = 0; i < ball.uv.size(); i += 3)
    colors.corners.push_back({SurfaceColor{1, 1, 1, 0, float(ball.uv[i][0]), float(ball.uv[i][1])},
                              SurfaceColor{1, 1, 1, 0, float(ball.uv[i + 1][0]), float(ball.uv[i + 1][1])},
                              SurfaceColor{1, 1, 1, 0, float(ball.uv[i + 2][0]), float(ball.uv[i + 2][1])}});
  const Skin skin = colored_skin(ball.mesh, colors, 1, 100000, 0);
  write_colored_obj(folder_.path / "skin.obj",
                    {skin.rest.points, skin.rest.triangles, skin.color, colors.textures.get()});
  const ColoredSurface read = read_colored_surface(folder_.path / "skin.obj");
  EXPECT_TRUE(read.remarks.empty()) << read.remarks.front();
  ASSERT_TRUE(read.textures);
  EXPECT_EQ(read.textures->front().rgb, test::squares_picture(32, 4));
  ASSERT_EQ(read.mesh.triangles.rows(), skin.rest.triangles.rows());
  for (Eigen::Index t = 0; t < read.mesh.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const SurfaceColor &found = read.colors[std::size_t(read.mesh.triangles(t, k))],
                         &expected = skin.color[std::size_t(skin.rest.triangles(t, k))];
      EXPECT_NEAR(found.u, expected.u, 1e-6);
      EXPECT_NEAR(found.v, expected.v, 1e-6);
    }
  }
}

// A flat sheet, on which no shape keeps a triangle from being removed.
Skin sheet(int cells) {
  Skin skin;
  skin.rest.points.resize((cells + 1) * (cells + 1), 3);
  skin.rest.triangles.resize(2 * cells * cells, 3);
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i)
      skin.rest.points.row(j * (cells + 1) + i) << double(i) / cells, double(j) / cells, 0;
  for (int j = 0, t = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const int a = j * (cells + 1) + i, b = a + 1, c = a + cells + 1, d = c + 1;
      skin.rest.triangles.row(t++) << a, b, d;
      skin.rest.triangles.row(t++) << a, d, c;
    }
  }
  skin.paint.resize(std::size_t(skin.rest.points.rows()));
  return skin;
}

Eigen::Index left_of(const Skin& skin) { return simplified(skin, 0.002, 0.5, {}, skin.color).rows(); }

TEST(SurfaceColors, KeepTheTrianglesThatCarryThem) {
  Skin skin = sheet(60);
  const Eigen::Index all = skin.rest.triangles.rows(), plain = left_of(skin);
  EXPECT_LT(plain, all / 4);
  const auto color_all = [&skin](const auto& color) {
    skin.color.clear();
    for (const auto& p : skin.rest.points.rowwise()) skin.color.push_back(color(p.x(), p.y()));
  };
  color_all([](double x, double y) { return SurfaceColor{1, 1, 1, 0, float(3 * x), float(2 * y)}; });
  EXPECT_EQ(left_of(skin), plain);  // the texture is where it was
  color_all([](double x, double y) { return SurfaceColor{1, 1, 1, 0, float(x + 0.1 * std::sin(9 * x)), float(y)}; });
  EXPECT_EQ(left_of(skin), all);
  color_all([](double x, double) { return SurfaceColor{float(0.2 + 0.01 * x), 0.5f, 0.5f}; });
  EXPECT_EQ(left_of(skin), plain);
  std::mt19937 random(3);
  color_all([&random](double, double) { return SurfaceColor{float(random() % 2), 0, 0}; });
  EXPECT_EQ(left_of(skin), all);
}

}  // namespace surface_colors_test
}  // namespace supple
