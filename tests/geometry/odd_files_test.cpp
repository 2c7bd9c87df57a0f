// Reads small files of surfaces, of all formats, that are odd in one way each: as other programs write them, or as an
// accident leaves them. Each is read as the shape that it says, or is refused in words; none is read as another shape
// without a word.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <fstream>
#include <limits>

#include "geometry/files/surface_file.h"
#include "geometry/solids/closed_surface.h"
#include "geometry/solids/surface_pieces.h"
#include "support/bodies.h"
#include "support/odd_files.h"
#include "support/surfaces.h"

namespace supple {
namespace odd_files_test {

using test::mark;
using test::OddFile;
using test::old_mac;
using test::replaced;
using test::replaced_everywhere;
using test::wide;
using test::windows;

template <class T>
void append(std::string& bytes, T value, bool big_endian = false) {
  std::string own(reinterpret_cast<const char*>(&value), sizeof value);
  if (big_endian) own = std::string(own.rbegin(), own.rend());
  bytes += own;
}

const TriMesh unit_box = test::moved(test::box_surface(Vec3(0.5, 0.5, 0.5)), Vec3(0.5, 0.5, 0.5));

// The six sides of the unit box, from 0.
const std::array<std::array<int, 4>, 6> sides = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

std::string points_text(const std::string& before, const Vec3& at = Vec3::Zero(), double scale = 1,
                        const std::string& after = "") {
  std::string text;
  for (const auto& p : unit_box.points.rowwise())
    text += fmt::format("{}{} {} {}{}\n", before, scale * p.x() + at.x(), scale * p.y() + at.y(),
                        scale * p.z() + at.z(), after);
  return text;
}

std::string sides_text(const std::string& before, int first, const std::string& after = "") {
  std::string text;
  for (const auto& side : sides) {
    text += before;
    for (std::size_t k = 0; k < 4; ++k)
      text += fmt::format("{}{}{}", k > 0 || !before.empty() ? " " : "", side[k] + first, after);
    text += '\n';
  }
  return text;
}

const Vec3 far_away(5e5, 4.5e6, 120);  // as coordinates of maps are
const double nan = std::numeric_limits<double>::quiet_NaN();

void add_obj(std::vector<OddFile>& files) {
  const std::string points = points_text("v "), faces = sides_text("f", 1), box = points + faces;
  const auto read = [&](const char* what, const std::string& bytes, const std::string& remark = "") {
    files.push_back({what, ".obj", bytes, "", remark});
  };
  const auto refused = [&](const char* what, const std::string& bytes, const std::string& refusal) {
    files.push_back({what, ".obj", bytes, refusal});
  };
  read("plain", box);
  read("a byte-order mark", mark + box);
  read("lines of Windows", windows(box));
  read("lines of old Macs", old_mac(box));
  read("a mark and lines of Windows", mark + windows(box));
  read("comments at the ends of lines",
       replaced(replaced(box, "0 0 0\n", "0 0 0 # the first\n"), "f 1 5 7 3", "f 1 5 7 3# side"));
  read("comments with numbers", "# 1,5 0x10\n" + box + "# f 9 9 9\n");
  read("a continued line", replaced(box, "f 1 5 7 3", "f 1 5 \\\n7 3"));
  read("a line continued without a space", replaced(box, "f 1 5 7 3", "f 1 5\\\n 7 3"));
  read("tabs and many spaces", replaced_everywhere(replaced(box, "v 0 0 0", "v\t0   0\t0  "), "f ", "  f  "));
  read("indices from the end", points + replaced(faces, "f 1 5 7 3", "f -8 -4 -2 -6"));
  read("places in textures and normals", points + "vt 0 0\nvt 1 1\nvn 0 0 1\n" + sides_text("f", 1, "/2/1"));
  read("normals alone", points + "vn 0 0 1\n" + sides_text("f", 1, "//1"));
  read("places in textures alone", points + "vt 0.5\n" + sides_text("f", 1, "/1"));
  read("normals that do not exist at all", points + sides_text("f", 1, "//1"));
  read("colours of vertices", points_text("v ", Vec3::Zero(), 1, " 1 0 0.5") + faces);
  read("colours with four parts", points_text("v ", Vec3::Zero(), 1, " 1 0 0.5 1") + faces);
  read("weights of 1", points_text("v ", Vec3::Zero(), 1, " 1.0") + faces);
  read("weights of 2", points_text("v ", Vec3::Zero(), 2, " 2") + faces);
  read("no end of the last line", box.substr(0, box.size() - 1));
  read("signs", replaced_everywhere(box, "v 1 ", "v +1 "));
  read("exponents", replaced_everywhere(box, "v 1 ", "v 10.0E-01 "));
  read("exponents of Fortran", replaced_everywhere(box, "v 1 ", "v 1.0D0 "));
  read("no digit before the point", replaced_everywhere(replaced_everywhere(box, "v 0 ", "v .0 "), "v 1 ", "v 1. "));
  read("thirty digits", replaced_everywhere(box, "v 1 ", "v 1.000000000000000000000000000000 "));
  read("twenty digits before the point", replaced_everywhere(box, "v 1 ", "v 00000000000000000000001 "));
  read("a number below all doubles", replaced(box, "v 0 0 0", "v 0 1e-400 0"));
  read("lines and points", box + "l 1 2\np 3\n",
       "2 of its lines and points (l, p) were left out: only faces have a surface");
  read("groups, objects and smoothing", "o box\ng a b\ns off\n" + box);
  read("a name with a comment's sign", "o box#1\n" + box);
  read("a missing library", "mtllib none.mtl\n" + box, "its materials are missing");
  read("a folder for a library", "mtllib folder.bin\n" + box, "its materials are missing");
  read("a pipe for a library", "mtllib pipe.bin\n" + box, "its materials are missing");
  read("a pipe for a texture", "mtllib pipe.mtl\nusemtl skin\nvt 0 0\n" + points + sides_text("f", 1, "/1"),
       "texture 'pipe.bin' is missing");
  read("a face of two corners", box + "f 1 2\n", "1 faces of fewer than three corners were left out");
  read("an unknown line", box + "extra 1 2 3\n", "1 line unknown to OBJ was left out, the first is line 15");
  read("faces before vertices", faces + points);
  files.push_back({"far away", ".obj", points_text("v ", far_away, 2) + faces, "", "", Vec3(2, 2, 2), 8});
  files.push_back(
      {"far away and small", ".obj",
       replaced_everywhere(points_text("v ", Vec3(4.5e6, 0, 0), 0.125), "4500000.125", "4500000.1250") + faces, "", "",
       Vec3(0.125, 0.125, 0.125), 0.125 * 0.125 * 0.125});
  files.push_back(
      {"far away with weights", ".obj", points_text("v ", 2 * far_away, 4, " 2") + faces, "", "", Vec3(2, 2, 2), 8});
  refused("decimal commas", replaced(box, "v 1 0 0", "v 0,5 0,5 0,5"),
          ":2:3: '0,5' is not a coordinate (decimal commas are not read: 0.5)");
  refused("commas between numbers", replaced(box, "v 1 0 0", "v 1,0,0"), ":2:1: a vertex of 1 numbers");
  refused("hexadecimal numbers", replaced(box, "v 1 0 0", "v 0x10 0 0"), ":2:3: '0x10' is not a coordinate");
  refused("words", replaced(box, "v 1 0 0", "v one 0 0"), ":2:3: 'one' is not a coordinate");
  refused("a unit", replaced(box, "v 1 0 0", "v 1 0 0m"), ":2:7: '0m' is not a coordinate");
  refused("two points in a number", replaced(box, "v 1 0 0", "v 1.0.0 0 0"), ":2:3: '1.0.0' is not");
  refused("nan", replaced(box, "v 1 0 0", "v nan 0 0"), ":2:3: a coordinate is not finite: nan");
  refused("inf", replaced(box, "v 1 0 0", "v 1 -inf 0"), ":2:5: a coordinate is not finite: -inf");
  refused("above all doubles", replaced(box, "v 1 0 0", "v 1e400 0 0"), ":2:3: '1e400' is not a coordinate");
  refused("above all floats", replaced(box, "v 1 0 0", "v 1e39 0 0"), ":2:3: a coordinate is beyond 3.4e38");
  refused("two coordinates", replaced(box, "v 1 0 0", "v 1 0"), ":2:1: a vertex of 2 numbers");
  refused("five numbers of a vertex", replaced(box, "v 1 0 0", "v 1 0 0 1 1"), ":2:1: a vertex of 5 numbers");
  refused("two vertices on a line", replaced(box, "v 0 0 0\nv 1 0 0", "v 0 0 0 v 1 0 0"),
          ":1:9: 'v' is not a coordinate");
  refused("a weight of 0", replaced(box, "v 1 0 0", "v 1 0 0 0"), ":2:9: a vertex of weight 0");
  refused("a vertex that is missing", replaced(box, "v 0 0 0\n", ""),
          ":9:7: a face names vertex 8, but the file has 7");
  refused("index 9", replaced(box, "f 1 5 7 3", "f 1 5 9 3"), ":9:7: a face names vertex 9, but the file has 8");
  refused("index 0", replaced(box, "f 1 5 7 3", "f 0 5 7 3"), ":9:3: a face names vertex 0: they count from 1");
  refused("index -9", replaced(box, "f 1 5 7 3", "f -9 5 7 3"), ":9:3: a face names vertex -9, but 8 stand before it");
  refused("index of 30 digits", replaced(box, "f 1 5 7 3", "f 1 5 7 " + std::string(30, '3')), ":9:9: '3333");
  refused("a word for an index", replaced(box, "f 1 5 7 3", "f 1 5 x 3"), ":9:7: 'x' is not a corner of a face");
  refused("an index with a fraction", replaced(box, "f 1 5 7 3", "f 1.0 5 7 3"), ":9:3: '1.0' is not a corner");
  refused("commas between indices", replaced(box, "f 1 5 7 3", "f 1,5,7,3"), ":9:3: '1,5,7,3' is not a corner");
  refused("four parts of a corner", replaced(box, "f 1 5 7 3", "f 1/1/1/1 5 7 3"), ":9:3: '1/1/1/1' is not a corner");
  refused("a texture's place that is missing", points + "vt 0 0\n" + sides_text("f", 1, "/2"),
          ":10:5: a face names texture coordinate 2");
  refused("a normal that is missing", points + "vn 0 0 1\n" + sides_text("f", 1, "//2"),
          ":10:6: a face names normal 2");
  refused("capitals", replaced(box, "v 1 0 0", "V 1 0 0"), ":2:1: 'V' begins no line of OBJ");
  refused("a line of numbers", replaced(box, "v 1 0 0", "1 0 0"), ":2:1: '1' begins no line of OBJ");
  refused("no faces", points, ":8: the file has 8 vertices, and no faces");
  refused("characters of 16 bits", wide(box), "is a text of 16-bit characters");
  refused("another format inside", "pl\nformat ascii 1.0\n" + points_text(""), ":3:1: '0' begins no line of OBJ");
}

void add_off(std::vector<OddFile>& files) {
  const std::string points = points_text(""), faces = sides_text("4", 0), box = "OFF\n8 6 12\n" + points + faces;
  const auto read = [&](const char* what, const std::string& bytes, const std::string& remark = "") {
    files.push_back({what, ".off", bytes, "", remark});
  };
  const auto refused = [&](const char* what, const std::string& bytes, const std::string& refusal) {
    files.push_back({what, ".off", bytes, refusal});
  };
  read("plain", box);
  read("a byte-order mark", mark + box);
  read("lines of Windows", windows(box));
  read("lines of old Macs", old_mac(box));
  read("comments",
       "# by hand\n" + replaced(replaced(box, "12\n", "12 # edges\n\n# the corners\n"), "4 0 4", "# first\n4 0 4"));
  read("comments at the ends of lines",
       replaced(replaced(box, "0 0 0\n", "0 0 0 # 1,5\n"), "4 0 4 6 2", "4 0 4 6 2 # x"));
  read("counts beside OFF", replaced(box, "OFF\n", "OFF "));
  read("no number of edges", replaced(box, "8 6 12", "8 6"));
  read("no OFF", replaced(box, "OFF\n", ""));
  read("blank lines", replaced_everywhere(box, "\n", "\n\n"));
  read("a vertex on two lines", replaced(box, "1 0 0\n", "1\n0 0\n"));
  read("colours of vertices", "COFF\n8 6 12\n" + points_text("", Vec3::Zero(), 1, " 1 0 0 1") + faces);
  read("colours of three parts and comments",
       "COFF\n8 6 12\n" + points_text("", Vec3::Zero(), 1, " 1 0 0.5#red") + faces);
  read("all that a vertex may have",
       "STCN4OFF\n8 6 12\n" + points_text("", Vec3::Zero(), 2, " 2 0 0 1 1 0 0.5 0 1") + faces);
  read("colours of vertices in a plain file",
       "OFF\n8 6 12\n" + points_text("", Vec3::Zero(), 1, " 255 0 0 255") + faces);
  read("normals", "NOFF\n8 6 12\n" + points_text("", Vec3::Zero(), 1, " 0 0 1") + faces);
  read("weights of 2", "4OFF\n8 6 12\n" + points_text("", Vec3::Zero(), 2, " 2") + faces);
  read("a dimension", "nOFF\n3\n8 6 12\n" + points + faces);
  read("colours of faces", replaced(box, "4 0 4 6 2\n", "4 0 4 6 2 255 0 0\n"));
  read("colours of faces with fractions", replaced(box, "4 0 4 6 2\n", "4 0 4 6 2 0.5 0 1 1\n"));
  read("a face of two corners", replaced(box, "8 6 12", "8 7 12") + "2 0 1\n", "1 faces of fewer than three corners");
  read("exponents of Fortran", replaced_everywhere(box, "\n1 ", "\n1.0D0 "));
  files.push_back(
      {"far away", ".off", "OFF\n8 6 0\n" + points_text("", far_away, 2) + faces, "", "", Vec3(2, 2, 2), 8});
  refused("index 8", replaced(box, "4 0 4 6 2", "4 0 4 8 2"),
          ":11:7: a face names vertex 8, but there are 8 (counted from 0)");
  refused("index -1", replaced(box, "4 0 4 6 2", "4 0 4 -1 2"), ":11:7: a face names vertex -1");
  refused("a vertex too few announced", replaced(box, "8 6 12", "7 6 12"),
          ":12:7: a face names vertex 7, but there are 7");
  refused("a vertex too many announced", replaced(box, "8 6 12", "9 6 12"),
          "6 faces announced, but the file ends after 5");
  refused("a face too few announced", replaced(box, "8 6 12", "8 5 12"),
          ":16:1: 8 vertices and 5 faces announced, but more follows");
  refused("a face too many announced", replaced(box, "8 6 12", "8 7 12"),
          ":16: 7 faces announced, but the file ends after 6");
  refused("half of the faces", box.substr(0, box.size() - 30), "6 faces announced, but the file ends after 3");
  refused("decimal commas", replaced(box, "\n1 0 0", "\n1,5 0 0"), ":4:1: '1,5' is not a coordinate (decimal commas");
  refused("hexadecimal numbers", replaced(box, "\n1 0 0", "\n0x1 0 0"), ":4:1: '0x1' is not a coordinate");
  refused("words", replaced(box, "\n1 0 0", "\none 0 0"), ":4:1: 'one' is not a coordinate");
  refused("nan", replaced(box, "\n1 0 0", "\nnan 0 0"), ":4:1: a coordinate is not finite");
  refused("a word for an index", replaced(box, "4 0 4 6 2", "4 0 x 6 2"), ":11:5: 'x' is not a vertex of a face");
  refused("an index with a fraction", replaced(box, "4 0 4 6 2", "4 0 4.5 6 2"),
          ":11:5: '4.5' is not a vertex of a face");
  refused("a negative count", replaced(box, "8 6 12", "-8 6 12"), ":2:1: the number of vertices is negative: -8");
  refused("a word for a count", replaced(box, "8 6 12", "eight 6 12"), ":2:1: 'eight' is not the number of vertices");
  refused("binary", replaced(box, "OFF\n", "OFF BINARY\n"), "binary OFF files are not read");
  refused("four dimensions", "nOFF\n4\n8 6 12\n" + points + faces, "the dimension must be 3");
  refused("another word", replaced(box, "OFF\n", "XOFF\n"), ":1:1: 'XOFF' stands where OFF should");
  refused("text at the end", box + "the end\n", ":17:1: 8 vertices and 6 faces announced, but more follows them");
  refused("words after a face", replaced(box, "4 0 4 6 2\n", "4 0 4 6 2 red\n"),
          ":11:11: 'red' is not a number of a face's colour");
  refused("characters of 16 bits", wide(box), "is a text of 16-bit characters");
}

std::string ply_head(const char* format, int vertices, int faces, const char* number = "float") {
  return fmt::format(
      "ply\nformat {} 1.0\ncomment made by hand\nelement vertex {}\nproperty {} x\nproperty {} y\nproperty {} z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      format, vertices, number, number, number, faces);
}

void add_ply_texts(std::vector<OddFile>& files) {
  const std::string points = points_text(""), faces = sides_text("4", 0),
                    box = ply_head("ascii", 8, 6) + points + faces;
  const auto read = [&](const char* what, const std::string& bytes, const std::string& remark = "") {
    files.push_back({what, ".ply", bytes, "", remark});
  };
  const auto refused = [&](const char* what, const std::string& bytes, const std::string& refusal) {
    files.push_back({what, ".ply", bytes, refusal});
  };
  read("plain", box);
  read("a byte-order mark", mark + box);
  read("lines of Windows", windows(box));
  read("lines of old Macs", old_mac(box));
  read("doubles", ply_head("ascii", 8, 6, "double") + points + faces);
  read("whole coordinates", ply_head("ascii", 8, 6, "int") + points + faces);
  read("the newer names of types",
       replaced(ply_head("ascii", 8, 6, "float32"), "uchar int", "uint8 int32") + points + faces);
  read("vertex_index", replaced(box, "vertex_indices", "vertex_index"));
  read("obj_info", replaced(box, "comment", "obj_info"));
  read("blank lines", replaced(replaced(box, "end_header\n", "end_header\n\n"), "4 0 4", "\n\n4 0 4"));
  read("no end of the last line", box.substr(0, box.size() - 1));
  read("colours", replaced(ply_head("ascii", 8, 6), "property float z\n",
                           "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n") +
                      points_text("", Vec3::Zero(), 1, " 255 0 10") + faces);
  read("normals before positions",
       replaced(ply_head("ascii", 8, 6), "property float x\n",
                "property float nx\nproperty float ny\nproperty float nz\nproperty float x\n") +
           points_text("0 0 1 ") + faces);
  read("a number of faces",
       replaced(ply_head("ascii", 8, 6), "int vertex_indices\n", "int vertex_indices\nproperty uchar quality\n") +
           points + replaced_everywhere(faces, "\n", " 7\n"));
  read("edges", replaced(ply_head("ascii", 8, 6), "end_header",
                         "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header") +
                    points + faces + "0 1\n");
  files.push_back({"far away", ".ply", ply_head("ascii", 8, 6, "double") + points_text("", far_away, 2) + faces, "", "",
                   Vec3(2, 2, 2), 8});
  refused("a vertex too few announced", replaced(box, "vertex 8", "vertex 7"), ":18:");
  refused("a vertex too many announced", replaced(box, "vertex 8", "vertex 9"), ":19:7: 'vertex' 9 of 9 has 5 numbers");
  refused("twelve faces announced, six there", replaced(box, "face 6", "face 12"),
          ":24: 12 of 'face' announced, but the file ends after 6");
  refused("a face too few announced", replaced(box, "face 6", "face 5"),
          ":24: 8 of 'vertex' and 5 of 'face' announced, but more lines follow");
  refused("index 8", replaced(box, "4 0 4 6 2", "4 0 4 8 2"), ":19:7: a face names vertex 8, but there are 8");
  refused("index -1", replaced(box, "4 0 4 6 2", "4 0 4 -1 2"), ":19:7: a face names vertex -1");
  refused("decimal commas", replaced(box, "\n1 0 0", "\n0,5 0 0"), ":12:1: '0,5' is not a coordinate (decimal commas");
  refused("hexadecimal numbers", replaced(box, "\n1 0 0", "\n0x1 0 0"), ":12:1: '0x1' is not a coordinate");
  refused("words", replaced(box, "\n1 0 0", "\none 0 0"), ":12:1: 'one' is not a coordinate");
  refused("nan", replaced(box, "\n1 0 0", "\nnan 0 0"), ":12:1: a coordinate is not finite");
  refused("a number too many", replaced(box, "\n1 0 0", "\n1 0 0 0"),
          ":12:7: 'vertex' 2 of 8 has 4 numbers, of which 3 are announced");
  refused("a number too few", replaced(box, "\n1 0 0", "\n1 0"), ":12: 'vertex' 2 of 8 ends after 2 numbers");
  refused("a face longer than its line", replaced(box, "4 0 4 6 2", "5 0 4 6 2"),
          ":19: 'face' 1 of 6 ends after 5 numbers");
  refused("a face shorter than its line", replaced(box, "4 0 4 6 2", "3 0 4 6 2"),
          ":19:9: 'face' 1 of 6 has 5 numbers");
  refused("a fraction of a whole number", ply_head("ascii", 8, 6, "int") + replaced(points, "1 0 0", "0.5 0 0") + faces,
          ":12:1: 0.5 stands where a whole number");
  refused("an index with a fraction", replaced(box, "4 0 4 6 2", "4 0 4.5 6 2"),
          ":19:5: '4.5' is not a vertex of a face");
  refused("a word for a length", replaced(box, "4 0 4 6 2", "four 0 4 6 2"), ":19:1: 'four' is not the length");
  refused("a negative length", replaced(box, "4 0 4 6 2", "-4 0 4 6 2"), ":19:1: the length of 'vertex_indices' is -4");
  refused("no z", replaced(box, "property float z\n", ""), "a vertex must have one x, one y and one z");
  refused("an unknown type", replaced(box, "float x", "half x"), ":5:10: 'half' is no type of PLY");
  refused("an unknown format", replaced(box, "ascii", "text"), ":2:8: format 'text' is not known");
  read("an unknown line in the header", replaced(box, "comment made", "made"),
       "1 lines unknown to PLY in its header were left out");
  refused("no end of the header", replaced(box, "end_header\n", ""), "has a header without an end (end_header)");
  refused("no faces", replaced(box, "face 6", "face 0"), "8 of 'vertex' and 0 of 'face'");
  refused("an element that stands twice", replaced(box, "end_header", "element face 1\nproperty int a\nend_header"),
          "'face' is announced twice");
  refused("a coordinate that stands twice", replaced(box, "property float y", "property float x"),
          "a vertex must have one x, one y and one z");
  refused("strips of triangles",
          replaced(ply_head("ascii", 8, 1), "element face", "element tristrips") + points + "4 0 1 2 3\n",
          "its triangles stand in strips (tristrips), which are not read");
  refused("a negative count", replaced(box, "vertex 8", "vertex -8"), ":4:16: -8 of 'vertex' announced");
  refused("a property before all elements", replaced(box, "element vertex", "property float w\nelement vertex"),
          ":4:1: a property before the first element");
  refused("text at the end", box + "the end\n", ":25: 8 of 'vertex' and 6 of 'face' announced, but more lines follow");
}

template <class T>
std::string ply_bytes(bool big_endian, int vertices, int faces, const Vec3& at = Vec3::Zero(), double scale = 1) {
  std::string bytes = ply_head(big_endian ? "binary_big_endian" : "binary_little_endian", vertices, faces,
                               sizeof(T) == 8 ? "double" : "float");
  for (const auto& p : unit_box.points.rowwise())
    for (int k = 0; k < 3; ++k) append(bytes, T(scale * p[k] + at[k]), big_endian);
  for (const auto& side : sides) {
    append(bytes, std::uint8_t(4));
    for (const int v : side) append(bytes, std::int32_t(v), big_endian);
  }
  return bytes;
}

void add_ply_bytes(std::vector<OddFile>& files) {
  const auto read = [&](const char* what, const std::string& bytes, const std::string& remark = "") {
    files.push_back({what, ".ply", bytes, "", remark});
  };
  const auto refused = [&](const char* what, const std::string& bytes, const std::string& refusal) {
    files.push_back({what, ".ply", bytes, refusal});
  };
  const std::string box = ply_bytes<float>(false, 8, 6);
  read("binary", box);
  read("binary, the great byte first", ply_bytes<float>(true, 8, 6));
  read("binary doubles", ply_bytes<double>(false, 8, 6));
  read("binary doubles, the great byte first", ply_bytes<double>(true, 8, 6));
  read("a mark before binary", mark + box);
  read("a line's end after binary", box + "\n");
  files.push_back({"binary, far away", ".ply", ply_bytes<double>(false, 8, 6, far_away, 2), "", "", Vec3(2, 2, 2), 8});
  files.push_back(
      {"binary, far away, great byte", ".ply", ply_bytes<double>(true, 8, 6, far_away, 2), "", "", Vec3(2, 2, 2), 8});
  files.push_back({"binary floats, far away", ".ply", ply_bytes<float>(false, 8, 6, Vec3(5e5, 0, 0), 2), "",
                   "it lies 5e+05 from the origin, where positions are exact to 0.031", Vec3(2, 2, 2), 8});
  refused("binary, a vertex too few", ply_bytes<float>(false, 7, 6), "");
  files.back().refusal = "cannot be read: ";
  refused("binary, a vertex too many", ply_bytes<float>(false, 9, 6), "cannot be read: ");
  refused("binary, a face too few", ply_bytes<float>(false, 8, 5), "17 bytes follow the last of what is announced");
  refused("binary, twelve faces announced", ply_bytes<float>(false, 8, 12), "");
  files.back().refusal = "12 of 'face' announced, but the file ends in number 7";
  refused("binary, cut off", box.substr(0, box.size() - 20), "6 of 'face' announced, but the file ends in number 5");
  refused("binary, text at the end", box + "the end", "7 bytes follow the last");
  std::string bad = box;
  bad[bad.size() - 4] = 8;
  refused("binary, index 8", bad, "face 6 names vertex 8, but there are 8 (counted from 0)");
  bad[bad.size() - 1] = char(0xff);
  refused("binary, a negative index", bad, "face 6 names vertex -");
  refused("binary, nan", ply_bytes<double>(false, 8, 6, Vec3(nan, 0, 0)), "vertex 1 is not finite");
}

std::string stl_text(const Vec3& at = Vec3::Zero(), double scale = 1, const std::string& head = "solid box") {
  std::string text = head + "\n";
  for (const auto& t : unit_box.triangles.rowwise()) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = scale * unit_box.points.row(t[k]).transpose() + at;
      text += fmt::format("vertex {} {} {}\n", p.x(), p.y(), p.z());
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid box\n";
}

std::string stl_bytes(std::uint32_t announced, const Vec3& at = Vec3::Zero(), double scale = 1) {
  std::string bytes(80, ' ');
  append(bytes, announced);
  for (const auto& t : unit_box.triangles.rowwise()) {
    for (int k = 0; k < 3; ++k) append(bytes, 0.0f);
    for (int k = 0; k < 9; ++k) append(bytes, float(scale * unit_box.points(t[k / 3], k % 3) + at[k % 3]));
    append(bytes, std::uint16_t(0));
  }
  return bytes;
}

std::string upper(std::string text) {
  for (char& c : text) c = char(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

void add_stl(std::vector<OddFile>& files) {
  const std::string box = stl_text();
  const auto read = [&](const char* what, const std::string& bytes, const std::string& remark = "") {
    files.push_back({what, ".stl", bytes, "", remark});
  };
  const auto refused = [&](const char* what, const std::string& bytes, const std::string& refusal) {
    files.push_back({what, ".stl", bytes, refusal});
  };
  read("plain", box);
  read("capitals", upper(box));
  read("SOLID in capitals", replaced(box, "solid", "SOLID"));
  read("a byte-order mark", mark + box);
  read("lines of Windows", windows(box));
  read("lines of old Macs", old_mac(box));
  read("no name", replaced(replaced(box, "solid box", "solid"), "endsolid box", "endsolid"));
  read("a name of many words", replaced(box, "solid box", "solid a box of facet 1,5 and more"));
  read("blank lines first", "\n\n" + box);
  read("lines that are moved in", replaced_everywhere(box, "\nvertex", "\n\t  vertex"));
  read("two solids", replaced(box, "endfacet\nfacet", "endfacet\nendsolid a\nsolid b\nfacet"));
  read("normals that are no numbers", replaced(box, "normal 0 0 0", "normal nan -nan inf"));
  read("no endsolid", replaced(box, "endsolid box\n", ""), "ends without endsolid");
  read("exponents of Fortran", replaced_everywhere(box, "vertex 1 ", "vertex 1.0D0 "));
  files.push_back({"far away", ".stl", stl_text(far_away, 2), "", "", Vec3(2, 2, 2), 8});
  refused("decimal commas", replaced(box, "vertex 0 0 0", "vertex 0,5 0 0"),
          ":4:8: '0,5' is not a coordinate (decimal commas");
  refused("hexadecimal numbers", replaced(box, "vertex 0 0 0", "vertex 0x1 0 0"), ":4:8: '0x1' is not a coordinate");
  refused("words", replaced(box, "vertex 0 0 0", "vertex one 0 0"), ":4:8: 'one' is not a coordinate");
  refused("nan", replaced(box, "vertex 0 0 0", "vertex nan 0 0"), ":4:8: a coordinate is not finite");
  refused("four corners", replaced(box, "endloop", "vertex 0 0 5\nendloop"),
          ":7:1: 'vertex' stands where endloop should");
  refused("two corners", replaced(box, "vertex 0 0 0\n", ""), ":6:1: 'endloop' stands where vertex should");
  refused("two coordinates", replaced(box, "vertex 0 0 0", "vertex 0 0"), ":5:1: 'vertex' is not a coordinate");
  refused("four coordinates", replaced(box, "vertex 0 0 0", "vertex 0 0 0 0"), ":4:14: '0' stands where vertex should");
  refused("cut off", replaced(box, "endfacet\nendsolid box\n", ""),
          ":84: the file ends within facet 12: endfacet should stand here");
  refused("no facets", "solid box\nendsolid box\n", ":2: the file has no facets");
  refused("text among the facets", replaced(box, "endfacet\n", "endfacet\nhere\n"),
          ":9:1: 'here' stands where facet, solid or endsolid should");
  refused("characters of 16 bits", wide(box), "is a text of 16-bit characters");
  const std::string bytes = stl_bytes(12);
  read("binary", bytes);
  read("binary that says solid", "solid" + bytes.substr(5));
  read("bytes after the last facet", bytes + "made by hand", "12 bytes after the last of 12 facets are not read");
  read("fewer facets than announced", stl_bytes(20), "20 facets announced, but the file has 12; those are closed");
  read("no facet announced", stl_bytes(0), "0 facets announced, but the file has 12; those are closed");
  files.push_back({"binary, far away", ".stl", stl_bytes(12, Vec3(5e5, 0, 0), 2), "", "positions are exact to 0.031",
                   Vec3(2, 2, 2), 8});
  refused("a facet too few announced", stl_bytes(11), "11 facets announced, but the file has 12");
  refused("binary, cut off", bytes.substr(0, bytes.size() - 60), "12 facets announced, but the file has 10");
  refused("binary, nan", stl_bytes(12, Vec3(nan, 0, 0)), "is not finite");
  refused("shorter than a head", "abc", "neither STL as text, which begins with solid, nor binary STL");
}

std::string base64(const std::string& bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned block = 0;
    for (std::size_t k = 0; k < 3; ++k) block = block << 8 | (i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : 0u);
    for (int k = 3; k >= 0; --k) text += i + std::size_t(3 - k) <= bytes.size() ? digits[block >> (6 * k) & 63] : '=';
  }
  return text;
}

std::string gltf_data() {
  std::string data;
  for (const double x : unit_box.points.reshaped<Eigen::RowMajor>()) append(data, float(x));
  for (const std::int32_t v : unit_box.triangles.reshaped<Eigen::RowMajor>()) append(data, std::uint16_t(v));
  return data;
}

std::string gltf_text(const std::string& uri) {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
"buffers": [{)" +
         (uri.empty() ? "" : "\"uri\": \"" + uri + "\", ") + R"("byteLength": 168}],
"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
{"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}]})";
}

std::string glb_bytes(std::string text, std::string data) {
  while (text.size() % 4 != 0) text += ' ';
  while (data.size() % 4 != 0) data += '\0';
  std::string bytes = "glTF";
  append(bytes, std::uint32_t(2));
  append(bytes, std::uint32_t(28 + text.size() + data.size()));
  append(bytes, std::uint32_t(text.size()));
  bytes += "JSON" + text;
  append(bytes, std::uint32_t(data.size()));
  bytes += std::string("BIN\0", 4) + data;
  return bytes;
}

void add_gltf(std::vector<OddFile>& files) {
  const auto inside = [](const std::string& data) { return "data:application/octet-stream;base64," + base64(data); };
  const std::string data = gltf_data(), box = gltf_text(inside(data));
  const auto read = [&](const char* what, const std::string& bytes) { files.push_back({what, ".gltf", bytes, ""}); };
  const auto refused = [&](const char* what, const std::string& bytes, const std::string& refusal) {
    files.push_back({what, ".gltf", bytes, refusal});
  };
  const auto with = [&](std::size_t at, const auto& value) {
    std::string changed = data;
    std::memcpy(changed.data() + at, &value, sizeof value);
    return gltf_text(inside(changed));
  };
  read("plain", box);
  read("a byte-order mark", mark + box);
  read("lines of Windows", windows(box));
  read("data in a file beside it", gltf_text("box.bin"));
  read("data in a file with a space in its name", gltf_text("my%20box.bin"));
  read("a longer buffer", gltf_text(inside(data + "more")));
  files.push_back({"a node that scales", ".gltf", replaced(box, "\"mesh\": 0}", "\"mesh\": 0, \"scale\": [2, 1, 1]}"),
                   "", "", Vec3(2, 1, 1), 2});
  files.push_back({"a node far away", ".gltf",
                   replaced(box, "\"mesh\": 0}", "\"mesh\": 0, \"translation\": [500000, 0, 0]}"), "",
                   "positions are exact to 0.031"});
  files.push_back({"binary", ".glb", glb_bytes(gltf_text(""), data), ""});
  files.push_back({"bytes after a binary one", ".glb", glb_bytes(gltf_text(""), data) + "more", ""});
  refused("an index too large", with(96, std::uint16_t(8)), "accessor 1: index 0 names vertex 8, but there are 8");
  refused("an index far too large", with(166, std::uint16_t(60000)), "accessor 1: index 35 names vertex 60000");
  refused("a position that is not finite", with(12, std::numeric_limits<float>::quiet_NaN()),
          "accessor 0: position 1 is not finite");
  refused("a buffer too short", gltf_text(inside(data.substr(0, 160))),
          "buffer 0: 168 bytes announced, but it has 160");
  refused("a missing buffer", gltf_text("none.bin"), "buffer 0: none.bin: no such file");
  refused("a pipe for a buffer", gltf_text("pipe.bin"), "buffer 0: pipe.bin: is not a file");
  refused("a folder for a buffer", gltf_text("folder.bin"), "buffer 0: folder.bin: is not a file");
  refused("a device for a buffer", gltf_text("/dev/zero"), "buffer 0: zero: is not a file");
  refused("no buffer's place", gltf_text(""), "buffer 0: it has no uri");
  refused("a view beyond its buffer", replaced(box, "\"byteLength\": 72", "\"byteLength\": 80"),
          "buffer view 1: it ends at byte 176, but its buffer has 168");
  refused("an accessor beyond its view", replaced(box, "\"count\": 36", "\"count\": 39"),
          "accessor 1: 39 elements announced, for which the 72 bytes of its view have no room");
  refused("positions beyond their view", replaced(box, "\"count\": 8", "\"count\": 9"),
          "accessor 0: 9 elements announced");
  refused("a vertex too few announced", replaced(box, "\"count\": 8", "\"count\": 7"),
          "names vertex 7, but there are 7");
  refused("corners that make no triangles", replaced(box, "\"count\": 36", "\"count\": 35"),
          "35 corners are no multiple of 3");
  refused("a count of 0", replaced(box, "\"count\": 36", "\"count\": 0"), "accessor 1: its count is 0 or missing");
  refused("a negative count", replaced(box, "\"count\": 36", "\"count\": -36"), "accessor 1: count is -36");
  refused("a word for a count", replaced(box, "\"count\": 36", "\"count\": \"many\""), "accessor 1: count is \"many\"");
  refused("positions of two numbers", replaced(box, "VEC3", "VEC2"), "accessor 0 of its positions is no VEC3");
  refused("indices that are floats", replaced(box, "5123, \"count\": 36", "5126, \"count\": 18"),
          "holds no unsigned whole numbers");
  refused("indices of a missing accessor", replaced(box, "\"indices\": 1", "\"indices\": 7"),
          "indices is 7, but there are 2 accessors");
  refused("an unknown type of number", replaced(box, "5123", "9999"), "accessor 1: componentType 9999 is not known");
  refused("a step shorter than an element",
          replaced(box, "\"byteLength\": 96", "\"byteLength\": 96, \"byteStride\": 4"),
          "byteStride is 4, but an element has 12 bytes");
  refused("a node that is its own child", replaced(box, "\"mesh\": 0}", "\"mesh\": 0, \"children\": [0]}"),
          "node 0 is among its own descendants");
  refused("a child that does not exist", replaced(box, "\"mesh\": 0}", "\"mesh\": 0, \"children\": [4]}"),
          "node 0: child 4 does not exist");
  refused("a mesh that does not exist", replaced(box, "\"mesh\": 0}", "\"mesh\": 3}"),
          "node 0: mesh is 3, but there are 1 meshes");
  refused("a scene's node that does not exist", replaced(box, "\"nodes\": [0]", "\"nodes\": [5]"),
          "scene 0: node 5 does not exist");
  refused("a missing comma", replaced(box, "\"mesh\": 0}],", "\"mesh\": 0}]"), ":3:8: is no JSON");
  refused("a decimal comma", replaced(box, "\"mesh\": 0}", "\"mesh\": 0, \"translation\": [0,5, 0, 0]}"),
          "node 0: translation is [0,5,0,0]: 3 numbers are wanted");
  refused("words for numbers", replaced(box, "\"mesh\": 0}", "\"mesh\": 0, \"scale\": [\"2\", 1, 1]}"),
          "node 0: scale is [\"2\",1,1]: 3 numbers are wanted");
  refused("a hexadecimal number", replaced(box, "\"count\": 36", "\"count\": 0x24"), ":7:52: is no JSON");
  refused("half of it", box.substr(0, box.size() / 2), "is no JSON");
  refused("version 3", replaced(box, "\"2.0\"", "\"3.0\""), "glTF of version '3.0' is not read");
  refused("no asset", "{}", "is no glTF: it has no asset");
  refused("compressed meshes",
          replaced(box, "\"scene\": 0", "\"extensionsRequired\": [\"EXT_meshopt_compression\"], \"scene\": 0"),
          "compressed (EXT_meshopt_compression)");
  const std::string binary = glb_bytes(gltf_text(""), data);
  files.push_back(
      {"binary, cut off", ".glb", binary.substr(0, binary.size() - 20), "bytes announced, but the file has"});
  std::string chunk = binary;
  chunk[12] = char(0xff), chunk[14] = 1;
  files.push_back({"binary, a chunk too large", ".glb", chunk, "a chunk announces"});
}

std::string collada_text() {
  std::string points, corners;
  for (const double x : unit_box.points.reshaped<Eigen::RowMajor>()) points += fmt::format("{} ", x);
  for (const std::int32_t v : unit_box.triangles.reshaped<Eigen::RowMajor>()) corners += fmt::format("{} ", v);
  return "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">\n"
         "<asset><up_axis>Y_UP</up_axis></asset>\n<library_geometries><geometry id=\"g\"><mesh>\n"
         "<source id=\"p\"><float_array id=\"pa\" count=\"24\">\n" +
         points +
         "\n</float_array><technique_common><accessor source=\"#pa\" count=\"8\" stride=\"3\">"
         "<param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/>"
         "</accessor></technique_common></source>\n<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/>"
         "</vertices>\n<triangles count=\"12\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>\n<p>" +
         corners +
         "</p></triangles></mesh></geometry></library_geometries>\n<library_visual_scenes><visual_scene id=\"vs\">"
         "<node id=\"n\"><instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes>\n"
         "<scene><instance_visual_scene url=\"#vs\"/></scene></COLLADA>\n";
}

void add_others(std::vector<OddFile>& files) {
  const std::string box = points_text("v ") + sides_text("f", 1);
  const std::string collada = collada_text();
  files.push_back({"plain", ".dae", collada, ""});
  files.push_back({"a byte-order mark", ".dae", mark + collada, ""});
  files.push_back({"lines of Windows", ".dae", windows(collada), ""});
  files.push_back({"decimal commas", ".dae", replaced(collada, "0 0 0 1 0 0", "0,0 0 0 1,0 0 0"), "",
                   "its numbers have decimal commas, which are read as points"});
  files.push_back(
      {"hexadecimal numbers", ".dae", replaced(collada, "0 0 0 1 0 0", "0 0 0 0x1 0 0"), ":6:7: '0x1' is no number"});
  files.push_back({"a number that is missing", ".dae", replaced(collada, "0 0 0 1 0 0", "0 0 0 1 0"),
                   ":5:16: a list announces 24 numbers, and holds 23"});
  files.push_back(
      {"a negative index", ".dae", replaced(collada, "<p>0 4 6", "<p>0 -4 6"), "'-4' is no whole number from 0"});
  files.push_back({"an index too large", ".dae", replaced(collada, "<p>0 4 6", "<p>0 8 6"), "cannot be read: "});
  const auto raw = [](const std::string& one) {
    std::string text;
    for (const auto& t : unit_box.triangles.rowwise())
      for (int k = 0; k < 9; ++k) text += (unit_box.points(t[k / 3], k % 3) > 0 ? one : "0") + (k < 8 ? " " : "\n");
    return text;
  };
  files.push_back({"plain", ".raw", raw("1"), ""});
  files.push_back({"decimal commas", ".raw", raw("1,5"), "is no number (decimal commas are not read: 1.5)"});
  files.push_back({"an unknown format", ".xyz", "hello", "of no format that is read: OBJ, PLY"});
  files.push_back({"a COLLADA file that is none", ".dae", "hello", "cannot be read: "});
  files.push_back({"an FBX file that is none", ".fbx", "hello", "cannot be read: "});
  files.push_back({"a 3DS file that is none", ".3ds", "hello", "cannot be read: "});
  files.push_back({"a 3MF file that is none", ".3mf", "hello", "cannot be read: "});
  files.push_back({"a Blender file that is none", ".blend", "hello", "cannot be read: "});
  files.push_back({"an OBJ file with an ending in capitals", ".OBJ", mark + box, ""});
}

class OddFiles : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_.path / name, std::ios::binary) << bytes;
  }

  test::TemporaryFolder folder_;
};

void expect_remarks(const OddFile& odd, const std::vector<std::string>& remarks) {
  std::string all;
  for (const std::string& remark : remarks) all += remark + '\n';
  if (odd.remark.empty()) {
    EXPECT_EQ(all, "");
    return;
  }
  EXPECT_NE(all.find(odd.remark), std::string::npos) << "found: '" << all << "', expected: '" << odd.remark << "'";
}

TEST_F(OddFiles, OfSurfacesAreReadAsWhatTheySayOrRefusedInWords) {
  std::vector<OddFile> files;
  add_obj(files);
  add_off(files);
  add_ply_texts(files);
  add_ply_bytes(files);
  add_stl(files);
  add_gltf(files);
  add_others(files);
  EXPECT_GE(files.size(), 150u);
  write("box.bin", gltf_data());
  write("my box.bin", gltf_data());
  write("pipe.mtl", "newmtl skin\nKd 1 0 0\nmap_Kd pipe.bin\n");
  ASSERT_EQ(::mkfifo((folder_.path / "pipe.bin").c_str(), 0600), 0);
  std::filesystem::create_directory(folder_.path / "folder.bin");
  for (const OddFile& odd : files) {
    write("odd" + odd.ending, odd.bytes);
    test::expect_as_said(odd, [&] {
      const ColoredSurface found = read_colored_surface(folder_.path / ("odd" + odd.ending));
      std::vector<std::string> notes;
      const TriMesh closed = closed_surface(found.mesh, odd.what, &notes);
      EXPECT_LT((bounds_of(closed.points).extent() - odd.size).norm(), 1e-6) << bounds_of(closed.points).extent();
      EXPECT_NEAR(enclosed_volume(closed), odd.volume, 1e-5 * odd.volume);
      EXPECT_TRUE(notes.empty()) << notes.front();
      expect_remarks(odd, found.remarks);
    });
  }
  rusage used{};
  ::getrusage(RUSAGE_CHILDREN, &used);
  EXPECT_LT(used.ru_maxrss, 2'000'000);  // kB
}

}  // namespace odd_files_test
}  // namespace supple
