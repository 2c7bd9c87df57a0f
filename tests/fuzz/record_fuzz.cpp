// Any bytes as a record of states, and as the profile of a run.
#include "base/error.h"
#include "film/record/state_record.h"
#include "fuzz/scratch_file.h"
#include "output/run/profile.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace supple;
  const std::filesystem::path file = fuzz::scratch_file(data, size);
  const RecordHead now{"program", "kernels", "{}", {{"body", 1}}};
  try {
    const StateVerifier verifier(file, now, 1e-6, 0);
  } catch (const InputError&) {
  }
  try {
    (void)warnings_of(read_profile(file));
  } catch (const InputError&) {
  }
  return 0;
}
