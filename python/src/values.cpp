#include "values.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "scene/config/config.h"

namespace supple::python {
namespace {

constexpr int deepest = 16;  // of values within each other; scene files have no more than six

std::string text_of(const py::handle& value, const std::string& place, int depth) {
  if (depth > deepest) throw InputError(place, "a value lies too deep in others");
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::str>(value)) return toml_text(value.cast<std::string>());
  if (py::hasattr(value, "__fspath__")) return toml_text(path_of(value));
  if (py::hasattr(value, "tolist")) return text_of(value.attr("tolist")(), place, depth + 1);  // of numpy
  if (py::isinstance<py::int_>(value)) return py::str(value).cast<std::string>();
  if (py::isinstance<py::float_>(value)) return fmt::format("{}", value.cast<double>());
  if (py::isinstance<py::dict>(value)) {
    std::string items;
    for (const auto& [key, item] : value.cast<py::dict>()) {
      if (item.is_none()) continue;
      items += (items.empty() ? "" : ", ") + toml_text(py::str(key).cast<std::string>()) + " = " +
               text_of(item, place, depth + 1);
    }
    return "{" + items + "}";
  }
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    std::string items;
    for (const py::handle& item : value) items += (items.empty() ? "" : ", ") + text_of(item, place, depth + 1);
    return "[" + items + "]";
  }
  const auto type = py::str(py::type::of(value).attr("__name__")).cast<std::string>();
  throw InputError(place, fmt::format("a value of type {} is nothing that a scene can say", type));
}

}  // namespace

std::string toml_of(const py::handle& value, const std::string& place) { return text_of(value, place, 0); }

std::string document_of(const py::dict& table) {
  std::string text;
  for (const auto& [key, value] : table) {
    const auto name = py::str(key).cast<std::string>();
    if (!value.is_none()) text += toml_text(name) + " = " + toml_of(value, name) + "\n";
  }
  return text;
}

std::vector<std::string> settings_of(const py::dict& values) {
  std::vector<std::string> settings;
  for (const auto& [key, value] : values) {
    const auto path = py::str(key).cast<std::string>();
    settings.push_back(path + "=" + toml_of(value, path));
  }
  return settings;
}

std::string path_of(const py::handle& path) {
  auto text = py::module_::import("os").attr("fspath")(path).cast<std::string>();
  if (text.empty() || text.find('\0') != text.npos) throw InputError("path", "is empty, or has a zero in it");
  return text;
}

std::vector<std::int32_t> vertices_of(const py::handle& array, const std::string& name, std::int64_t count) {
  const py::array given = py::array::ensure(array);
  if (!given) PyErr_Clear();
  const char kind = given && given.ndim() == 1 ? given.dtype().kind() : ' ';
  const bool none = kind != ' ' && given.shape(0) == 0, is_mask = kind == 'b' && given.shape(0) == count;
  if (!none && !is_mask && kind != 'i' && kind != 'u')
    throw InputError(name, fmt::format("are to be a list of whole numbers, or {} times yes or no", count));
  std::vector<std::int32_t> vertices;
  for (py::ssize_t i = 0; i < given.shape(0); ++i) {
    const py::object item = given[py::int_(i)];
    if (is_mask) {
      if (item.cast<bool>()) vertices.push_back(static_cast<std::int32_t>(i));
      continue;
    }
    const bool fits = py::bool_(py::int_(0) <= item) && py::bool_(item < py::int_(count));
    if (!fits)
      throw InputError(name,
                       fmt::format("there is no vertex {}: 0 to {}", py::str(item).cast<std::string>(), count - 1));
    vertices.push_back(item.cast<std::int32_t>());
  }
  return vertices;
}

namespace {

// Tells whether an array holds numbers. numpy would turn other values into numbers, too.
bool is_numeric(const py::handle& array) {
  const py::array given = py::array::ensure(array);
  if (!given) PyErr_Clear();
  return given && (given.size() == 0 || std::string_view("biuf").find(given.dtype().kind()) != std::string_view::npos);
}

}  // namespace

Positions positions_of(const py::handle& array, const std::string& name, Eigen::Index rows) {
  if (!is_numeric(array)) throw InputError(name, "is no array of numbers");
  const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
  if (numbers.ndim() != 2 || numbers.shape(1) != 3 || (rows >= 0 && numbers.shape(0) != rows)) {
    std::string shape;
    for (py::ssize_t i = 0; i < numbers.ndim(); ++i) shape += fmt::format("{}{}", i > 0 ? " x " : "", numbers.shape(i));
    throw InputError(name, fmt::format("has the shape {}; {} x 3 is wanted", shape.empty() ? "of one number" : shape,
                                       rows >= 0 ? fmt::format("{}", rows) : "n"));
  }
  Positions result = Eigen::Map<const Positions>(numbers.data(), numbers.shape(0), 3);
  for (Eigen::Index r = 0; r < result.rows(); ++r) {
    if (!result.row(r).allFinite()) throw InputError(name, fmt::format("row {} is not finite", r));
  }
  return result;
}

Vec3 vector_of(const py::handle& array, const std::string& name) {
  using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
  const Numbers numbers = is_numeric(array) ? Numbers::ensure(array) : Numbers(0);
  if (numbers.ndim() != 1 || numbers.shape(0) != 3) throw InputError(name, "is not a list of three numbers");
  const Vec3 result(numbers.data()[0], numbers.data()[1], numbers.data()[2]);
  if (!result.allFinite()) throw InputError(name, "is not finite");
  return result;
}

py::array view_of(const std::shared_ptr<Positions>& rows, bool writeable) {
  using Owner = std::shared_ptr<Positions>;
  const py::capsule owner(new Owner(rows), [](void* held) { delete static_cast<Owner*>(held); });
  py::array_t<double> array({rows->rows(), Eigen::Index(3)}, {3 * sizeof(double), sizeof(double)}, rows->data(), owner);
  if (!writeable) array.attr("setflags")(py::arg("write") = false);
  return array;
}

}  // namespace supple::python
