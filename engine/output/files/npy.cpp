#include "output/files/npy.h"

#include <bit>
#include <charconv>
#include <cstring>
#include <iterator>
#include <limits>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/read_file.h"
#include "output/files/whole_file.h"

namespace supple {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are copied to files as they lie in memory");

constexpr std::string_view npy_signature = "\x93NUMPY";
constexpr std::size_t preamble = 10;   // signature, two bytes of version, two bytes of the header's length
constexpr std::size_t alignment = 64;  // of the values in the file

template <class T>
constexpr const char* numpy_type = nullptr;
template <>
constexpr const char* numpy_type<double> = "<f8";
template <>
constexpr const char* numpy_type<std::int32_t> = "<i4";

template <class T>
void write(const std::filesystem::path& path, NpyShape shape, std::span<const T> values) {
  SUPPLE_CHECK(std::size_t(shape.rows * shape.columns), ==, values.size());
  std::string header = fmt::format(
      "{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", numpy_type<T>,
      shape.dimensions == 1 ? fmt::format("({},)", shape.rows) : fmt::format("({}, {})", shape.rows, shape.columns));
  header.append(alignment - 1 - (preamble + header.size()) % alignment, ' ');
  header += '\n';
  std::string file(npy_signature);
  file += '\x01';
  file += '\x00';
  file += static_cast<char>(header.size() & 0xff);
  file += static_cast<char>(header.size() >> 8);
  file += header;
  file.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  write_whole_file(path, std::string_view(file));
}

// Reads the header: a Python dictionary with exactly three keys, in any order.
class HeaderReader {
 public:
  HeaderReader(std::string file, std::string_view text) : file_(std::move(file)), text_(text) {}

  struct Header {
    std::string type;
    NpyShape shape;
  };

  Header read() {
    Header header;
    bool typed = false, ordered = false, shaped = false;
    expect('{');
    while (!accept('}')) {
      const std::string key = word();
      expect(':');
      if (key == "descr" && !typed) {
        header.type = word();
        typed = true;
      } else if (key == "fortran_order" && !ordered) {
        if (accept("True")) fail("is in Fortran order; C order is read");
        if (!accept("False")) damaged();
        ordered = true;
      } else if (key == "shape" && !shaped) {
        header.shape = shape();
        shaped = true;
      } else {
        damaged();
      }
      if (accept(',')) continue;
      expect('}');
      break;
    }
    skip();
    if (!text_.empty() || !typed || !ordered || !shaped) damaged();
    return header;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError(file_, message); }
  [[noreturn]] void damaged() const {
    fail("the header is not that of a .npy file: descr, fortran_order and shape, once each");
  }

  void skip() {
    while (!text_.empty() && text_.front() == ' ') text_.remove_prefix(1);
  }
  bool accept(std::string_view token) {
    skip();
    if (!text_.starts_with(token)) return false;
    text_.remove_prefix(token.size());
    return true;
  }
  bool accept(char token) { return accept(std::string_view(&token, 1)); }
  void expect(char token) {
    if (!accept(token)) damaged();
  }

  std::string word() {
    expect('\'');
    const std::size_t end = text_.find('\'');
    if (end == std::string_view::npos) damaged();
    std::string result(text_.substr(0, end));
    text_.remove_prefix(end + 1);
    return result;
  }

  std::int64_t count() {
    skip();
    std::int64_t value = -1;
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
    if (error != std::errc() || value < 0) damaged();
    text_.remove_prefix(std::size_t(end - text_.data()));
    return value;
  }

  NpyShape shape() {
    expect('(');
    if (accept(')')) fail("has no dimension; one or two are read");
    const std::int64_t rows = count();
    expect(',');
    if (accept(')')) return npy_list(rows);
    const std::int64_t columns = count();
    const bool more = accept(',');
    if (accept(')')) return npy_table(rows, columns);
    if (!more) damaged();
    (void)count();
    fail("has more than two dimensions; one or two are read");
  }

  std::string file_;
  std::string_view text_;
};

template <class T>
NpyArray<T> read(const std::filesystem::path& path) {
  const std::string bytes = read_file(path), name = path.string();
  if (bytes.size() < preamble || !bytes.starts_with(npy_signature)) throw InputError(name, "is not a .npy file");
  const int major = static_cast<unsigned char>(bytes[6]), minor = static_cast<unsigned char>(bytes[7]);
  if (major != 1 || minor != 0)
    throw InputError(name, fmt::format("is of .npy version {}.{}; version 1.0 is read", major, minor));
  const std::size_t length = static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
  if (bytes.size() < preamble + length) throw InputError(name, "ends within its header");
  if (length == 0 || bytes[preamble + length - 1] != '\n')
    throw InputError(name, "the header does not end with its line");
  const auto header = HeaderReader(name, std::string_view(bytes).substr(preamble, length - 1)).read();
  if (header.type != numpy_type<T>)
    throw InputError(name, fmt::format("holds numbers of type '{}' where '{}' is read", header.type, numpy_type<T>));
  const std::size_t given = bytes.size() - preamble - length;
  const auto [dimensions, rows, columns] = header.shape;
  // A shape that no file could hold must not overflow before it is compared.
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max() / std::int64_t{sizeof(T)};
  const bool countable = columns == 0 || rows <= most / columns;
  const std::size_t wanted = countable ? std::size_t(rows * columns) * sizeof(T) : 0;
  if (!countable || given != wanted) {
    throw InputError(name, fmt::format("holds {} bytes of values; its shape, {} x {}, takes {}", given, rows, columns,
                                       countable ? std::to_string(wanted) : "more"));
  }
  NpyArray<T> array{header.shape, std::vector<T>(std::size_t(rows * columns))};
  if (wanted > 0) std::memcpy(array.values.data(), bytes.data() + preamble + length, wanted);
  return array;
}

}  // namespace

void write_npy(const std::filesystem::path& path, NpyShape shape, std::span<const double> values) {
  write<double>(path, shape, values);
}

void write_npy(const std::filesystem::path& path, NpyShape shape, std::span<const std::int32_t> values) {
  write<std::int32_t>(path, shape, values);
}

NpyArray<double> read_npy_doubles(const std::filesystem::path& path) { return read<double>(path); }
NpyArray<std::int32_t> read_npy_ints(const std::filesystem::path& path) { return read<std::int32_t>(path); }

}  // namespace supple
