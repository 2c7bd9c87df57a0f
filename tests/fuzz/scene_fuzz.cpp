// Any text as a scene: it is read, or refused with problems, and its document can be written as JSON.
#include "fuzz/scratch_file.h"
#include "scene/reading/scene_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace supple;
  try {
    Config config = Config::parse({reinterpret_cast<const char*>(data), size}, "scene.toml", fuzz::assets);
    (void)read_scene(config);
    (void)config.take_problems();
    (void)config.as_json();
  } catch (const InputError&) {
  }
  return 0;
}
