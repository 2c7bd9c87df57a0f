// Writes files so that every file that exists is complete: it is written under a temporary name in the same folder, and
// then renamed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>

namespace supple {

// Throws RunError with the name of the file and the system's reason; no temporary file is left behind.
void write_whole_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);
void write_whole_file(const std::filesystem::path& path, std::string_view text);
// Does the same for a file that several processes, also of several machines, may write at one time with the same text:
// each uses a temporary name of its own.
void write_whole_file_together(const std::filesystem::path& path, std::string_view text);
// Does the same as write_whole_file(), and waits for the disk: after a loss of power the file is the earlier one or the
// new one, and whole.
void write_durable_file(const std::filesystem::path& path, std::string_view text);
// Does the same for a text that comes in pieces and is never in memory as a whole: `make` passes each piece to the
// function that it is given.
using TakesText = std::function<void(std::string_view piece)>;
void write_durable_file(const std::filesystem::path& path, const std::function<void(const TakesText&)>& make);

}  // namespace supple
