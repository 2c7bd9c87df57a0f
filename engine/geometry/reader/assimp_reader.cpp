// The program supple-read-surface reads one file through assimp and writes its triangles and colours to standard output
// (surface_stream.h). It is a program of its own because assimp may crash or never end on a broken file.
#include <sys/prctl.h>
#include <sys/resource.h>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "base/error.h"
#include "base/read_file.h"
#include "geometry/files/surface_stream.h"
#include "geometry/reader/assimp_colors.h"
#include "geometry/reader/assimp_files.h"
#include "geometry/reader/assimp_parts.h"
#include "geometry/reader/checked_surface.h"
#include "geometry/reader/texture_reader.h"

namespace {

namespace stream = supple::surface_stream;

struct Soup {
  std::vector<double> positions;
  std::vector<std::int32_t> indices;
};

void limit(decltype(RLIMIT_AS) resource, rlim_t soft, rlim_t hard) {
  const rlimit value{soft, hard};
  ::setrlimit(resource, &value);
}

// Returns the processor time that assimp may take for a file, which grows with its size [s]. A broken file can send
// assimp into an endless loop; a sound one needs a tenth of this time.
rlim_t seconds_for(const char* path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  return error ? 3 : rlim_t(std::min<std::uintmax_t>(3 + (size >> 19), 60));
}

void limit_this_process(const char* path) {
  // These sanitizers reserve terabytes of address space, so their builds have no limit here.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  limit(RLIMIT_AS, rlim_t(2) << 30, rlim_t(2) << 30);
#endif
  rlimit now{RLIM_INFINITY, RLIM_INFINITY};
  ::getrlimit(RLIMIT_CPU, &now);
  limit(RLIMIT_CPU, std::min(seconds_for(path), now.rlim_max), now.rlim_max);
  limit(RLIMIT_CORE, 0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
}

// Gives the process this many seconds of processor time from now on.
void allow_seconds(int seconds) {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  rlimit now{};
  ::getrlimit(RLIMIT_CPU, &now);
  const auto spent = rlim_t(used.ru_utime.tv_sec + used.ru_stime.tv_sec);
  limit(RLIMIT_CPU, std::min(std::max(now.rlim_cur, spent + rlim_t(seconds)), now.rlim_max), now.rlim_max);
}

int refuse(const std::string& words, stream::Place place = {}) {
  const std::string reason = supple::one_line(words);
  std::fwrite(stream::refused, 1, sizeof stream::refused, stdout);
  std::fwrite(&place, sizeof place, 1, stdout);
  std::fwrite(reason.data(), 1, reason.size(), stdout);
  return std::fflush(stdout) == 0 ? 0 : 1;
}

constexpr char takes_too_much[] = "takes more than 2 GB of memory to read";

// Says in plain words why assimp did not read a file.
std::string reason_of(const std::string& error, const supple::AssimpFiles& files) {
  const auto says = [&](const char* words) { return error.find(words) != std::string::npos; };
  if (says("bad_alloc")) return takes_too_much;
  if (says("No suitable reader"))
    return "its ending and its first bytes are of no format that is read: OBJ, PLY, STL, OFF, glTF, COLLADA (.dae), "
           "3DS, FBX, Blender, 3MF and X3D are";
  if (!files.refused().empty())
    return "it names the file '" + std::filesystem::path(files.refused()).filename().string() +
           "', which cannot be opened: " + error;
  if (says("read error")) return "the file ends too soon, or is none of its ending's format (" + error + ")";
  return error;
}

// Returns what is to be said of a body so far from the origin that floats do not hold its shape; else nothing.
std::string lost_digits(const Soup& soup) {
  supple::Bounds box;
  for (const std::int32_t v : soup.indices) {
    const supple::Vec3 p(soup.positions.data() + 3 * std::size_t(v));
    if (p.allFinite()) box.include(p);
  }
  if (box.empty() || !(box.extent().maxCoeff() > 0)) return "";
  const double reach = std::max(box.lower.cwiseAbs().maxCoeff(), box.upper.cwiseAbs().maxCoeff());
  const double step = std::exp2(std::floor(std::log2(std::max(reach, 1e-300))) - 23);  // between floats there
  if (step < 1e-5 * box.extent().maxCoeff()) return "";
  return fmt::format(
      "it lies {:.2g} from the origin, where positions are exact to {:.2g} alone: a model of {:.3g} should be moved "
      "nearer to it",
      reach, step, box.extent().maxCoeff());
}

// Appends a mesh to the soup. Returns what is wrong with the mesh, or nothing when all is well.
std::string append(const aiMesh& mesh, Soup& soup) {
  const auto first = std::int64_t(soup.positions.size() / 3);
  if (first + std::int64_t(mesh.mNumVertices) > stream::most_vertices) return "it has more than 15 million vertices";
  for (unsigned v = 0; v < mesh.mNumVertices; ++v)
    for (unsigned k = 0; k < 3; ++k) soup.positions.push_back(mesh.mVertices[v][k]);
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) continue;
    if (std::int64_t(soup.indices.size() / 3) >= stream::most_triangles) return "it has more than 5 million triangles";
    for (unsigned k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= mesh.mNumVertices) return "a triangle names a vertex that does not exist";
      soup.indices.push_back(std::int32_t(first + face.mIndices[k]));
    }
  }
  return "";
}

template <class T>
void write(const T* values, std::size_t count) {
  if (count > 0) std::fwrite(values, sizeof(T), count, stdout);
}

void write_textures(const std::vector<supple::Texture>& textures) {
  for (const supple::Texture& texture : textures) {
    const stream::TextureHead head{texture.width, texture.height, std::int32_t(texture.wrap_u),
                                   std::int32_t(texture.wrap_v), std::int32_t(texture.name.size())};
    write(&head, 1);
    write(texture.name.data(), texture.name.size());
    write(texture.rgb.data(), texture.rgb.size());
  }
}

// Returns the names of the parts as the stream has them.
std::string text_of(const supple::SurfaceParts& parts) {
  std::string text;
  for (const std::vector<std::string>& names : parts.names) {
    for (const std::string& name : names) text += name + '\t';
    text += '\n';
  }
  return text;
}

int read(const char* path) {
  const supple::CheckedSurface checked = supple::checked_surface(path);
  Assimp::Importer importer;
  auto* const files = new supple::AssimpFiles(path, checked.bytes);
  importer.SetIOHandler(files);  // which deletes it
  const aiScene* scene = importer.ReadFile(path, aiProcess_TransformUVCoords);
  supple::PartReader part_reader;
  if (scene != nullptr) part_reader.remember(*scene);  // the next step drops the nodes and joins their meshes
  if (scene != nullptr) scene = importer.ApplyPostProcessing(aiProcess_PreTransformVertices);
  if (scene == nullptr) return refuse(reason_of(importer.GetErrorString(), *files));
  std::vector<std::string> first_remarks = checked.remarks;
  const supple::SurfaceParts parts = part_reader.parts_of(*scene, first_remarks);
  scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (scene == nullptr) return refuse(reason_of(importer.GetErrorString(), *files));
  Soup soup;
  supple::ColorReader reader(*scene, path, allow_seconds);
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const std::string problem = append(*scene->mMeshes[m], soup);
    if (!problem.empty()) return refuse(problem);
    reader.append(*scene->mMeshes[m]);
  }
  supple::FoundColors colors = reader.take();
  colors.remarks.insert(colors.remarks.begin(), first_remarks.begin(), first_remarks.end());
  const bool is_moved = checked.origin != supple::Vec3::Zero();
  const std::string lost = is_moved ? "" : lost_digits(soup);
  if (!lost.empty()) colors.remarks.push_back(lost);
  for (std::size_t i = 0; is_moved && i < soup.positions.size(); ++i)
    soup.positions[i] += checked.origin[Eigen::Index(i % 3)];
  std::string remarks;
  for (const std::string& remark : colors.remarks)
    if (std::ssize(remarks) + std::ssize(remark) < stream::most_text) remarks += supple::one_line(remark) + '\n';
  const std::string names = text_of(parts);
  const stream::Counts counts{std::int64_t(soup.positions.size() / 3),
                              std::int64_t(soup.indices.size() / 3),
                              std::int64_t(colors.by_vertex.size()),
                              std::int64_t(colors.textures.size()),
                              std::int64_t(colors.places.size()),
                              std::int64_t(parts.of.size()),
                              std::int64_t(remarks.size()),
                              std::int64_t(colors.found.size()),
                              std::int64_t(names.size())};
  write(stream::accepted, sizeof stream::accepted);
  write(&counts, 1);
  write(soup.positions.data(), soup.positions.size());
  write(soup.indices.data(), soup.indices.size());
  write(colors.by_vertex.data(), colors.by_vertex.size());
  write_textures(colors.textures);
  write(colors.places.data(), colors.places.size());
  write(parts.of.data(), parts.of.size());
  write(remarks.data(), remarks.size());
  write(colors.found.data(), colors.found.size());
  write(names.data(), names.size());
  return std::fflush(stdout) == 0 ? 0 : 1;
}

// Reads a picture and writes it as the texture of a surface that has nothing else.
int read_picture(const char* path) {
  constexpr std::uintmax_t largest = 1u << 28;
  const std::string bytes = supple::read_file(path, largest);
  allow_seconds(10);
  supple::ReadTexture read =
      supple::read_texture(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), stream::most_pixels);
  if (!read.refusal.empty()) return refuse(read.refusal);
  if (read.damaged) return refuse("is damaged: parts of it cannot be read");
  stream::Counts counts;
  counts.textures = 1;
  write(stream::accepted, sizeof stream::accepted);
  write(&counts, 1);
  write_textures({std::move(read.texture)});
  return std::fflush(stdout) == 0 ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  const bool is_picture = count == 3 && std::strcmp(arguments[1], stream::picture_mode) == 0;
  if (count != 2 && !is_picture) {
    std::fputs("usage: supple-read-surface [--picture] FILE\n", stderr);
    return 2;
  }
  const char* const file = arguments[count - 1];
  limit_this_process(file);
  try {
    return is_picture ? read_picture(file) : read(file);
  } catch (const supple::InputError& error) {
    const supple::Problem& problem = error.problems().front();
    return refuse(problem.message, {problem.place.line, problem.place.column});
  } catch (const std::bad_alloc&) {
    return refuse(takes_too_much);
  } catch (const std::exception& error) {
    return refuse(error.what());
  }
}
