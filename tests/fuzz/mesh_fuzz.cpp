// Any bytes as a mesh of tetrahedra, as a surface, and as an array.
#include "base/error.h"
#include "fuzz/scratch_file.h"
#include "geometry/mesh_file.h"
#include "output/npy.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace supple;
  const std::filesystem::path file = fuzz::scratch_file(data, size);
  for (const auto read : {+[](const std::filesystem::path& path) { (void)read_mesh(path); },
                          +[](const std::filesystem::path& path) { (void)read_surface(path); },
                          +[](const std::filesystem::path& path) { (void)read_npy_doubles(path); }}) {
    try {
      read(file);
    } catch (const InputError&) {
    }
  }
  return 0;
}
