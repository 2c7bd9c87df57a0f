// Names the files and folders of the project and of its build that tests use.
#pragma once

#include <filesystem>

namespace supple::test {

// Only shipped_files.cpp is compiled with these paths, so that all other units are the same in every checkout, and a
// compiler's cache can share them.
extern const char* const source_folder_name;
extern const char* const build_folder_name;
// The program that tests start.
extern const char* const program_name;
// The library that makes calls on files fail (failing_calls_test.cpp).
extern const char* const failing_calls_name;

inline const std::filesystem::path source_folder = source_folder_name;
inline const std::filesystem::path assets = source_folder / "assets";
inline const std::filesystem::path build_folder = build_folder_name;

}  // namespace supple::test
