// Reads and writes arrays as NumPy stores them: .npy files of format version 1.0 with little-endian numbers in C order
// (NEP 1, "A simple file format for NumPy arrays"). It reads only what it writes: float64 and int32, in one or two
// dimensions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace supple {

struct NpyShape {
  int dimensions = 1;        // 1 or 2
  std::int64_t rows = 0;     // number of entries of a one-dimensional array
  std::int64_t columns = 1;  // 1 in one dimension
};
constexpr NpyShape npy_list(std::int64_t entries) { return {1, entries, 1}; }
constexpr NpyShape npy_table(std::int64_t rows, std::int64_t columns) { return {2, rows, columns}; }

template <class T>
struct NpyArray {
  NpyShape shape;
  std::vector<T> values;  // row by row; the writer defines their unit
};

// Writes the values of an array of this shape, row by row. Throws RunError when the file cannot be written.
void write_npy(const std::filesystem::path& path, NpyShape shape, std::span<const double> values);
void write_npy(const std::filesystem::path& path, NpyShape shape, std::span<const std::int32_t> values);

// Reads an array. Throws InputError naming the file when it is missing, has another version, header, type or order, or
// holds too few or too many bytes.
NpyArray<double> read_npy_doubles(const std::filesystem::path& path);
NpyArray<std::int32_t> read_npy_ints(const std::filesystem::path& path);

}  // namespace supple
