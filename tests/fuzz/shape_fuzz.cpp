// Any text as a shape: its bounds and some distances are computed.
#include "fuzz/scratch_file.h"
#include "scene/reading/shape_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace supple;
  try {
    Config config = Config::parse({reinterpret_cast<const char*>(data), size}, "shape.toml", fuzz::assets);
    const Shape shape = read_shape(config.root());
    config.finish();
    const Bounds box = shape.bounds();
    if (!box.empty()) (void)shape.closest(box.lower + 0.3 * box.extent());
  } catch (const InputError&) {
  }
  return 0;
}
