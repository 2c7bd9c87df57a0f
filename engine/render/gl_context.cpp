#include "render/gl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/osmesa.h>
#include <dlfcn.h>
#include <fmt/core.h>

#include "base/error.h"

namespace supple {
namespace {

void* open_first(std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (void* library = dlopen(name, RTLD_NOW | RTLD_LOCAL)) return library;
  }
  return nullptr;
}

template <class F>
F symbol(void* library, const char* name) {
  return reinterpret_cast<F>(dlsym(library, name));
}

void* open_egl_library() { return open_first({"libEGL.so.1", "libEGL.so"}); }

template <class F>
F egl_function(void* library, const char* name) {
  const auto get_address = symbol<void (*(*)(const char*))()>(library, "eglGetProcAddress");
  return get_address == nullptr ? nullptr : reinterpret_cast<F>(get_address(name));
}

struct EglDevice {
  EGLDeviceEXT handle;
  bool software;
  std::string name;  // a card's device file, or "software"
};

std::vector<EglDevice> find_devices(void* library) {
  std::vector<EglDevice> found;
  const auto query = egl_function<PFNEGLQUERYDEVICESEXTPROC>(library, "eglQueryDevicesEXT");
  const auto text = egl_function<PFNEGLQUERYDEVICESTRINGEXTPROC>(library, "eglQueryDeviceStringEXT");
  if (query == nullptr || text == nullptr) return found;
  constexpr EGLint most = 32;
  EGLDeviceEXT devices[most];
  EGLint count = 0;
  if (!query(most, devices, &count)) return found;
  for (EGLint i = 0; i < count; ++i) {
    const char* extensions = text(devices[i], EGL_EXTENSIONS);
    const std::string_view words = extensions != nullptr ? extensions : "";
    const bool software = words.find("EGL_MESA_device_software") != std::string_view::npos;
    const bool has_file = words.find("EGL_EXT_device_drm") != std::string_view::npos;
    const char* file = has_file && !software ? text(devices[i], EGL_DRM_DEVICE_FILE_EXT) : nullptr;
    found.push_back({devices[i], software,
                     software          ? "software"
                     : file != nullptr ? file
                                       : "a card without a device file"});
  }
  return found;
}

}  // namespace

GlContext::GlContext(GlChoice choice) {
  std::string tried;
  const auto opened = [&](const char* way, const std::string& why) {
    if (!why.empty()) tried += fmt::format("\n  {}: {}", way, why);
    return why.empty();
  };
  if (choice != GlChoice::osmesa && opened("egl, graphics cards", open_cards())) return;
  if (choice != GlChoice::egl && opened("osmesa", open_osmesa())) return;
  if (choice != GlChoice::osmesa && opened("egl, in software", open_egl())) return;
  throw RunError("no OpenGL context could be made; --no-images runs without one:" + tried);
}

std::string GlContext::open_osmesa() {
  void* library = open_first({"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"});
  if (library == nullptr) return "libOSMesa.so.8 is not installed (Debian: libosmesa6)";
  const auto create = symbol<decltype(&OSMesaCreateContextAttribs)>(library, "OSMesaCreateContextAttribs");
  const auto make_current = symbol<decltype(&OSMesaMakeCurrent)>(library, "OSMesaMakeCurrent");
  const auto get_address = symbol<Function (*)(const char*)>(library, "OSMesaGetProcAddress");
  if (create == nullptr || make_current == nullptr || get_address == nullptr) {
    dlclose(library);
    return "libOSMesa is too old: it has no OSMesaCreateContextAttribs";
  }
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_DEPTH_BITS,
                            24,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  OSMesaContext context = create(attributes, nullptr);
  if (context == nullptr) {
    dlclose(library);
    return "no OpenGL 3.3 core context";
  }
  constexpr int edge = 16;
  buffer_.resize(edge * edge * 4);
  if (!make_current(context, buffer_.data(), GL_UNSIGNED_BYTE, edge, edge)) {
    symbol<decltype(&OSMesaDestroyContext)>(library, "OSMesaDestroyContext")(context);
    dlclose(library);
    return "the context could not be made current";
  }
  backend_ = "osmesa";
  library_ = library;
  context_ = context;
  resolve_ = get_address;
  return "";
}

bool GlContext::open_display(void* library, void* display) {
  const auto initialize = symbol<decltype(&eglInitialize)>(library, "eglInitialize");
  const auto bind_api = symbol<decltype(&eglBindAPI)>(library, "eglBindAPI");
  const auto choose = symbol<decltype(&eglChooseConfig)>(library, "eglChooseConfig");
  const auto create = symbol<decltype(&eglCreateContext)>(library, "eglCreateContext");
  const auto make_current = symbol<decltype(&eglMakeCurrent)>(library, "eglMakeCurrent");
  if (display == EGL_NO_DISPLAY || !initialize(display, nullptr, nullptr)) return false;
  bind_api(EGL_OPENGL_API);
  const EGLint config_attributes[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  choose(display, config_attributes, &config, 1, &count);
  const EGLint attributes[] = {
      EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  EGLContext context = create(display, count > 0 ? config : nullptr, EGL_NO_CONTEXT, attributes);
  if (context == EGL_NO_CONTEXT || !make_current(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
    symbol<decltype(&eglTerminate)>(library, "eglTerminate")(display);
    return false;
  }
  backend_ = "egl";
  library_ = library;
  display_ = display;
  context_ = context;
  resolve_ = symbol<Function (*)(const char*)>(library, "eglGetProcAddress");
  return true;
}

std::string GlContext::open_cards() {
  void* library = open_egl_library();
  if (library == nullptr) return "libEGL.so.1 is not installed (Debian: libegl1 and libgl1-mesa-dri)";
  const auto get_display = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>(library, "eglGetPlatformDisplayEXT");
  const std::vector<EglDevice> devices = find_devices(library);
  for (const EglDevice& device : devices) {
    if (device.software || get_display == nullptr) continue;
    if (open_display(library, get_display(EGL_PLATFORM_DEVICE_EXT, device.handle, nullptr))) return "";
  }
  dlclose(library);
  return "no graphics card with OpenGL 3.3";
}

std::string GlContext::open_egl() {
  void* library = open_egl_library();
  if (library == nullptr) return "libEGL.so.1 is not installed (Debian: libegl1 and libgl1-mesa-dri)";
  const auto get_display = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>(library, "eglGetPlatformDisplayEXT");
  if (get_display != nullptr) {
    if (open_display(library, get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr))) return "";
    for (const EglDevice& device : find_devices(library)) {
      if (device.software && open_display(library, get_display(EGL_PLATFORM_DEVICE_EXT, device.handle, nullptr)))
        return "";
    }
  }
  dlclose(library);
  return "neither a surfaceless display nor a device with OpenGL 3.3 (Debian: libegl-mesa0 and libgl1-mesa-dri)";
}

std::vector<std::string> egl_devices() {
  std::vector<std::string> names;
  void* library = open_egl_library();
  if (library == nullptr) return names;
  for (const EglDevice& device : find_devices(library)) names.push_back(device.name);
  dlclose(library);
  return names;
}

// The library stays open, because Mesa's worker threads may outlive the context by a moment.
GlContext::~GlContext() {
  if (display_ != nullptr) {
    symbol<decltype(&eglMakeCurrent)>(library_, "eglMakeCurrent")(display_, EGL_NO_SURFACE, EGL_NO_SURFACE,
                                                                  EGL_NO_CONTEXT);
    symbol<decltype(&eglDestroyContext)>(library_, "eglDestroyContext")(display_, context_);
    symbol<decltype(&eglTerminate)>(library_, "eglTerminate")(display_);
  } else if (context_ != nullptr) {
    symbol<decltype(&OSMesaDestroyContext)>(library_, "OSMesaDestroyContext")(static_cast<OSMesaContext>(context_));
  }
}

}  // namespace supple
