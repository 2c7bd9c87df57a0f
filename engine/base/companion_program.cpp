#include "base/companion_program.h"

#include <dlfcn.h>

#include <system_error>

namespace supple {

std::filesystem::path this_program() {
  std::error_code error;
  Dl_info place;
  if (dladdr(reinterpret_cast<const void*>(&this_program), &place) != 0 && place.dli_fname != nullptr) {
    const std::filesystem::path file = place.dli_fname;
    if (file.extension() == ".so") return std::filesystem::canonical(file, error);
  }
  return std::filesystem::read_symlink("/proc/self/exe", error);
}

std::optional<std::filesystem::path> companion_program(const std::string& name) {
  std::error_code error;
  const std::filesystem::path folder = this_program().parent_path();
  for (const std::filesystem::path& place :
       {folder / name, folder / SUPPLE_LIBEXEC_FROM_BIN / name, folder / SUPPLE_LIBEXEC_FROM_MODULE / name})
    if (std::filesystem::is_regular_file(place, error)) return place;
  return std::nullopt;
}

}  // namespace supple
