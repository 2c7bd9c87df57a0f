// Any text as a replay, with all its frames checked.
#include "fuzz/scratch_file.h"
#include "scene/replay/script.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace supple;
  try {
    (void)Script::load(fuzz::scratch_file(data, size), fuzz::assets, {"frames=20"}).warnings();
  } catch (const InputError&) {
  }
  return 0;
}
