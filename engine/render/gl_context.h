// Creates an OpenGL 3.3 core context without a window, through OSMesa, which draws in software, or through EGL, which
// also reaches graphics cards (Mesa dropped OSMesa in 25.1). The libraries are opened at run time, so a machine without
// either can still simulate.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/names.h"

namespace supple {

// The value `automatic` chooses a graphics card where EGL finds one, otherwise OSMesa, otherwise EGL in software; `egl`
// does the same without OSMesa.
enum class GlChoice { automatic, osmesa, egl };
template <>
struct Names<GlChoice> {
  static constexpr std::array table = {Name{GlChoice::automatic, "auto"}, Name{GlChoice::osmesa, "osmesa"},
                                       Name{GlChoice::egl, "egl"}};
};

// Lists what EGL finds on this machine: the device files of graphics cards, and "software" for rasterisers. Empty
// without EGL.
std::vector<std::string> egl_devices();

class GlContext {
 public:
  // Makes the context current on the calling thread, which must be the one that draws with it and destroys it. Throws
  // RunError with what was tried, and with the packages that provide it.
  explicit GlContext(GlChoice choice);
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  using Function = void (*)();
  Function resolve(const char* name) const { return resolve_(name); }
  const char* backend() const { return backend_; }

 private:
  // Each of these functions returns an empty text, or the reason why it failed.
  std::string open_osmesa();
  std::string open_cards();
  std::string open_egl();
  // Tries to create a context on a display of an EGL library that is open.
  bool open_display(void* library, void* display);

  const char* backend_ = "";
  Function (*resolve_)(const char*) = nullptr;
  void* library_ = nullptr;
  void* display_ = nullptr;  // EGL's display
  void* context_ = nullptr;
  std::vector<std::uint8_t> buffer_;  // OSMesa's default framebuffer, which is not the one that we draw to
};

}  // namespace supple
