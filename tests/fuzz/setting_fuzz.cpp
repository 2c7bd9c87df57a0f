// Any text as a --set over a scene that ships.
#include "fuzz/scratch_file.h"
#include "scene/reading/scene_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace supple;
  try {
    Config config = Config::load(fuzz::assets / "scenes" / "pulled-bar.toml", fuzz::assets);
    config.set(std::string(reinterpret_cast<const char*>(data), size), exclusive_keys());
    (void)read_scene(config);
    (void)config.take_problems();
  } catch (const InputError&) {
  }
  return 0;
}
