// Opens the files that assimp asks for: the surface's own, whose checked bytes are given instead, and those that it
// names. Only plain files are opened, because a pipe or a device may have no end. A part of supple-read-surface.
#pragma once

#include <assimp/DefaultIOSystem.h>

#include <string>
#include <string_view>

namespace supple {

class AssimpFiles : public Assimp::DefaultIOSystem {
 public:
  // bytes: the bytes of `file`, which must live as long as assimp reads; empty: the file is read as it is.
  AssimpFiles(std::string file, std::string_view bytes) : file_(std::move(file)), bytes_(bytes) {}

  bool Exists(const char* file) const override;
  Assimp::IOStream* Open(const char* file, const char* mode) override;

  // Returns the name of the last file that could not be opened; empty: there was none.
  const std::string& refused() const { return refused_; }

 private:
  // Returns the name of the plain file: the one given, or that with %20 and the like decoded; empty: there is neither.
  static std::string found(const char* file);

  const std::string file_;
  const std::string_view bytes_;
  std::string refused_;
};

}  // namespace supple
