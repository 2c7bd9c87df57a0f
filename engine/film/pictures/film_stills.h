// Writes the pictures that stand for a whole film: a poster and a contact sheet.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace supple {

// Writes sheet.png into the folder of a film: up to a dozen of the pictures in frames/, with their times. times: the
// time of each picture [s]. Returns the file. Throws InputError where a picture cannot be read, RunError where the
// sheet cannot be written.
std::filesystem::path write_sheet(const std::filesystem::path& folder, const std::string& title,
                                  const std::vector<double>& times);

// Does the same, and makes poster.png, a copy of the picture in the middle of the film. Returns the files.
std::vector<std::filesystem::path> write_stills(const std::filesystem::path& folder, const std::string& title,
                                                const std::vector<double>& times);

}  // namespace supple
