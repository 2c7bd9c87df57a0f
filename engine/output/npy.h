// Arrays as NumPy stores them: .npy files of format version 1.0 with little-endian numbers in C order (NEP 1, "A simple
// file format for NumPy arrays"). Only what is written here is read: float64 and int32, one dimension or two.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace supple {

struct NpyShape {
  int dimensions = 1;        // 1 or 2
  std::int64_t rows = 0;     // entries of a one-dimensional array
  std::int64_t columns = 1;  // 1 in one dimension
};
constexpr NpyShape npy_list(std::int64_t entries) { return {1, entries, 1}; }
constexpr NpyShape npy_table(std::int64_t rows, std::int64_t columns) { return {2, rows, columns}; }

template <class T>
struct NpyArray {
  NpyShape shape;
  std::vector<T> values;  // row by row; the unit is the writer's
};

// The values of a shape, row by row. Throws RunError when the disk refuses.
void write_npy(const std::filesystem::path& path, NpyShape shape, std::span<const double> values);
void write_npy(const std::filesystem::path& path, NpyShape shape, std::span<const std::int32_t> values);

// Throws InputError naming the file: missing, another version, header, type or order, too few bytes or too many.
NpyArray<double> read_npy_doubles(const std::filesystem::path& path);
NpyArray<std::int32_t> read_npy_ints(const std::filesystem::path& path);

}  // namespace supple
