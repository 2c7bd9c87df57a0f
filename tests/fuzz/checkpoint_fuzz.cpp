// Any bytes as a checkpoint. The hash at its end is made right, so that what lies between is read.
#include "base/error.h"
#include "base/hash.h"
#include "film/record/checkpoint.h"
#include "fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace supple;
  const std::uint64_t hash = hash_bytes(data, size);
  const std::string end(reinterpret_cast<const char*>(&hash), sizeof hash);
  try {
    (void)read_checkpoint(fuzz::scratch_file(data, size, end), "{}");
  } catch (const InputError&) {
  }
  return 0;
}
