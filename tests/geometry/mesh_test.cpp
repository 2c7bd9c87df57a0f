// Tests shapes, tetrahedra made from them, mesh files as untrusted input, and embedded skins.
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "base/error.h"
#include "geometry/files/mesh_file.h"
#include "geometry/skins/embedding.h"
#include "geometry/skins/skin.h"
#include "geometry/tetrahedra/lattice_probe.h"
#include "geometry/tetrahedra/tetrahedralize.h"
#include "geometry/triangles/surface_thickness.h"
#include "scene/reading/shape_reader.h"
#include "support/bodies.h"
#include "support/surfaces.h"

namespace supple {
namespace mesh_test {

Shape shape_of(const Primitive& primitive) {
  Shape shape;
  ShapePart part;
  part.primitive = primitive;
  shape.root.parts.push_back(part);
  return shape;
}

Shape squirrel() { return load_shape(test::assets / "shapes" / "squirrel.toml", test::assets); }

TEST(Shape, PrimitivesAreExactDistancesOutsideTheirSurface) {
  // Points that move along a distance field by the field's own value reach the surface, and the field's slope is 1.
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-2, 2);
  const Primitive primitives[] = {Sphere{0.7},
                                  Capsule{Vec3(-0.3, 0, 0), Vec3(0.5, 0.2, 0), 0.3},
                                  RoundCone{Vec3(0, -0.3, 0), Vec3(0.1, 0.6, 0), 0.4, 0.15},
                                  Box{Vec3(0.4, 0.5, 0.3), 0.1},
                                  Cylinder{0.5, 0.4, 0.05},
                                  Torus{0.6, 0.2},
                                  HalfSpace{Vec3(0.6, 0.8, 0), 0.1}};
  for (const Primitive& primitive : primitives) {
    const Shape shape = shape_of(primitive);
    for (int sample = 0; sample < 300; ++sample) {
      const Vec3 p(uniform(random), uniform(random), uniform(random));
      const double d = shape.distance(p);
      if (d < 0.05) continue;
      const Vec3 slope = shape.gradient(p, 1e-5);
      EXPECT_NEAR(slope.norm(), 1, 1e-4) << primitive.index();
      EXPECT_NEAR(shape.distance(p - d * slope), 0, 1e-4) << primitive.index();
    }
  }
}

TEST(Shape, CutsAndBlendsHaveTheSignsOfTheirParts) {
  Shape shape = shape_of(Sphere{1});
  ShapePart hole;
  hole.primitive = Sphere{0.5};
  hole.combine = Combine::cut;
  shape.root.parts.push_back(hole);
  EXPECT_GT(shape.distance(Vec3(0.2, 0, 0)), 0);
  EXPECT_LT(shape.distance(Vec3(0.7, 0, 0)), 0);
  EXPECT_GT(shape.distance(Vec3(1.2, 0, 0)), 0);
  ShapePart lens;
  lens.primitive = Sphere{0.8};
  lens.combine = Combine::intersect;
  shape.root.parts.push_back(lens);
  EXPECT_GT(shape.distance(Vec3(0.9, 0, 0)), 0);
  EXPECT_LT(shape.distance(Vec3(0.7, 0, 0)), 0);
}

void expect_sound(const TetMesh& mesh, double smallest_angle) {
  const MeshQuality q = quality(mesh);
  const Manifoldness m = manifoldness(mesh);
  EXPECT_GT(q.smallest_volume, 0);
  EXPECT_GT(q.smallest_dihedral, smallest_angle);
  EXPECT_EQ(m.pieces, 1);
  EXPECT_EQ(m.bad_edges, 0);
  EXPECT_EQ(m.bad_vertices, 0);
}

TEST(Tetrahedralize, HitsTheNumberOfVerticesWithGoodAnglesAndOneManifoldPiece) {
  const Shape head = squirrel();
  for (const int wanted : {2000, 8395}) {
    const TetMesh mesh = tetrahedralize(head, wanted, "squirrel");
    EXPECT_NEAR(mesh.rest.rows(), wanted, 0.03 * wanted);
    expect_sound(mesh, 8);
  }
  for (const Primitive& primitive : {Primitive(Sphere{1}), Primitive(Torus{1, 0.4}),
                                     Primitive(Box{Vec3(1, 0.5, 0.3), 0}), Primitive(Ellipsoid{Vec3(1, 0.6, 0.4)})}) {
    const TetMesh mesh = tetrahedralize(shape_of(primitive), 1500, "primitive");
    EXPECT_NEAR(mesh.rest.rows(), 1500, 45);
    expect_sound(mesh, 8);
  }
}

// A slender shape gains and loses whole layers of vertices at once.
TEST(Tetrahedralize, TakesTheNearestNumberThatASlenderShapeHasWhereThatIsAskedFor) {
  const Shape capsule = shape_of(Capsule{Vec3(-0.3, 0, 0), Vec3(0.3, 0, 0), 0.05});
  for (const auto& [wanted, most] : {std::pair(100, 140), {750, 780}, {1000, 1030}}) {
    EXPECT_THROW(tetrahedralize(capsule, wanted, "capsule"), InputError) << wanted;
    const TetMesh mesh = tetrahedralize(capsule, wanted, "capsule", {}, 0, 0.5);
    EXPECT_NEAR(mesh.rest.rows(), wanted, most - wanted);
    expect_sound(mesh, 8);
  }
}

TEST(Tetrahedralize, FillsTheVolumeOfTheShape) {
  const double ball = quality(tetrahedralize(shape_of(Sphere{1}), 8000, "ball")).volume;
  EXPECT_NEAR(ball / (4.0 / 3 * M_PI), 1, 0.01);
  const double ring = quality(tetrahedralize(shape_of(Torus{1, 0.4}), 8000, "ring")).volume;
  EXPECT_NEAR(ring / (2 * M_PI * M_PI * 0.16), 1, 0.015);
}

TEST(Tetrahedralize, IsDeterministicAndCarriesRegions) {
  const Shape head = squirrel();
  const TetMesh a = tetrahedralize(head, 6000, "squirrel"), b = tetrahedralize(head, 6000, "squirrel");
  EXPECT_TRUE(a.rest == b.rest && a.tets == b.tets && a.regions == b.regions);
  const auto teeth = std::find(head.regions.begin(), head.regions.end(), "teeth") - head.regions.begin();
  const auto count = std::count(a.regions.begin(), a.regions.end(), teeth);
  EXPECT_GT(count, 20);
  EXPECT_LT(count, 800);
}

TEST(Tetrahedralize, RefusesWhatCannotBeMeshed) {
  EXPECT_THROW(tetrahedralize(shape_of(HalfSpace{Vec3::UnitY(), 0}), 500, "x"), InputError);
  Shape nothing = shape_of(Sphere{1});
  ShapePart cut;
  cut.primitive = Sphere{2};
  cut.combine = Combine::cut;
  nothing.root.parts.push_back(cut);
  EXPECT_THROW(tetrahedralize(nothing, 500, "x"), InputError);
  try {
    tetrahedralize(shape_of(Box{Vec3(0.5, 0.015, 0.5), 0}), 750, "sheet");
    FAIL() << "was meshed";
  } catch (const InputError& error) {
    EXPECT_EQ(error.problems().front().message,
              "cannot be meshed with 750 vertices: its thinnest part needs more of them");
  }
}

TEST(Tetrahedralize, RefusesAShapeInTwoPieces) {
  Shape two = shape_of(Sphere{1});
  ShapePart other;
  other.primitive = Sphere{1};
  other.to_local.translation() = Vec3(-3, 0, 0);
  two.root.parts.push_back(other);
  EXPECT_THROW(tetrahedralize(two, 1000, "x"), InputError);
}

// A plate of a hundredth of an element's thickness is lost to a lattice inside it.
TEST(Tetrahedralize, ASwollenBodyHoldsWhatIsThinnerThanItsElements) {
  Shape plate;
  plate.root.parts.emplace_back().primitive =
      ClosedSurface{std::make_shared<TriangleSolid>(test::box_surface(Vec3(1, 5e-4, 0.5)))};
  EXPECT_THROW(tetrahedralize(plate, 600, "plate"), InputError);
  const TetMesh mesh = tetrahedralize(plate, 600, "plate", {}, 0.5);
  EXPECT_NEAR(double(mesh.rest.rows()), 600, 60);
  EXPECT_EQ(manifoldness(mesh).pieces, 1);
  const Vec3 extent = bounds_of(mesh.rest).extent();
  const double beyond = 0.5 * (extent.x() - 2);
  EXPECT_GT(beyond, 0.01);
  EXPECT_NEAR(extent.z() - 1, 2 * beyond, 0.01);
  EXPECT_NEAR(quality(mesh).volume, extent.x() * extent.y() * extent.z(), 0.15 * quality(mesh).volume);
}

// Two balls that do not quite touch, joined by a blend, and one far away.
TEST(LatticeProbe, GivesTheBitsOfTheShapeAlsoOnAWayAndSwollen) {
  const auto solid = std::make_shared<TriangleSolid>(test::sphere_surface(1, 24, 12));
  Shape shape;
  for (const double x : {0.0, 2.1, 6.0}) {
    ShapePart& part = shape.root.parts.emplace_back();
    part.primitive = ClosedSurface{solid};
    part.to_local.translation() = Vec3(-x, 0, 0);
    part.blend = x > 0 ? 0.3 : 0;
  }
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1.5, 1.5), share(0, 1);
  for (const double swell : {0.0, 0.125}) {
    const LatticeProbe probe(shape, swell);
    LatticeProbe::Memory near = probe.memory();
    for (int i = 0; i < 3000; ++i) {
      const Vec3 start(1 + 1.4 * place(random), place(random), place(random));
      const Vec3 way = 0.1 * Vec3(place(random), place(random), place(random));
      EXPECT_EQ(probe.distance(start, near), shape.distance(start) - swell) << start.transpose();
      LatticeProbe::Way along(probe, start, way.norm(), near);
      for (int step = 0; step < 5; ++step) {
        const Vec3 p = start + share(random) * way;
        EXPECT_EQ(along.distance(p, way.norm()), shape.distance(p) - swell) << p.transpose();
      }
    }
  }
}

TEST(BoxMesh, FillsTheBoxWithPositiveElements) {
  const TetMesh mesh = box_mesh(Vec3(4, 2, 1), Eigen::Vector3i(5, 4, 3));
  EXPECT_EQ(mesh.rest.rows(), 6 * 5 * 4);
  EXPECT_NEAR(quality(mesh).volume, 8, 1e-12);
  expect_sound(mesh, 20);
}

TEST(MeshFile, GivesBackTheSameDoubles) {
  const test::TemporaryFolder folder;
  TetMesh mesh = tetrahedralize(shape_of(Sphere{1}), 300, "ball");
  mesh.regions[3] = 7;
  write_mesh(folder.path / "ball.mesh", mesh);
  const MeshFile read = read_mesh(folder.path / "ball.mesh");
  EXPECT_TRUE(read.notes.empty());
  EXPECT_TRUE(read.mesh.rest == mesh.rest && read.mesh.tets == mesh.tets && read.mesh.regions == mesh.regions);
}

TEST(MeshFile, RefusesBrokenFilesWithTheirLine) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path / "bad.mesh";
  const std::string head = "MeshVersionFormatted 1\nDimension 3\n";
  const std::string points = "Vertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 1 1 0\n";
  const struct {
    std::string text, message;
  } cases[] = {
      {"", ":1: not a MEDIT mesh: it should begin with MeshVersionFormatted"},
      {"solid x\n", ":1: not a MEDIT mesh: it should begin with MeshVersionFormatted"},
      {head, ":3: the file has no Vertices or no Tetrahedra"},
      {head + "Vertices\n999999999\n0 0 0 0\n",
       ":4: 999999999 vertices announced, but the file has room for at most 1"},
      {head + "Vertices\n-1\n", ":4: -1 vertices announced, but the file has room for at most 0"},
      {head + "Vertices\n1\n0 nan 0 0\n", ":5: a coordinate is not finite (nan)"},
      {head + "Vertices\n1\n0 zero 0 0\n", ":5: 'zero' is not a coordinate"},
      {head + "Vertices\n2\n0 0 0 0\n1 1",
       ":6: 2 vertices announced, but the file ends after 1: a coordinate should stand here"},
      {head + points + "Tetrahedra\n1\n1 2 3 9 0\n",
       ":12: vertex 9 does not exist: there are 5 (vertices count from 1, and stand before the elements)"},
      {head + points + "Tetrahedra\n1\n1 2 3 3 0\n", ":12: the element has no volume"},
      {head + points + "Tetrahedra\n2\n1 2 3 4 0\n2 3 4 1 0\n", ":13: the element repeats the one at line 12"},
      {head + points + "Tetrahedra\n2\n1 2 3 4 0\n2 3 4 5 0\n1 2 5 3 0\n",
       ":14: 2 elements announced, but the file holds 3"},
      {head + points + "Tetrahedra\n2\n1 2 3 4 0\n2 4 3 5 0\n",
       ":13: 1 of 2 elements are turned inside out, the first here; all must be oriented alike"},
      {head + points + "Tetrahedra 1\n1 2 3 4 0\nVertices 1\n0 0 0 0\n", ":12: a second Vertices section"},
      {head + points + "Tetrahedra 1\n1 2 3 4 0\nTetrahedra 1\n1 2 3 5 0\n", ":12: a second Tetrahedra section"},
      {head + "Quads\n1\n", ":3: section 'Quads' is not known"},
  };
  for (const auto& [text, message] : cases) {
    std::ofstream(path) << text;
    try {
      read_mesh(path);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()), path.string() + message);
    }
  }
  EXPECT_THROW(read_mesh(folder.path / "none.mesh"), InputError);
  EXPECT_THROW(read_mesh(folder.path), InputError);
}

TEST(MeshFile, TurnsConsistentlyReversedElementsAndDropsUnusedVerticesAndSaysSo) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path / "turned.mesh";
  std::ofstream(path) << "MeshVersionFormatted 1\nDimension 3\nVertices 5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n9 9 9 "
                         "0\nTetrahedra 1\n1 3 2 4 0\nEnd\n";
  const MeshFile read = read_mesh(path);
  EXPECT_EQ(read.notes.size(), 2u);
  EXPECT_EQ(read.mesh.rest.rows(), 4);
  EXPECT_GT(tet_volume(read.mesh, 0), 0);
}

TEST(MeshFile, ReadsThePapersMeshes) {
  const struct {
    const char* name;
    int vertices, elements;
  } meshes[] = {{"bunny", 6308, 26096},
                {"ditto", 1454, 4140},
                {"hippo", 2387, 8406},
                {"longbar", 574, 1631},
                {"longbar2", 3472, 10199},
                {"sphere", 889, 1772},
                {"squirrel_modified", 8395, 23645},
                {"thin_sheet", 660, 1932}};
  for (const auto& expected : meshes) {
    const auto path = test::paper_mesh(expected.name);
    if (!path) GTEST_SKIP() << "no SUPPLE_PAPER_MESHES: " << expected.name;
    const MeshFile read = read_mesh(*path);
    EXPECT_EQ(read.mesh.rest.rows(), expected.vertices) << expected.name;
    EXPECT_EQ(read.mesh.tets.rows(), expected.elements) << expected.name;
  }
}

TEST(Skin, LiesOnTheSurfaceAndFollowsItsElements) {
  const Shape head = squirrel();
  const TetMesh mesh = tetrahedralize(head, 3000, "squirrel");
  const Skin skin = skin_of(head, 0.03);
  double furthest = 0;
  for (Eigen::Index v = 0; v < skin.rest.points.rows(); ++v)
    furthest = std::max(furthest, std::abs(head.distance(skin.rest.points.row(v))));
  EXPECT_LT(furthest, 0.004);
  // An affine motion of the mesh moves the skin by the same motion.
  const Embedding embedding = embed(skin.rest, mesh);
  Mat3 a;
  a << 1.1, 0.2, 0, -0.1, 0.9, 0.3, 0, 0.1, 1.2;
  const Positions moved = (mesh.rest * a.transpose()).rowwise() + Eigen::RowVector3d(1, 2, 3);
  const Positions expected = (skin.rest.points * a.transpose()).rowwise() + Eigen::RowVector3d(1, 2, 3);
  EXPECT_LT((embedded_points(embedding, moved) - expected).cwiseAbs().maxCoeff(), 1e-10);
  for (const float open : skin.occlusion) EXPECT_TRUE(open >= 0 && open <= 1);
}

TEST(Skin, IsClosedAndOutward) {
  const TriMesh ball = contour(shape_of(Sphere{1}), 0.1);
  std::map<std::pair<int, int>, int> edges;
  double volume = 0;
  for (Eigen::Index t = 0; t < ball.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) ++edges[{ball.triangles(t, k), ball.triangles(t, (k + 1) % 3)}];
    const Vec3 a = ball.points.row(ball.triangles(t, 0)), b = ball.points.row(ball.triangles(t, 1)),
               c = ball.points.row(ball.triangles(t, 2));
    volume += a.dot(b.cross(c)) / 6;
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  EXPECT_NEAR(volume / (4.0 / 3 * M_PI), 1, 0.02);
}

}  // namespace mesh_test
}  // namespace supple
