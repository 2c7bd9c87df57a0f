// Reads small files of tetrahedra that are odd in one way each: they are read as what they say, or refused in words.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "geometry/files/mesh_file.h"
#include "support/bodies.h"
#include "support/odd_files.h"

namespace supple {
namespace odd_meshes_test {

using test::mark;
using test::OddFile;
using test::old_mac;
using test::replaced;
using test::wide;
using test::windows;

class OddMeshes : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_.path / name, std::ios::binary) << bytes;
  }

  test::TemporaryFolder folder_;
};

// One tetrahedron with a volume of 1/6.
std::string medit_text() {
  return "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\nTetrahedra\n1\n"
         "1 2 3 4 0\nEnd\n";
}
std::string gmsh_text_2() {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 "
         "1\n$EndNodes\n$Elements\n1\n"
         "1 4 2 0 1 1 2 3 4\n$EndElements\n";
}
std::string vtk_text() {
  return "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0\n1 0 0\n0 1 0\n"
         "0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n";
}
std::string vtk_text_5() {
  return "# vtk DataFile Version 5.1\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0\n1 0 0\n0 1 0\n"
         "0 0 1\nCELLS 2 4\nOFFSETS vtktypeint64\n0 4\nCONNECTIVITY vtktypeint64\n0 1 2 3\nCELL_TYPES 1\n10\n";
}
std::string vtu_text() {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
         "<UnstructuredGrid>\n<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n<Points>\n"
         "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
         "</DataArray>\n</Points>\n<Cells>\n<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n0 1 2 "
         "3\n"
         "</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n4\n</DataArray>\n"
         "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n10\n</DataArray>\n</Cells>\n</Piece>\n"
         "</UnstructuredGrid>\n</VTKFile>\n";
}
std::string node_text() { return "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"; }
std::string ele_text() { return "1 4 0\n1 1 2 4 3\n"; }

// The oddities that all formats of tetrahedra share. ones: the line of the vertex (1, 0, 0), and its number. indices:
// of the tetrahedron.
void add_meshes(std::vector<OddFile>& files, const std::string& ending, const std::string& mesh, const std::string& one,
                int line, const std::string& indices, const std::string& bad_indices, const std::string& bad_index) {
  const auto read = [&](const char* what, const std::string& bytes) { files.push_back({what, ending, bytes, ""}); };
  const auto with = [&](const std::string& number) {
    return replaced(mesh, one, replaced(one, "1 0 0", number + " 0 0"));
  };
  const auto refused = [&](const char* what, const std::string& bytes, const std::string& refusal) {
    files.push_back({what, ending, bytes, refusal});
  };
  const std::string place = fmt::format(":{}: ", line);
  read("plain", mesh);
  read("a byte-order mark", mark + mesh);
  read("lines of Windows", windows(mesh));
  read("lines of old Macs", old_mac(mesh));
  read("an exponent of Fortran", with("1.0D0"));
  read("a sign", with("+1.0"));
  refused("a decimal comma", with("1,5"), place + "'1,5'");
  refused("a hexadecimal number", with("0x1"), place + "'0x1'");
  refused("a word", with("one"), place + "'one'");
  refused("a unit", with("1m"), place + "'1m'");
  refused("nan", with("nan"), "is not finite");
  refused("characters of 16 bits", wide(mesh), "is a text of 16-bit characters");
  refused("an index too large", replaced(mesh, indices, bad_indices), bad_index);
}

TEST_F(OddMeshes, AreReadAsWhatTheySayOrRefusedInWords) {
  std::vector<OddFile> files;
  add_meshes(files, ".mesh", medit_text(), "\n1 0 0 0\n", 6, "1 2 3 4 0", "1 2 3 5 0", ":11: vertex 5 does not exist");
  add_meshes(files, ".msh", gmsh_text_2(), "\n2 1 0 0\n", 7, "1 2 3 4\n", "1 2 3 5\n", ":13: node 5 does not exist");
  add_meshes(files, ".vtk", vtk_text(), "\n1 0 0\n", 7, "4 0 1 2 3", "4 0 1 2 4", ":11: point 4 does not exist");
  add_meshes(files, ".vtk", vtk_text_5(), "\n1 0 0\n", 7, "\n0 1 2 3", "\n0 1 2 4", "cell 1: point 4 does not exist");
  add_meshes(files, ".vtu", vtu_text(), "\n1 0 0\n", 8, "\n0 1 2 3", "\n0 1 2 4", "cell 1: point 4 does not exist");
  const auto refused = [&](const char* ending, const char* what, const std::string& bytes, const std::string& refusal) {
    files.push_back({what, ending, bytes, refusal});
  };
  refused(".mesh", "a vertex too few announced", replaced(medit_text(), "Vertices\n4", "Vertices\n3"),
          ":8: 3 vertices announced, but the file holds 4");
  refused(".mesh", "a vertex too many announced", replaced(medit_text(), "Vertices\n4", "Vertices\n5"),
          ":9: 'Tetrahedra' is not a coordinate");
  refused(".mesh", "an element too many announced", replaced(medit_text(), "Tetrahedra\n1", "Tetrahedra\n2"),
          "'End' is not a vertex of an element");
  refused(".msh", "a node too few announced", replaced(gmsh_text_2(), "$Nodes\n4", "$Nodes\n3"),
          "3 nodes announced, but the file holds 4");
  refused(".msh", "words after an element", replaced(gmsh_text_2(), "1 2 3 4\n", "1 2 3 4 x\n"),
          ":13: more than four nodes");
  refused(".msh", "a fifth node", replaced(gmsh_text_2(), "1 2 3 4\n", "1 2 3 4 1\n"), ":13: more than four nodes");
  refused(".vtk", "a point too few announced", replaced(vtk_text(), "POINTS 4", "POINTS 3"),
          "3 points announced, but the file holds 4");
  refused(".vtk", "fewer numbers of cells", replaced(vtk_text(), "CELLS 1 5", "CELLS 1 7"),
          "7 numbers of cells announced, but the cells hold 5");
  refused(".vtk", "an offset that does not begin at 0", replaced(vtk_text_5(), "\n0 4\n", "\n1 4\n"),
          "the first offset of the cells is 1");
  refused(".vtk", "points of no cell",
          replaced(replaced(vtk_text_5(), "\n0 1 2 3", "\n0 1 2 3 0"), "CELLS 2 4", "CELLS 2 5"),
          "the cells have 4 points, but 5 are listed");
  refused(".vtu", "points of no cell", replaced(vtu_text(), "\n0 1 2 3", "\n0 1 2 3 0"),
          "the cells have 4 points, but 5 are listed");
  refused(".vtu", "a point too few announced", replaced(vtu_text(), "Points=\"4\"", "Points=\"3\""),
          "NumberOfPoints = 3 announced, but the file holds 4");
  refused(".vtu", "points of two numbers", replaced(vtu_text(), "Components=\"3\"", "Components=\"2\""),
          "points have 2 components, and 3 are read");
  const std::string left_out = "1 elements are no tetrahedra of the first or second order, and have been left out";
  files.push_back({"a pyramid", ".msh",
                   replaced(replaced(gmsh_text_2(), "$Elements\n1", "$Elements\n2"), "$EndElements",
                            "2 7 2 0 1 1 2 3 4 1\n$EndElements"),
                   "", left_out});
  files.push_back({"a triangle", ".msh",
                   replaced(replaced(gmsh_text_2(), "$Elements\n1", "$Elements\n2"), "$EndElements",
                            "2 2 2 0 1 1 2 3\n$EndElements"),
                   ""});
  files.push_back({"a pyramid", ".vtk",
                   replaced(replaced(vtk_text(), "CELLS 1 5\n", "CELLS 2 11\n5 0 1 2 3 0\n"), "CELL_TYPES 1\n",
                            "CELL_TYPES 2\n14\n"),
                   "", left_out});
  for (const OddFile& odd : files) {
    write("odd" + odd.ending, odd.bytes);
    test::expect_as_said(odd, [&] {
      const MeshFile found = read_mesh(folder_.path / ("odd" + odd.ending));
      EXPECT_NEAR(tet_volume(found.mesh, 0), 1.0 / 6, 1e-15);
      std::string notes;
      for (const std::string& note : found.notes) notes += note + '\n';
      if (odd.remark.empty()) {
        EXPECT_EQ(notes, "");
      } else {
        EXPECT_NE(notes.find(odd.remark), std::string::npos) << notes;
      }
    });
  }
}

TEST_F(OddMeshes, OfTetGenAreReadAsWhatTheySayOrRefusedInWords) {
  const auto says = [&](const std::string& nodes, const std::string& elements, const std::string& refusal) {
    write("odd.node", nodes);
    write("odd.ele", elements);
    test::expect_as_said({nodes + elements, ".ele", "", refusal},
                         [&] { EXPECT_NEAR(tet_volume(read_mesh(folder_.path / "odd.ele").mesh, 0), 1.0 / 6, 1e-15); });
  };
  says(node_text(), ele_text(), "");
  says(mark + node_text(), mark + ele_text(), "");
  says(windows(node_text()), windows(ele_text()), "");
  says(old_mac(node_text()), old_mac(ele_text()), "");
  says(replaced(node_text(), "2 1 0 0", "2 1.0D0 0 0 # a comment"), ele_text(), "");
  says(replaced(node_text(), "2 1 0 0", "2 1,5 0 0"), ele_text(), ".node:3: '1,5' is not a coordinate (decimal commas");
  says(replaced(node_text(), "2 1 0 0", "2 0x1 0 0"), ele_text(), ".node:3: '0x1' is not a coordinate");
  says(replaced(node_text(), "2 1 0 0", "2 1 0 0 red"), ele_text(), ".node:3: 'red' is not an attribute or marker");
  says(replaced(node_text(), "4 3", "3 3"), ele_text(), "3 points announced, but the file holds 4");
  says(replaced(node_text(), "4 3", "5 3"), ele_text(), "5 points announced, but the file ends after 4");
  says(node_text(), replaced(ele_text(), "1 1 2 4 3", "1 1 2 4 5"), ".ele:2: point 5 does not exist");
  says(node_text(), replaced(ele_text(), "1 1 2 4 3", "1 1 2 4 3 x"), ".ele:2: 'x' is not an attribute");
  says(node_text(), replaced(ele_text(), "1 4 0", "2 4 0"), "2 elements announced, but the file ends after 1");
}

}  // namespace odd_meshes_test
}  // namespace supple
