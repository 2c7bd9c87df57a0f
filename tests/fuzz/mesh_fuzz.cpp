// Any bytes as a mesh of tetrahedra in each format, as the header of a surface, as a surface mesh that was kept, and as
// an array. A zero byte parts the two files of TetGen.
#include <functional>

#include "base/error.h"
#include "fuzz/scratch_file.h"
#include "geometry/files/announced_counts.h"
#include "geometry/files/mesh_file.h"
#include "geometry/files/mesh_formats.h"
#include "geometry/tetrahedra/meshing.h"
#include "output/files/npy.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace supple;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const std::filesystem::path file = fuzz::scratch_file(data, size);
  const std::size_t end = std::min(text.find('\0'), size);
  const std::function<void()> readers[] = {
      [&] { (void)read_medit(text, "file"); },
      [&] { (void)read_gmsh(text, "file"); },
      [&] { (void)read_legacy_vtk(text, "file"); },
      [&] { (void)read_vtu(text, "file"); },
      [&] { (void)read_tetgen(text.substr(0, end), "nodes", text.substr(std::min(end + 1, size)), "elements"); },
      [&] { (void)read_mesh(file); },
      [&] { (void)read_npy_doubles(file); },
  };
  for (const auto& read : readers) {
    try {
      read();
    } catch (const InputError&) {
    }
  }
  (void)announced_too_much(text, size);
  (void)made_mesh_from(text);
  return 0;
}
