// Names sizes of pictures, for the key output.size and the option --size.
#pragma once

#include <optional>
#include <string>

namespace supple {

struct PictureSize {
  int width, height;  // pixels
};

// Returns the size that a name or WIDTHxHEIGHT says; nothing where it says none, or one that no film can have.
std::optional<PictureSize> picture_size(const std::string& text);

// Lists the names and sizes that picture_size() accepts, for messages.
std::string picture_size_words();

}  // namespace supple
