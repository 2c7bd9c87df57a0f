#include "geometry/reader/assimp_files.h"

#include <assimp/MemoryIOWrapper.h>

#include <filesystem>
#include <system_error>

#include "geometry/reader/uri_names.h"

namespace supple {

std::string AssimpFiles::found(const char* file) {
  for (const std::string& name : {std::string(file), decoded_uri(file)}) {
    std::error_code error;
    if (std::filesystem::is_regular_file(name, error)) return name;
  }
  return "";
}

bool AssimpFiles::Exists(const char* file) const { return !found(file).empty(); }

Assimp::IOStream* AssimpFiles::Open(const char* file, const char* mode) {
  if (file == file_ && !bytes_.empty())
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes_.data()), bytes_.size());
  const std::string name = found(file);
  Assimp::IOStream* const stream = name.empty() ? nullptr : Assimp::DefaultIOSystem::Open(name.c_str(), mode);
  if (stream == nullptr) refused_ = file;
  return stream;
}

}  // namespace supple
