// Implements glTF of checked_surface.h, with its data inside or beside it: Khronos, "glTF 2.0 specification". What
// decides the shape is checked: buffers, views, accessors, primitives and nodes.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/read_file.h"
#include "geometry/reader/checked_surface.h"
#include "geometry/reader/uri_names.h"

namespace supple {
namespace {

using Json = nlohmann::json;

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  if (at + sizeof word <= bytes.size()) std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

std::string from_base64(std::string_view text) {
  std::string bytes;
  unsigned block = 0;
  int bits = 0;
  for (const char c : text) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t value = digits.find(c);
    if (value == std::string_view::npos) break;  // the padding
    block = block << 6 | unsigned(value);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(char(block >> bits));
  }
  return bytes;
}

class GltfChecker {
 public:
  GltfChecker(Json& document, std::string_view inside, const std::filesystem::path& file)
      : document_(document), inside_(inside), file_(file) {}

  // Checks the document. Returns whether it was changed: where data inside it is longer than announced, the announced
  // length is corrected, because assimp wants exactly that many bytes.
  bool run() {
    check_extensions();
    for (std::size_t b = 0; b < list("buffers").size(); ++b) check_buffer(b);
    for (std::size_t v = 0; v < list("bufferViews").size(); ++v) check_view(v);
    for (std::size_t a = 0; a < list("accessors").size(); ++a) check_accessor(a);
    for (std::size_t m = 0; m < list("meshes").size(); ++m) {
      const Json primitives = list("meshes")[m].value("primitives", Json());
      if (!primitives.is_array()) refuse(fmt::format("mesh {}: it has no list of primitives", m));
      for (std::size_t p = 0; p < primitives.size(); ++p)
        check_primitive(primitives[p], fmt::format("mesh {}, primitive {}", m, p));
    }
    check_nodes();
    return is_changed_;
  }

 private:
  [[noreturn]] void refuse(const std::string& message) const { throw InputError(file_.string(), message); }

  const Json& list(const char* name) const {
    static const Json none = Json::array();
    const auto found = document_.find(name);
    if (found == document_.end()) return none;
    if (!found->is_array()) refuse(fmt::format("'{}' is no list", name));
    return *found;
  }

  std::size_t whole(const Json& object, const char* key, const std::string& where, std::size_t missing) const {
    const auto found = object.find(key);
    if (found == object.end()) return missing;
    const bool is_whole = found->is_number_unsigned() || (found->is_number_float() && *found >= 0.0 && *found < 1e15 &&
                                                          *found == std::floor(found->get<double>()));
    if (!is_whole)
      refuse(fmt::format("{}: {} is {}: a whole number from 0 is wanted", where, key, found->dump().substr(0, 40)));
    return found->get<std::size_t>();
  }
  // Returns the number of an entry of a list, which must exist.
  std::size_t named(const Json& object, const char* key, const char* of, const std::string& where) const {
    if (!object.contains(key)) refuse(fmt::format("{}: {} is missing", where, key));
    const std::size_t number = whole(object, key, where, 0);
    if (number >= list(of).size())
      refuse(
          fmt::format("{}: {} is {}, but there are {} {} (counted from 0)", where, key, number, list(of).size(), of));
    return number;
  }

  void check_extensions() const {
    for (const Json& extension : list("extensionsRequired")) {
      const auto name = extension.get<std::string>();
      if (name == "EXT_meshopt_compression")
        refuse(fmt::format("its meshes are compressed ({}), which is not read", name));
    }
  }

  void check_buffer(std::size_t b) {
    const Json& buffer = list("buffers")[b];
    const std::string where = fmt::format("buffer {}", b);
    const std::size_t announced = whole(buffer, "byteLength", where, 0);
    const std::size_t held = buffer_bytes(b).size();
    if (announced > held) refuse(fmt::format("{}: {} bytes announced, but it has {}", where, announced, held));
    if (announced == held || !buffer.value("uri", "").starts_with("data:")) return;
    document_["buffers"][b]["byteLength"] = held;
    is_changed_ = true;
  }

  std::string_view buffer_bytes(std::size_t b) {
    const Json& buffer = list("buffers")[b];
    if (!buffer.contains("uri")) {
      if (b != 0 || inside_.empty())
        refuse(fmt::format("buffer {}: it has no uri, and the file holds no bytes for it", b));
      return inside_;
    }
    const auto known = buffers_.find(b);
    if (known != buffers_.end()) return known->second;
    const auto uri = buffer.at("uri").get<std::string>();
    if (uri.starts_with("data:")) {
      const std::size_t comma = uri.find(',');
      if (comma == std::string::npos || uri.substr(0, comma).find("base64") == std::string::npos)
        refuse(fmt::format("buffer {}: its data is not in base64", b));
      return buffers_[b] = from_base64(std::string_view(uri).substr(comma + 1));
    }
    std::filesystem::path place = file_.parent_path() / uri;
    if (!std::filesystem::exists(place)) place = file_.parent_path() / decoded_uri(uri);
    try {
      return buffers_[b] = read_file(place);
    } catch (const InputError& error) {
      refuse(fmt::format("buffer {}: {}: {}", b, place.filename().string(), error.problems().front().message));
    }
  }

  void check_view(std::size_t v) {
    const Json& view = list("bufferViews")[v];
    const std::string where = fmt::format("buffer view {}", v);
    const Json& buffer = list("buffers")[named(view, "buffer", "buffers", where)];
    const std::size_t begin = whole(view, "byteOffset", where, 0), length = whole(view, "byteLength", where, 0),
                      room = whole(buffer, "byteLength", where, 0);
    if (begin > room || length > room - begin)
      refuse(fmt::format("{}: it ends at byte {}, but its buffer has {}", where, begin + length, room));
  }

  struct Layout {
    std::size_t count = 0, parts = 0, bytes = 0, stride = 0;  // parts: numbers of an element; bytes: of a number
    std::size_t type = 0;
  };

  Layout layout_of(std::size_t a) const {
    const Json& accessor = list("accessors")[a];
    const std::string where = fmt::format("accessor {}", a);
    static const std::map<std::string, std::size_t> parts = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                             {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
    static const std::map<std::size_t, std::size_t> bytes = {{5120, 1}, {5121, 1}, {5122, 2},
                                                             {5123, 2}, {5125, 4}, {5126, 4}};
    const auto kind = parts.find(accessor.value("type", ""));
    if (kind == parts.end()) refuse(fmt::format("{}: type '{}' is not known", where, accessor.value("type", "")));
    const std::size_t type = whole(accessor, "componentType", where, 0);
    const auto size = bytes.find(type);
    if (size == bytes.end()) refuse(fmt::format("{}: componentType {} is not known", where, type));
    Layout layout{whole(accessor, "count", where, 0), kind->second, size->second, kind->second * size->second, type};
    if (accessor.contains("bufferView")) {
      const Json& view = list("bufferViews")[named(accessor, "bufferView", "bufferViews", where)];
      const std::size_t stride = whole(view, "byteStride", where, 0);
      if (stride != 0 && stride < layout.stride)
        refuse(
            fmt::format("{}: its view's byteStride is {}, but an element has {} bytes", where, stride, layout.stride));
      if (stride != 0) layout.stride = stride;
    }
    return layout;
  }

  void check_accessor(std::size_t a) {
    const Json& accessor = list("accessors")[a];
    const std::string where = fmt::format("accessor {}", a);
    const Layout layout = layout_of(a);
    if (layout.count == 0) refuse(fmt::format("{}: its count is 0 or missing", where));
    if (!accessor.contains("bufferView")) return;
    const Json& view = list("bufferViews")[named(accessor, "bufferView", "bufferViews", where)];
    const std::size_t begin = whole(accessor, "byteOffset", where, 0), room = whole(view, "byteLength", where, 0),
                      element = layout.parts * layout.bytes;
    if (begin > room || element > room - begin || (layout.count - 1) > (room - begin - element) / layout.stride)
      refuse(fmt::format("{}: {} elements announced, for which the {} bytes of its view have no room", where,
                         layout.count, room));
  }

  // Returns the place of an accessor's first element; null where it has no bytes of its own.
  const char* elements_of(std::size_t a) {
    const Json& accessor = list("accessors")[a];
    if (!accessor.contains("bufferView") || accessor.contains("sparse")) return nullptr;
    const std::string where = fmt::format("accessor {}", a);
    const Json& view = list("bufferViews")[named(accessor, "bufferView", "bufferViews", where)];
    return buffer_bytes(named(view, "buffer", "buffers", where)).data() + whole(view, "byteOffset", where, 0) +
           whole(accessor, "byteOffset", where, 0);
  }

  void check_primitive(const Json& primitive, const std::string& where) {
    const std::size_t mode = whole(primitive, "mode", where, 4);
    if (mode > 6) refuse(fmt::format("{}: mode {} is not known (0 to 6 are)", where, mode));
    if (mode < 4) return;  // points and lines
    if (!primitive.contains("attributes")) refuse(fmt::format("{}: attributes is missing", where));
    const Json& attributes = primitive.at("attributes");
    const std::size_t positions = named(attributes, "POSITION", "accessors", where);
    const Layout layout = layout_of(positions);
    if (layout.parts != 3) refuse(fmt::format("{}: accessor {} of its positions is no VEC3", where, positions));
    for (const auto& attribute : attributes.items()) {
      const std::size_t a = named(attributes, attribute.key().c_str(), "accessors", where);
      if (layout_of(a).count != layout.count)
        refuse(fmt::format("{}: accessor {} of {} has {} elements, but there are {} positions", where, a,
                           attribute.key().substr(0, 40), layout_of(a).count, layout.count));
    }
    check_finite(positions, layout);
    std::size_t corners = layout.count;
    if (primitive.contains("indices")) corners = check_indices(primitive, layout.count, where);
    if (mode == 4 && corners % 3 != 0)
      refuse(fmt::format("{}: {} corners are no multiple of 3, as triangles have", where, corners));
  }

  void check_finite(std::size_t a, const Layout& layout) {
    const char* const begin = elements_of(a);
    if (begin == nullptr || layout.type != 5126) return;
    for (std::size_t v = 0; v < layout.count; ++v) {
      std::array<float, 3> p;
      std::memcpy(p.data(), begin + v * layout.stride, sizeof p);
      if (!std::all_of(p.begin(), p.end(), [](float x) { return std::isfinite(x); }))
        refuse(fmt::format("accessor {}: position {} is not finite", a, v));
    }
  }

  std::size_t check_indices(const Json& primitive, std::size_t vertices, const std::string& where) {
    const std::size_t a = named(primitive, "indices", "accessors", where);
    const Layout layout = layout_of(a);
    const bool is_unsigned = layout.type == 5121 || layout.type == 5123 || layout.type == 5125;
    if (layout.parts != 1 || !is_unsigned)
      refuse(fmt::format("{}: accessor {} of its indices holds no unsigned whole numbers", where, a));
    const char* const begin = elements_of(a);
    for (std::size_t i = 0; begin != nullptr && i < layout.count; ++i) {
      std::uint32_t index = 0;
      std::memcpy(&index, begin + i * layout.stride, layout.bytes);  // the least byte first, as on this machine
      if (index >= vertices)
        refuse(fmt::format("accessor {}: index {} names vertex {}, but there are {} (counted from 0)", a, i, index,
                           vertices));
    }
    return layout.count;
  }

  void check_numbers(const Json& object, const char* key, std::size_t count, const std::string& where) const {
    const auto found = object.find(key);
    if (found == object.end()) return;
    const bool are_numbers =
        found->is_array() && std::all_of(found->begin(), found->end(), [](const Json& one) { return one.is_number(); });
    if (!are_numbers || found->size() != count)
      refuse(fmt::format("{}: {} is {}: {} numbers are wanted", where, key, found->dump().substr(0, 40), count));
  }

  // Checks that what nodes name is there, and that no node is among its own descendants, which would be read without
  // end.
  void check_nodes() const {
    const Json& nodes = list("nodes");
    std::vector<std::size_t> parents(nodes.size(), nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const std::string where = fmt::format("node {}", n);
      if (nodes[n].contains("mesh")) (void)named(nodes[n], "mesh", "meshes", where);
      check_numbers(nodes[n], "translation", 3, where);
      check_numbers(nodes[n], "rotation", 4, where);
      check_numbers(nodes[n], "scale", 3, where);
      check_numbers(nodes[n], "matrix", 16, where);
      if (!nodes[n].contains("children")) continue;
      for (const Json& child : nodes[n].at("children")) {
        if (!child.is_number_unsigned() || child.get<std::size_t>() >= nodes.size())
          refuse(fmt::format("{}: child {} does not exist: there are {} nodes (counted from 0)", where,
                             child.dump().substr(0, 40), nodes.size()));
        std::size_t& parent = parents[child.get<std::size_t>()];
        if (parent != nodes.size()) refuse(fmt::format("node {} is a child of two nodes", child.get<std::size_t>()));
        parent = n;
      }
    }
    std::vector<std::size_t> reached_from(nodes.size(), nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      std::size_t up = n;
      for (; up != nodes.size() && reached_from[up] == nodes.size(); up = parents[up]) reached_from[up] = n;
      if (up != nodes.size() && reached_from[up] == n) refuse(fmt::format("node {} is among its own descendants", up));
    }
    for (std::size_t s = 0; s < list("scenes").size(); ++s) {
      if (!list("scenes")[s].contains("nodes")) continue;
      for (const Json& node : list("scenes")[s].at("nodes"))
        if (!node.is_number_unsigned() || node.get<std::size_t>() >= nodes.size())
          refuse(fmt::format("scene {}: node {} does not exist: there are {} (counted from 0)", s,
                             node.dump().substr(0, 40), nodes.size()));
    }
  }

  Json& document_;
  const std::string_view inside_;
  const std::filesystem::path& file_;
  std::map<std::size_t, std::string> buffers_;
  bool is_changed_ = false;
};

// Finds the two chunks of a binary file.
void take_chunks(std::string_view bytes, const std::string& name, std::string_view& text, std::string_view& inside) {
  const std::size_t length = word_at(bytes, 8);
  if (length > bytes.size() || length < 20)
    throw InputError(name, fmt::format("{} bytes announced, but the file has {}", length, bytes.size()));
  for (std::size_t at = 12; at + 8 <= length;) {
    const std::size_t size = word_at(bytes, at);
    if (size > length - at - 8)
      throw InputError(name,
                       fmt::format("a chunk announces {} bytes, but the file has {} for it", size, length - at - 8));
    const std::uint32_t kind = word_at(bytes, at + 4);
    if (kind == 0x4e4f534a && text.empty()) text = bytes.substr(at + 8, size);      // JSON
    if (kind == 0x004e4942 && inside.empty()) inside = bytes.substr(at + 8, size);  // BIN
    at += 8 + size;
  }
}

[[noreturn]] void refuse_json(std::string_view text, std::size_t byte, const std::string& name) {
  const std::string_view before = text.substr(0, byte > 0 ? byte - 1 : 0);
  const auto line = 1 + int(std::count(before.begin(), before.end(), '\n'));
  const std::size_t start = before.rfind('\n');
  const std::size_t column = before.size() - (start == std::string_view::npos ? 0 : start + 1) + 1;
  const std::string found = byte > 0 && byte <= text.size() ? fmt::format("'{}' stands here", text.substr(byte - 1, 10))
                                                            : std::string("the text ends here");
  throw InputError({Problem{{name, line, int(column)}, fmt::format("is no JSON: {}", found)}});
}

}  // namespace

CheckedSurface checked_gltf(std::string bytes, const std::filesystem::path& file) {
  const std::string name = file.string();
  std::string_view text = bytes, inside;
  CheckedSurface result;
  if (bytes.starts_with("glTF")) {
    if (word_at(bytes, 4) != 2)
      throw InputError(name, fmt::format("binary glTF of version {} is not read; 2 is", word_at(bytes, 4)));
    text = {};
    take_chunks(bytes, name, text, inside);
  }
  try {
    Json document = Json::parse(text);
    if (!document.is_object() || !document.contains("asset"))
      throw InputError(name, "is no glTF: it has no asset with a version");
    const Json& asset = document.at("asset");
    const bool is_number = asset.contains("version") && asset.at("version").is_number();  // in some files of version 1
    const std::string version = is_number ? asset.at("version").dump() : asset.value("version", "");
    if (!version.starts_with("2") && !version.starts_with("1"))
      throw InputError(name, fmt::format("glTF of version '{}' is not read; 1.0 and 2.0 are", version.substr(0, 40)));
    if (version.starts_with("2") && GltfChecker(document, inside, file).run() && !bytes.starts_with("glTF"))
      bytes = document.dump();
  } catch (const Json::parse_error& error) {
    refuse_json(text, error.byte, name);
  } catch (const Json::exception& error) {
    const std::string_view what = error.what();  // "[json.exception...] type must be ..."
    throw InputError(name, fmt::format("is no glTF: {}", what.substr(what.find(']') + 1)));
  }
  result.bytes = std::move(bytes);
  return result;
}

}  // namespace supple
