#include "sim/model/elastic_hessian.h"

#include <algorithm>

#include "base/error.h"
#include "sim/model/bending.h"
#include "sim/model/element_view.h"

namespace supple {
namespace {

double packed(const double* numbers, int i, int j) {
  return i >= j ? numbers[i * (i + 1) / 2 + j] : numbers[j * (j + 1) / 2 + i];
}

// Expands the element's packed matrix to the full one, 3 c x 3 c: the first corner's rows and columns are minus the
// sums of the others'.
void unpack(const double* numbers, int corners, double (&full)[12][12]) {
  const int inner = 3 * (corners - 1);
  for (int i = 0; i < inner; ++i) {
    for (int j = 0; j < inner; ++j) full[3 + i][3 + j] = packed(numbers, i, j);
  }
  for (int i = 0; i < inner; ++i) {
    for (int c = 0; c < 3; ++c) {
      double sum = 0;
      for (int k = 1; k < corners; ++k) sum += full[3 + i][3 * k + c];
      full[3 + i][c] = full[c][3 + i] = -sum;
    }
  }
  for (int c = 0; c < 3; ++c) {
    for (int d = 0; d < 3; ++d) {
      double sum = 0;
      for (int k = 1; k < corners; ++k) sum += full[3 * k + c][d];
      full[c][d] = -sum;
    }
  }
}

}  // namespace

void element_matrices(const Model& model, Threads* threads, const Positions& x, bool project, ElementMatrices& out) {
  const int chunks = static_cast<int>(model.chunks.size());
  if (out.first.empty()) {
    std::size_t count = 0;
    for (const Model::ChunkRange& range : model.chunks) {
      out.first.push_back(count);
      count += std::size_t(range.blocks) * block_width * stiffness_numbers(range.kind);
    }
    out.numbers.resize(count);
  }
  run_chunks(threads, chunks, long(model.elements) * 40, [&](int c) {
    element_kernels().stiffness(model.chunk(c), x.data(), project, out.numbers.data() + out.first[c]);
  });
}

namespace {

// Returns the pairs of free vertices that share a block of the lower triangle: a vertex with itself, and vertices that
// an element, a bend, a seam or a triangle of the surface joins. Pairs are sorted by their first vertex, the smaller
// one.
std::vector<std::pair<std::int32_t, std::int32_t>> coupled_vertices(const Model& model) {
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  const auto add = [&](std::int32_t column, std::int32_t row) {
    if (row > column && row < model.free) pairs.emplace_back(column, row);
  };
  for (int v = 0; v < model.free; ++v) pairs.emplace_back(v, v);
  for_each_element(model, [&](const ElementView& element) {
    const int corners = corners_of(element.kind);
    for (int a = 0; a < corners; ++a) {
      for (int b = 0; b < corners; ++b) add(element.corner[b], element.corner[a]);
    }
  });
  for (int v = 0; v < model.free && !model.bending.begin.empty(); ++v) {
    for (std::int32_t k = model.bending.begin[v]; k < model.bending.begin[v + 1]; ++k) add(v, model.bending.column[k]);
  }
  for (const SeamPair& pair : model.seams.pairs)
    pair.for_each_entry([&](std::int32_t row, std::int32_t column, double) { add(column, row); });
  // Contact couples the vertices of a triangle, which springs need not do.
  for (Eigen::Index t = 0; t < model.surface.rows(); ++t) {
    for (const std::int32_t row : model.surface.row(t)) {
      for (const std::int32_t column : model.surface.row(t)) add(column, row);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

// Calls visit(row, column, value) for the numbers of seams in the lower triangle over the free vertices.
template <class Visit>
void for_each_seam_entry(const Model& model, const Visit& visit) {
  for (const SeamPair& pair : model.seams.pairs)
    pair.for_each_entry([&](std::int32_t row, std::int32_t column, double value) {
      if (row >= column && row < model.free) visit(row, column, value);
    });
}

}  // namespace

ElasticHessian::ElasticHessian(const Model& model) {
  block_begin_.assign(model.free + 1, 0);
  for (const auto& [column, row] : coupled_vertices(model)) {
    ++block_begin_[column + 1];
    block_row_.push_back(row);
  }
  for (int v = 0; v < model.free; ++v) block_begin_[v + 1] += block_begin_[v];
  make_pattern(model.free);
  find_places(model);
}

void ElasticHessian::make_pattern(int vertices) {
  const std::size_t numbers = 9 * block_row_.size();
  matrix_.resize(3 * vertices, 3 * vertices);
  matrix_.resizeNonZeros(static_cast<Eigen::Index>(numbers));
  int* outer = matrix_.outerIndexPtr();
  int* inner = matrix_.innerIndexPtr();
  for (int v = 0; v < vertices; ++v) {
    const int rows = block_begin_[v + 1] - block_begin_[v];
    for (int c = 0; c < 3; ++c) {
      const int begin = 9 * block_begin_[v] + 3 * c * rows;
      outer[3 * v + c] = begin;
      for (int i = 0; i < rows; ++i) {
        for (int d = 0; d < 3; ++d) inner[begin + 3 * i + d] = 3 * block_row_[block_begin_[v] + i] + d;
      }
    }
  }
  outer[3 * vertices] = static_cast<int>(numbers);
}

void ElasticHessian::find_places(const Model& model) {
  for (const Model::ChunkRange& range : model.chunks) {
    first_place_.push_back(places_.size());
    places_.resize(places_.size() + std::size_t(range.blocks) * block_width * corner_pairs(corners_of(range.kind)),
                   Place{0, 0, -1, false});
  }
  std::size_t chunk = 0;
  for_each_element(model, [&](const ElementView& element) {
    while (element.lane >= (model.chunks[chunk].first_block + model.chunks[chunk].blocks) * block_width) ++chunk;
    const int corners = corners_of(element.kind);
    Place* place =
        &places_[first_place_[chunk] +
                 std::size_t(element.lane - model.chunks[chunk].first_block * block_width) * corner_pairs(corners)];
    for (int a = 0; a < corners; ++a) {
      for (int b = 0; b <= a; ++b, ++place) {
        const std::int32_t i = element.corner[a], j = element.corner[b];
        place->row = a;
        place->column = b;
        place->swapped = i < j;
        if (std::max(i, j) < model.free) place->at = block(std::max(i, j), std::min(i, j)) - matrix_.valuePtr();
      }
    }
  });
}

double* ElasticHessian::block(std::int32_t row, std::int32_t column) {
  const auto begin = block_row_.begin() + block_begin_[column], end = block_row_.begin() + block_begin_[column + 1];
  const auto at = std::lower_bound(begin, end, row);
  return matrix_.valuePtr() + 9 * std::size_t(block_begin_[column]) + 3 * (at - begin);
}

void ElasticHessian::add(std::int32_t row, std::int32_t column, const Mat3& part) {
  double* to = block(row, column);
  const std::size_t stride = 3 * std::size_t(block_begin_[column + 1] - block_begin_[column]);
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) to[j * stride + i] += part(i, j);
  }
}

void ElasticHessian::assemble(const Model& model, const ElementMatrices& elements) {
  double* values = matrix_.valuePtr();
  std::fill(values, values + matrix_.nonZeros(), 0.0);
  const double scale = model.scheme.energy * model.scheme.theta * model.scheme.theta;
  double full[12][12];
  for (std::size_t c = 0; c < model.chunks.size(); ++c) {
    const Model::ChunkRange& range = model.chunks[c];
    const int corners = corners_of(range.kind), pairs = corner_pairs(corners), numbers = stiffness_numbers(range.kind);
    const std::int32_t* list = model.chunk_vertex.data() + range.first_vertex;
    for (int lane = 0; lane < range.blocks * block_width; ++lane) {
      if (model.element_of_lane[range.first_block * block_width + lane] < 0) continue;
      unpack(&elements.numbers[elements.first[c] + std::size_t(lane) * numbers], corners, full);
      const Place* place = &places_[first_place_[c] + std::size_t(lane) * pairs];
      for (int p = 0; p < pairs; ++p, ++place) {
        if (place->at < 0) continue;
        const int a = place->swapped ? place->column : place->row, b = place->swapped ? place->row : place->column;
        const std::size_t block = range.first_corner + (lane / block_width) * corners * block_width;
        const std::int32_t column = list[model.corner[block + b * block_width + lane % block_width]];
        const std::size_t stride = 3 * std::size_t(block_begin_[column + 1] - block_begin_[column]);
        double* to = values + place->at;
        for (int j = 0; j < 3; ++j) {
          for (int i = 0; i < 3; ++i) to[j * stride + i] += scale * full[3 * a + i][3 * b + j];
        }
      }
    }
  }
  const double inverse_h2 = 1 / (model.time_step * model.time_step);
  for (int v = 0; v < model.free; ++v) {
    double own = model.scheme.inertia * model.mass[v] * inverse_h2;
    if (!model.handle_stiffness.empty()) own += scale * model.handle_stiffness[v];
    const auto add_row = [&](const Model::SparseRows& rows, double factor) {
      if (rows.begin.empty()) return;
      for (std::int32_t k = rows.begin[v]; k < rows.begin[v + 1]; ++k) {
        const std::int32_t row = rows.column[k];
        if (row >= v && row < model.free) add(row, v, factor * rows.value[k] * Mat3::Identity());
      }
    };
    add_row(model.damping, 1);
    add_row(model.bending, scale);
    if (!model.bending.begin.empty()) own += scale * bending_diagonal(model.bending, v);
    add(v, v, own * Mat3::Identity());
  }
  for_each_seam_entry(model, [&](std::int32_t row, std::int32_t column, double value) {
    add(row, column, scale * value * Mat3::Identity());
  });
}

void ElasticHessian::multiply(const double* v, double* result) const {
  const auto count = static_cast<int>(matrix_.cols());
  std::fill(result, result + count, 0.0);
  const double* values = matrix_.valuePtr();
  for (int column = 0; column < count / 3; ++column) {
    const int begin = block_begin_[column], rows = block_begin_[column + 1] - begin;
    const double* first = values + 9 * std::size_t(begin);
    const double *second = first + 3 * std::size_t(rows), *third = second + 3 * std::size_t(rows);
    const double v0 = v[3 * column], v1 = v[3 * column + 1], v2 = v[3 * column + 2];
    // The diagonal block is stored whole; its upper half mirrors the lower.
    double sum[3] = {0, 0, 0};
    for (int k = 0; k < 3 * rows; ++k) {
      const int row = 3 * block_row_[begin + k / 3] + k % 3;
      result[row] += first[k] * v0 + second[k] * v1 + third[k] * v2;
      if (k < 3) continue;
      sum[0] += first[k] * v[row];
      sum[1] += second[k] * v[row];
      sum[2] += third[k] * v[row];
    }
    for (int c = 0; c < 3; ++c) result[3 * column + c] += sum[c];
  }
}

void ElasticHessian::shift(double amount) {
  for (int v = 0; v < matrix_.cols() / 3; ++v) {
    double* to = block(v, v);
    const std::size_t stride = 3 * std::size_t(block_begin_[v + 1] - block_begin_[v]);
    for (int c = 0; c < 3; ++c) to[c * stride + c] += amount;
  }
}

}  // namespace supple
