#include "film/machine_findings.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <thread>

#include "base/text.h"
#include "base/user_cache.h"
#include "base/variants.h"
#include "film/plan/shipped_files.h"
#include "geometry/files/surface_file.h"
#include "output/files/child_program.h"
#include "output/files/exr_file.h"
#include "output/run/run_folder.h"
#include "render/font_search.h"
#include "render/renderer.h"

namespace supple {
namespace {

constexpr std::uintmax_t enough_disk = 1'000'000'000;  // bytes: some hundred frames at 1280 x 720, and the film

// Draws a triangle with the film's own shaders and reports whether that works.
Finding opengl() {
  Finding finding{"OpenGL", false, true, "", "draws the pictures", "libosmesa6, or libegl1 and libgl1-mesa-dri"};
  try {
    DrawMesh triangle;
    triangle.triangles = {0, 1, 2};
    triangle.occlusion = {1, 1, 1};
    triangle.paint.resize(3);
    triangle.color = Vec3::Ones();
    triangle.rest = {Vec3::Zero(), Vec3::Ones()};
    Stage stage;
    stage.meshes.push_back(triangle);
    stage.width = stage.height = 16;
    stage.samples = 1;
    Renderer renderer(stage, GlChoice::automatic, shaders_folder());
    DrawList list;
    list.positions = {{0, 0, 0, 1, 0, 0, 0, 1, 0}};
    (void)renderer.draw(list);
    finding.ok = true;
    const std::vector<std::string> devices = egl_devices();
    finding.found = fmt::format("{}: {}, {}; EGL finds {}", renderer.backend(), renderer.name(), renderer.version(),
                                devices.empty() ? "no devices" : fmt::format("{}", fmt::join(devices, ", ")));
  } catch (const std::exception& error) {
    finding.found = error.what();
  }
  return finding;
}

// Reports the version that a program prints in its first line, as in "ffmpeg version 5.1.6" or "gnuplot 5.4 patchlevel
// 4".
Finding tool(const std::string& name, const char* option, bool needed, const char* purpose, const char* package) {
  Finding finding{name, false, needed, "not found in PATH", purpose, package};
  const auto told = run_program({name, option});
  if (!told) return finding;
  finding.ok = told->status == 0;
  std::string line = told->output.substr(0, told->output.find('\n'));
  if (line.starts_with(name + " ")) line.erase(0, name.size() + 1);
  finding.found = finding.ok ? line.substr(0, line.find(" Copyright")) : how_it_ended(*told);
  if (name == "ffmpeg" && finding.ok && told->output.find("--enable-libx264") == std::string::npos) {
    finding.ok = false;
    finding.found += ", without libx264";
  }
  return finding;
}

Finding font() {
  const std::string file = text_font().file;
  return {"font",      !file.empty(), false, file.empty() ? "none is installed" : file, "captions in the pictures",
          "fonts-lato"};
}

Finding scripts() {
  return {"any script",
          searches_fonts(),
          false,
          searches_fonts() ? "built in" : "the program was built without it",
          "words in pictures in any script, and text.font",
          "libfontconfig-dev and libraqm-dev"};
}

Finding surface_reader() {
  const std::filesystem::path program = surface_reader_program();
  const bool runs = run_program({program.string()}).has_value();
  return {"surface reader",
          runs,
          false,
          runs ? program.string() : program.string() + " cannot be run",
          "bodies from OBJ, PLY, STL, glTF and OFF files, with their colours",
          "libassimp5, libpng16-16 and libjpeg62-turbo"};
}

Finding scenes() {
  const std::size_t count = shipped_names("scenes").size();
  return {"scenes",
          count > 0,
          true,
          fmt::format("{} in {}", count, (assets_folder() / "scenes").string()),
          "supple render NAME",
          ""};
}

Finding disk() {
  std::error_code error;
  const bool there = std::filesystem::exists("out", error);
  const std::filesystem::path place = there ? "out" : ".";
  const std::filesystem::space_info space = std::filesystem::space(place, error);
  Finding finding{"disk",
                  !error && space.available >= enough_disk && access(place.c_str(), W_OK) == 0,
                  true,
                  "",
                  "frames, film and motion of a run",
                  ""};
  finding.found = error ? error.message() : bytes_text(space.available) + " free for out/";
  if (!error && !finding.ok)
    finding.found += space.available < enough_disk ? "; a film may need " + bytes_text(enough_disk) : ", not writable";
  return finding;
}

// Reports on the user's folder in which meshes and skins are kept; without it, they are made anew for each film.
Finding cache() {
  const UserCache cache = UserCache::of_user();
  const char* purpose = "keeps meshes and skins from run to run";
  if (cache.folder().empty()) return {"cache", false, false, "neither XDG_CACHE_HOME nor HOME is set", purpose, ""};
  std::filesystem::path place = cache.folder();  // or the nearest folder above it that exists
  std::error_code error;
  while (!std::filesystem::exists(place, error) && place.has_relative_path()) place = place.parent_path();
  const bool writable = access(place.c_str(), W_OK) == 0;
  const std::string used = fmt::format("{} of {} used", bytes_text(cache.used_bytes()), bytes_text(cache.most_bytes()));
  return {"cache", writable, false, fmt::format("{}: {}", cache.folder().string(), writable ? used : "not writable"),
          purpose, ""};
}

// Reports which instructions the build uses and whether the processor has them. A build for one machine has no other
// kernels.
Finding processor() {
  std::vector<std::string> missing, used;
  [[maybe_unused]] const auto look = [&](const char* name, bool here) { (here ? used : missing).push_back(name); };
#ifdef __AVX2__
  look("AVX2", __builtin_cpu_supports("avx2"));
#endif
#ifdef __FMA__
  look("FMA", __builtin_cpu_supports("fma"));
#endif
#ifdef __AVX512F__
  look("AVX-512F", __builtin_cpu_supports("avx512f"));
#endif
  std::string found = fmt::format("{}; kernels '{}'", cpu_name(), variant_name(best_variant()));
  if (!used.empty()) found += fmt::format(", built for {}", fmt::join(used, ", "));
  if (!missing.empty())
    found += fmt::format("; the build needs {}: build it here, or portable", fmt::join(missing, ", "));
  return {"processor", missing.empty(), true, found, "the solver", ""};
}

Finding cores() {
  const unsigned count = std::thread::hardware_concurrency();
  return {"cores", count > 0, false, fmt::format("{} threads by default", std::max(1u, count)), "solver and pictures",
          ""};
}

Finding openexr() {
  return {"OpenEXR",
          writes_exr(),
          false,
          writes_exr() ? "built in" : "the program was built without it",
          "passes for compositing",
          "libopenexr-dev"};
}

}  // namespace

std::vector<Finding> examine_machine() {
  return {processor(),
          cores(),
          opengl(),
          tool("ffmpeg", "-version", true, "makes video.mp4", "ffmpeg"),
          tool("ffprobe", "-version", false, "counts the frames of the film", "ffmpeg"),
          tool("gnuplot", "--version", false, "plots in the reports of supple bench", "gnuplot-nox"),
          openexr(),
          font(),
          scripts(),
          surface_reader(),
          scenes(),
          cache(),
          disk()};
}

}  // namespace supple
