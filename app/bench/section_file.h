// Stores finished sections of a report, so that an interrupted run can be resumed where it stopped.
#pragma once

#include <filesystem>
#include <optional>

#include "output/pages/report_page.h"

namespace supple {

// Writes a section. made_with: describes the program, the build, the machine and the options; a section that was made
// with others is not read back.
void write_section(const ReportSection& section, const std::string& made_with, const std::filesystem::path& file);
std::optional<ReportSection> read_section(const std::filesystem::path& file, const std::string& made_with);

}  // namespace supple
