// Tests the formats of tetrahedral meshes: what is written comes back, files of other programs are understood, and what
// is wrong is refused with its line. Mutated files end in an error or in a mesh.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "base/error.h"
#include "geometry/files/mesh_file.h"
#include "geometry/tetrahedra/tetrahedralize.h"
#include "geometry/triangles/surface_thickness.h"
#include "support/bodies.h"

namespace supple {
namespace mesh_formats_test {

TetMesh tagged_box() {
  TetMesh mesh = box_mesh(Vec3(0.3, 0.2, 0.1), Eigen::Vector3i(3, 2, 2));
  mesh.regions.assign(std::size_t(mesh.tets.rows()), 0);
  for (std::size_t e = 10; e < 25; ++e) mesh.regions[e] = e < 20 ? 3 : 7;
  return mesh;
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class MeshFormats : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_.path / name, std::ios::binary) << bytes;
    return folder_.path / name;
  }
  std::string refusal(const std::string& name, const std::string& bytes) const {
    const std::filesystem::path path = write(name, bytes);
    try {
      read_mesh(path);
      return "accepted";
    } catch (const InputError& error) {
      return std::string(error.what()).substr(folder_.path.string().size() + 1);
    }
  }
  test::TemporaryFolder folder_;
};

TEST_F(MeshFormats, WhatIsWrittenComesBackWithItsBitsAndRegions) {
  const TetMesh mesh = tagged_box();
  for (const char* name : {"a.mesh", "a.msh", "a.vtk", "a.vtu", "a.ele", "b.node"}) {
    write_mesh(folder_.path / name, mesh);
    const MeshFile read = read_mesh(folder_.path / name);
    EXPECT_EQ(read.mesh.rest, mesh.rest) << name;
    EXPECT_EQ(read.mesh.regions.size(), mesh.regions.size()) << name;
    EXPECT_NEAR(quality(read.mesh).volume, 0.006, 1e-15) << name;
    EXPECT_EQ(std::count(read.mesh.regions.begin(), read.mesh.regions.end(), 3), 10) << name;
    EXPECT_EQ(std::count(read.mesh.regions.begin(), read.mesh.regions.end(), 7), 5) << name;
  }
}

TEST_F(MeshFormats, OtherEndingsAreRefusedBeforeAMeshIsMade) {
  for (const char* name : {"x.stl", "x.obj", "x"}) {
    try {
      check_writable(name);
      ADD_FAILURE() << name;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("is no format for tetrahedra here: MEDIT .mesh"), std::string::npos);
    }
  }
}

constexpr char gmsh_2[] =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 5 \"a # name\"\n$EndPhysicalNames\n$Nodes\n5\n"
    "10 0 0 0\n11 1 0 0\n12 0 1 0\n13 0 0 1\n20 1 1 1\n$EndNodes\n$Elements\n3\n1 2 2 1 1 10 11 12\n"
    "2 4 2 5 1 10 11 12 13\n3 4 2 6 1 20 12 11 13\n$EndElements\n";

TEST_F(MeshFormats, GmshOfVersion2HasNumbersOfItsOwnAndOtherElements) {
  const MeshFile read = read_mesh(write("x.msh", gmsh_2));
  EXPECT_EQ(read.mesh.rest.rows(), 5);
  EXPECT_EQ(read.mesh.tets.rows(), 2);
  EXPECT_EQ(read.mesh.regions, (std::vector<int>{5, 6}));
  EXPECT_TRUE(read.mesh.rest.row(4) == Eigen::RowVector3d(1, 1, 1));
}

constexpr char gmsh_4[] =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n1 0 1 2\n1 0 0 0 0\n1 0 0 0 1 1 0 0 0\n"
    "1 0 0 0 1 1 1 1 9 1 1\n2 0 0 0 1 1 1 0 1 1\n$EndEntities\n$Nodes\n2 5 10 20\n2 1 0 2\n10\n11\n0 0 0\n1 0 0\n"
    "3 1 0 3\n12\n13\n20\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n$Elements\n3 3 1 3\n2 1 2 1\n1 10 11 12\n3 1 4 1\n2 10 11 12 "
    "13\n"
    "3 2 4 1\n3 20 12 11 13\n$EndElements\n";

TEST_F(MeshFormats, GmshOfVersion4HasBlocksAndGroupsOfEntities) {
  const MeshFile read = read_mesh(write("x.msh", gmsh_4));
  EXPECT_EQ(read.mesh.rest.rows(), 5);
  EXPECT_EQ(read.mesh.regions, (std::vector<int>{9, 0}));
}

constexpr char vtk_5[] =
    "# vtk DataFile Version 5.1\nany # title\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n0 0 0 1 0 0 0 1 0 0 0 "
    "1\n"
    "1 1 1\nMETADATA\nINFORMATION 0\n\nCELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3 4 2 "
    "1 3\n"
    "CELL_TYPES 2\n10\n10\n";

TEST_F(MeshFormats, VtkOfVersion5HasTwoArraysForCells) {
  EXPECT_EQ(read_mesh(write("x.vtk", vtk_5)).mesh.tets.rows(), 2);
}

TEST_F(MeshFormats, VtuArraysMayBeBase64) {
  // 4 points as Float64 and one tetrahedron, each array with a header of UInt32 in a run of its own.
  const auto base64 = [](const std::string& bytes) {
    const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
      unsigned block = 0;
      for (std::size_t k = 0; k < 3; ++k)
        block = block << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
      for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[block >> (18 - 6 * k) & 63] : '=';
    }
    return text;
  };
  const auto array = [&](const char* type, const char* name, const auto& values) {
    using Value = std::decay_t<decltype(values[0])>;
    const std::uint32_t size = std::uint32_t(sizeof(Value) * values.size());
    const std::string head(reinterpret_cast<const char*>(&size), 4);
    const std::string body(reinterpret_cast<const char*>(values.data()), size);
    return fmt::format("<DataArray type=\"{}\" Name=\"{}\" format=\"binary\">{}{}</DataArray>\n", type, name,
                       base64(head), base64(body));
  };
  const std::string text =
      "<?xml version=\"1.0\"?><VTKFile type=\"UnstructuredGrid\" header_type=\"UInt32\"><UnstructuredGrid>"
      "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points>" +
      array("Float64", "p", std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}) + "</Points><Cells>" +
      array("Int32", "connectivity", std::vector<std::int32_t>{0, 1, 2, 3}) +
      array("Int64", "offsets", std::vector<std::int64_t>{4}) + array("UInt8", "types", std::vector<std::uint8_t>{10}) +
      "</Cells></Piece></UnstructuredGrid></VTKFile>";
  const MeshFile read = read_mesh(write("x.vtu", text));
  EXPECT_NEAR(quality(read.mesh).volume, 1.0 / 6, 1e-15);
}

TEST_F(MeshFormats, ACountThatIsWrongIsNamedWithTheOneThatIsThere) {
  std::string gmsh = gmsh_2;
  gmsh.replace(gmsh.find("$Nodes\n5"), 8, "$Nodes\n4");
  EXPECT_EQ(refusal("x.msh", gmsh), "x.msh:14: 4 nodes announced, but the file holds 5");
  gmsh.replace(gmsh.find("$Nodes\n4"), 8, "$Nodes\n6");
  EXPECT_EQ(refusal("x.msh", gmsh), "x.msh:15: '$EndNodes' is not a node's number");
  const std::string head = "MeshVersionFormatted 1\nDimension 3\n", points = "Vertices\n3\n0 0 0 0\n1 0 0 0\n0 1 0 0\n";
  EXPECT_EQ(refusal("x.mesh", head + points + "0 0 1 0\nTetrahedra\n1\n1 2 3 4 0\n"),
            "x.mesh:8: 3 vertices announced, but the file holds 4");
  EXPECT_EQ(refusal("x.mesh", head + "Vertices\n3\n0 0 0 0\n1 0 0 0\n"),
            "x.mesh:7: 3 vertices announced, but the file ends after 2: a coordinate should stand here");
  write("t.node", "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n");
  EXPECT_EQ(refusal("t.ele", "1 4 0\n1 1 2 3 4\n2 2 3 4 1\n"), "t.ele:3: 1 elements announced, but the file holds 2");
  std::string vtk = vtk_5;
  vtk.replace(vtk.find("POINTS 5"), 8, "POINTS 4");
  EXPECT_EQ(refusal("x.vtk", vtk), "x.vtk:7: 4 points announced, but the file holds 5");
}

TEST_F(MeshFormats, WhatIsNotReadIsNamed) {
  EXPECT_EQ(refusal("x.msh", "$MeshFormat\n4 0 8\n$EndMeshFormat\n"),
            "x.msh:2: version 4 is not read (2.2 and 4.1 are: gmsh -format msh41)");
  EXPECT_EQ(refusal("x.msh", "$MeshFormat\n2.2 1 8\n"),
            "x.msh:2: binary files are not read (gmsh -save without -bin writes text)");
  EXPECT_EQ(refusal("x.vtk", "# vtk DataFile Version 3.0\nt\nBINARY\n"),
            "x.vtk:3: BINARY files are not read; ASCII ones are");
  EXPECT_EQ(refusal("x.vtu", "<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkZLibDataCompressor\">"),
            "x.vtu: compressed arrays are not read; 'ascii' ones are");
  write("t.node", "1 2 0 0\n1 0 0\n");
  EXPECT_EQ(refusal("t.ele", "1 4 0\n1 1 2 3 4\n").substr(0, 40), "t.node:1: the dimension must be 3, not 2");
}

// Every mutation ends in a mesh or in one InputError, and takes no memory for what is only announced.
TEST_F(MeshFormats, MutatedFilesEndInAnErrorOrAMesh) {
  const TetMesh mesh = tagged_box();
  std::mt19937 random(11);
  const std::string alphabet = "0123456789 \n.-+eE$<>\"/=#ATV";
  for (const char* name : {"a.mesh", "a.msh", "a.vtk", "a.vtu", "a.ele", "a.node"}) {
    write_mesh(folder_.path / name, mesh);
    const std::string whole = text_of(folder_.path / name);
    int refused = 0;
    for (int i = 0; i < 150; ++i) {
      std::string bytes = whole;
      for (int change = 0; change < 1 + i % 4; ++change) {
        const std::size_t at = random() % bytes.size();
        switch (random() % 4) {
          case 0: bytes[at] = alphabet[random() % alphabet.size()]; break;
          case 1: bytes.erase(at, 1 + random() % 20); break;
          case 2: bytes.insert(at, 1, char(random() % 256)); break;
          default: bytes.resize(at);
        }
        if (bytes.empty()) bytes = " ";
      }
      refused += refusal(name, bytes) != "accepted" ? 1 : 0;
    }
    EXPECT_GT(refused, 20) << name;
    write(name, whole);
  }
}

}  // namespace mesh_formats_test
}  // namespace supple
