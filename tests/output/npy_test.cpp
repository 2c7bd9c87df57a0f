#include "output/files/npy.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <string>

#include "base/error.h"
#include "output/files/whole_file.h"
#include "support/bodies.h"

namespace supple {
namespace npy_test {

// Makes a file with this dictionary, padded as NumPy does, and some bytes of values.
std::string file_of(const std::string& dictionary, std::size_t value_bytes) {
  std::string header = dictionary;
  while ((10 + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  return std::string("\x93NUMPY\x01\x00", 8) + char(header.size() % 256) + char(header.size() / 256) + header +
         std::string(value_bytes, '\0');
}

// Returns what reading a file with these bytes reports, without the file's name.
std::string complaint_of(const std::string& bytes) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path / "a.npy";
  write_whole_file(path, bytes);
  try {
    (void)read_npy_doubles(path);
  } catch (const InputError& error) {
    const std::string text = error.what(), name = path.string() + ": ";
    EXPECT_EQ(error.problems().size(), 1u);
    EXPECT_TRUE(text.starts_with(name)) << text;
    return text.substr(std::min(text.size(), name.size()));
  }
  return "";
}

TEST(Npy, WritesTheBytesThatNumPyWrites) {
  const test::TemporaryFolder folder;
  const std::vector<double> values = {1, 2, 3, 4, 5, 6};
  write_npy(folder.path / "a.npy", npy_table(2, 3), std::span<const double>(values));
  std::string expected = file_of("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }", 48);
  std::memcpy(expected.data() + 128, values.data(), 48);
  EXPECT_EQ(test::read_file(folder.path / "a.npy"), expected);
  const std::vector<std::int32_t> list = {-7};
  write_npy(folder.path / "b.npy", npy_list(1), std::span<const std::int32_t>(list));
  expected = file_of("{'descr': '<i4', 'fortran_order': False, 'shape': (1,), }", 4);
  std::memcpy(expected.data() + 128, list.data(), 4);
  EXPECT_EQ(test::read_file(folder.path / "b.npy"), expected);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path), {}), 2);
}

TEST(Npy, GivesBackEveryBitOfWhatItWrote) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path / "a.npy";
  const std::vector<double> values = {0.1, -0.0, std::numeric_limits<double>::denorm_min(), 1e308, -1.0 / 3, 7};
  for (const NpyShape shape : {npy_list(6), npy_table(2, 3), npy_table(6, 1), npy_table(1, 6)}) {
    write_npy(path, shape, std::span<const double>(values));
    const NpyArray<double> read = read_npy_doubles(path);
    EXPECT_EQ(read.shape.dimensions, shape.dimensions);
    EXPECT_EQ(read.shape.rows, shape.rows);
    EXPECT_EQ(read.shape.columns, shape.columns);
    ASSERT_EQ(read.values.size(), values.size());
    EXPECT_EQ(std::memcmp(read.values.data(), values.data(), 48), 0);
  }
  const std::vector<std::int32_t> list = {1, -2, std::numeric_limits<std::int32_t>::min()};
  write_npy(path, npy_list(3), std::span<const std::int32_t>(list));
  EXPECT_EQ(read_npy_ints(path).values, list);
  write_npy(path, npy_table(0, 4), std::span<const std::int32_t>());
  EXPECT_EQ(read_npy_ints(path).shape.columns, 4);
  EXPECT_TRUE(read_npy_ints(path).values.empty());
}

TEST(Npy, ReadsHeadersThatOthersSpaceAndOrderDifferently) {
  for (const char* dictionary : {"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3)}",
                                 "{'shape':(2,3),'fortran_order':False,'descr':'<f8'}",
                                 "{ 'shape' : ( 2 , 3 , ) , 'descr' : '<f8' , 'fortran_order' : False }"})
    EXPECT_EQ(complaint_of(file_of(dictionary, 48)), "") << dictionary;
}

TEST(Npy, RefusesEveryDamageWithOneMessage) {
  const std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }";
  const std::string good = file_of(header, 48);
  ASSERT_EQ(complaint_of(good), "");
  for (std::size_t length = 0; length < good.size(); ++length)
    ASSERT_NE(complaint_of(good.substr(0, length)), "") << length;
  EXPECT_EQ(complaint_of(""), "is not a .npy file");
  EXPECT_EQ(complaint_of(good.substr(0, 40)), "ends within its header");
  EXPECT_EQ(complaint_of(good.substr(0, 150)), "holds 22 bytes of values; its shape, 2 x 3, takes 48");
  EXPECT_EQ(complaint_of(good + "x"), "holds 49 bytes of values; its shape, 2 x 3, takes 48");
  std::string other = good;
  other[6] = 2;
  EXPECT_EQ(complaint_of(other), "is of .npy version 2.0; version 1.0 is read");
  other = good;
  other[127] = ' ';
  EXPECT_EQ(complaint_of(other), "the header does not end with its line");
  const auto said = [](const std::string& dictionary) { return complaint_of(file_of(dictionary, 48)); };
  const auto with_shape = [&](const std::string& shape) {
    return said("{'descr': '<f8', 'fortran_order': False, 'shape': " + shape + ", }");
  };
  EXPECT_EQ(said("{'descr': '>f8', 'fortran_order': False, 'shape': (2, 3), }"),
            "holds numbers of type '>f8' where '<f8' is read");
  EXPECT_EQ(said("{'descr': '<i4', 'fortran_order': False, 'shape': (2, 6), }"),
            "holds numbers of type '<i4' where '<f8' is read");
  EXPECT_EQ(said("{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }"), "is in Fortran order; C order is read");
  EXPECT_EQ(with_shape("()"), "has no dimension; one or two are read");
  EXPECT_EQ(with_shape("(1, 2, 3)"), "has more than two dimensions; one or two are read");
  EXPECT_EQ(with_shape("(4611686018427387904, 4)"),
            "holds 48 bytes of values; its shape, 4611686018427387904 x 4, takes more");
  const std::string damaged = "the header is not that of a .npy file: descr, fortran_order and shape, once each";
  for (const char* shape :
       {"(-2, -3)", "(2, 3", "2, 3", "(2. , 3)", "(2 3)", "(6)", "(, 6)", "(99999999999999999999, 1)"})
    EXPECT_EQ(with_shape(shape), damaged) << shape;
  for (const std::string& dictionary :
       {std::string(), std::string("{}"), header.substr(1), header + "}", header + " 1",
        std::string("{'descr': '<f8', 'fortran_order': False}"),
        std::string("{'descr': '<f8', 'descr': '<f8', 'fortran_order': False, 'shape': (2, 3)}"),
        std::string("{'descr': '<f8', 'fortran_order': 0, 'shape': (2, 3)}"),
        std::string("{'descr': '<f8, 'fortran_order': False, 'shape': (2, 3)}"),
        std::string("{'descr': '<f8' 'fortran_order': False, 'shape': (2, 3)}"),
        std::string("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), 'extra': 1}")})
    EXPECT_EQ(said(dictionary), damaged) << dictionary;
}

TEST(Npy, SaysWhenThereIsNoFile) {
  try {
    (void)read_npy_ints("/nowhere/q.npy");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), "/nowhere/q.npy: no such file");
  }
}

}  // namespace npy_test
}  // namespace supple
