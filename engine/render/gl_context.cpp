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

}  // namespace

GlContext::GlContext(GlChoice choice) {
  std::string tried;
  if (choice != GlChoice::egl) {
    const std::string why = open_osmesa();
    if (why.empty()) return;
    tried += "\n  osmesa: " + why;
  }
  if (choice != GlChoice::osmesa) {
    const std::string why = open_egl();
    if (why.empty()) return;
    tried += "\n  egl: " + why;
  }
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

std::string GlContext::open_egl() {
  void* library = open_first({"libEGL.so.1", "libEGL.so"});
  if (library == nullptr) return "libEGL.so.1 is not installed (Debian: libegl1 and libgl1-mesa-dri)";
  const auto get_address = symbol<Function (*)(const char*)>(library, "eglGetProcAddress");
  const auto get_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(get_address("eglGetPlatformDisplayEXT"));
  const auto initialize = symbol<decltype(&eglInitialize)>(library, "eglInitialize");
  const auto bind_api = symbol<decltype(&eglBindAPI)>(library, "eglBindAPI");
  const auto choose = symbol<decltype(&eglChooseConfig)>(library, "eglChooseConfig");
  const auto create = symbol<decltype(&eglCreateContext)>(library, "eglCreateContext");
  const auto make_current = symbol<decltype(&eglMakeCurrent)>(library, "eglMakeCurrent");
  const auto give_up = [&](const char* why) {
    dlclose(library);
    return std::string(why);
  };
  if (get_display == nullptr) return give_up("no eglGetPlatformDisplayEXT");
  EGLDisplay display = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY || !initialize(display, nullptr, nullptr)) {
    return give_up("no surfaceless display (Debian: libegl-mesa0 and libgl1-mesa-dri)");
  }
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
    return give_up("no OpenGL 3.3 core context");
  }
  backend_ = "egl";
  library_ = library;
  display_ = display;
  context_ = context;
  resolve_ = get_address;
  return "";
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
