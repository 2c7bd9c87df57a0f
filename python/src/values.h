// Turns Python's values into those of scene files, so that the readers of scenes check them, and turns arrays of Python
// and of C++ into each other.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "base/types.h"
#include "sim/model/model.h"

namespace supple::python {

namespace py = pybind11;

// Writes a number, text, list, dict or array as TOML, on one line. Values in a dict that are None are left out. Throws
// InputError where a scene file has no such value. place: what messages name.
std::string toml_of(const py::handle& value, const std::string& place);
// Writes a dict as a TOML document.
std::string document_of(const py::dict& table);
// Returns path=value, as --set takes it, for each item of a dict.
std::vector<std::string> settings_of(const py::dict& values);

// Returns the text of a str or of a path.
std::string path_of(const py::handle& path);

// Reads numbers of vertices below `count`, or a mask that has one truth for each vertex. Throws InputError.
std::vector<std::int32_t> vertices_of(const py::handle& array, const std::string& name, std::int64_t count);

// Reads an array of n x 3 finite numbers. rows: the n that is wanted; negative: any. Throws InputError.
Positions positions_of(const py::handle& array, const std::string& name, Eigen::Index rows = -1);
// Reads three finite numbers. Throws InputError.
Vec3 vector_of(const py::handle& array, const std::string& name);

// Returns an array that looks at rows without copying them. It keeps them alive.
py::array view_of(const std::shared_ptr<Positions>& rows, bool writeable = false);

// Copies rows into `sorted`, in the order of the body's mesh. `sorted` stays where it is, because arrays look at it.
inline void sort_rows(const Model& model, const Positions& rows, Positions& sorted) {
  for (int v = 0; v < model.vertices; ++v)
    std::copy_n(rows.data() + 3 * std::ptrdiff_t(v), 3,
                sorted.data() + 3 * std::ptrdiff_t(model.input_of[std::size_t(v)]));
}

// Returns an array with a copy of the rows.
template <class Rows>
py::array copy_of(const Rows& rows) {
  using Number = typename Rows::Scalar;
  py::array_t<Number> array({rows.rows(), rows.cols()});
  auto out = array.template mutable_unchecked<2>();
  for (Eigen::Index r = 0; r < rows.rows(); ++r) {
    for (Eigen::Index c = 0; c < rows.cols(); ++c) out(r, c) = rows(r, c);
  }
  return array;
}

}  // namespace supple::python
