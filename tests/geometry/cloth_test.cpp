// Tests cloth: which vertices are joined, on grids and on any triangle mesh, and surfaces read from files.
#include "geometry/meshes/cloth.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "base/error.h"
#include "geometry/files/mesh_file.h"
#include "geometry/skins/skin.h"
#include "geometry/tetrahedra/tetrahedralize.h"
#include "support/bodies.h"

namespace supple {
namespace cloth_test {

TEST(Cloth, GridsAlternateTheirDiagonalsAndSkipOneVertexToBend) {
  const ClothMesh cloth = cloth_grid({8, 6}, {4, 3});
  EXPECT_EQ(cloth.surface.points.rows(), 20);
  EXPECT_EQ(cloth.edges.size(), 4u * 4 + 5 * 3);
  EXPECT_EQ(cloth.diagonals.size(), 12u);
  EXPECT_EQ(cloth.bends.size(), 3u * 4 + 5 * 2);
  const auto length = [&](const VertexPair& pair) {
    return (cloth.surface.points.row(pair[0]) - cloth.surface.points.row(pair[1])).norm();
  };
  for (const VertexPair& edge : cloth.edges) EXPECT_NEAR(length(edge), 2, 1e-12);
  for (const VertexPair& bend : cloth.bends) EXPECT_NEAR(length(bend), 4, 1e-12);
  // The diagonals of neighbouring cells lean to different sides.
  const auto leans_right = [&](const VertexPair& d) {
    const Eigen::RowVector3d across = cloth.surface.points.row(d[1]) - cloth.surface.points.row(d[0]);
    return across.x() * across.y() > 0;
  };
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i + 1 < 4; ++i)
      EXPECT_NE(leans_right(cloth.diagonals[j * 4 + i]), leans_right(cloth.diagonals[j * 4 + i + 1]));
  }
  double area = 0;
  for (const double a : vertex_areas(cloth.surface)) area += a;
  EXPECT_NEAR(area, 48, 1e-12);
}

TEST(Cloth, OfATriangleMeshJoinsEdgesOnceAndFarCornersAcrossThem) {
  const TetMesh box = box_mesh(Vec3(1, 1, 1), Eigen::Vector3i(2, 2, 2));
  const Triangles faces = boundary_faces(box.tets);
  const ClothMesh cloth = cloth_of({box.rest, faces});
  EXPECT_EQ(cloth.edges.size(), static_cast<std::size_t>(faces.rows()) * 3 / 2);  // two triangles share each edge
  EXPECT_EQ(cloth.bends.size(), cloth.edges.size());
  EXPECT_TRUE(cloth.diagonals.empty());
  const std::set<VertexPair> unique(cloth.edges.begin(), cloth.edges.end());
  EXPECT_EQ(unique.size(), cloth.edges.size());
}

TEST(MeshFile, GivesTheTrianglesOfAFileAsASurface) {
  const test::TemporaryFolder folder;
  const TetMesh box = box_mesh(Vec3(1, 1, 1), Eigen::Vector3i(3, 3, 3));
  write_mesh(folder.path / "box.mesh", box);
  const TriMesh surface = read_surface(folder.path / "box.mesh");
  EXPECT_EQ(surface.triangles.rows(), boundary_faces(box.tets).rows());
  EXPECT_EQ(surface.points.rows(), box.rest.rows() - 8);  // the inner vertices are left out
}

TEST(MeshFile, RefusesBrokenSurfacesWithTheirLine) {
  const test::TemporaryFolder folder;
  const auto message = [&](const std::string& triangles) {
    std::ofstream(folder.path / "x.mesh")
        << "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n2 0 0 0\n" + triangles +
               "End\n";
    try {
      (void)read_surface(folder.path / "x.mesh");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  const std::string name = (folder.path / "x.mesh").string();
  EXPECT_EQ(message("Triangles\n1\n1 2 4 0\n"), name + ":11: the triangle has no area");
  EXPECT_EQ(message("Triangles\n2\n1 2 3 0\n2 3 1 0\n"), name + ":12: the triangle repeats the one at line 11");
  EXPECT_EQ(message("Triangles\n1\n1 2 5 0\n"),
            name + ":11: vertex 5 does not exist: there are 4 (vertices count from 1, and stand before the elements)");
  EXPECT_EQ(message("Edges\n0\n"), name + ":11: the file has no Triangles");
}

TEST(Skin, KeepsCreasesSharpAndPrintsSquaresAlongTheFaces) {
  const TetMesh box = box_mesh(Vec3(2, 1, 1), Eigen::Vector3i(4, 2, 2));
  std::vector<std::int32_t> vertex_of;
  const Skin skin = skin_of_surface(box.rest, boundary_faces(box.tets), 0.5, vertex_of);
  // Each of the six faces has its own vertices: 2 of 5 x 3, 2 of 5 x 3, 2 of 3 x 3.
  EXPECT_EQ(skin.rest.points.rows(), 2 * 15 + 2 * 15 + 2 * 9);
  ASSERT_EQ(skin.square.size(), vertex_of.size());
  for (std::size_t v = 0; v < vertex_of.size(); ++v) {
    EXPECT_EQ(skin.rest.points.row(v), box.rest.row(vertex_of[v]));
    for (const float at : skin.square[v]) EXPECT_NEAR(at, std::round(at), 1e-5);  // cells of 0.5 m are squares of 0.5 m
  }
  // Cloth is flat, so no vertex is doubled.
  const ClothMesh cloth = cloth_grid({1, 1}, {3, 3});
  EXPECT_EQ(skin_of_surface(cloth.surface.points, cloth.surface.triangles, 0, vertex_of).rest.points.rows(), 16);
}

}  // namespace cloth_test
}  // namespace supple
