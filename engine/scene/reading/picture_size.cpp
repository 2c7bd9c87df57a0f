#include "scene/reading/picture_size.h"

#include <fmt/core.h>

#include <array>
#include <cstdio>
#include <utility>

namespace supple {
namespace {

constexpr std::array<std::pair<const char*, PictureSize>, 5> named_sizes = {{{"portrait", {1080, 1920}},
                                                                             {"square", {1080, 1080}},
                                                                             {"720p", {1280, 720}},
                                                                             {"1080p", {1920, 1080}},
                                                                             {"4k", {3840, 2160}}}};

// Tells whether output.width and output.height may have this value.
bool is_allowed(int side) { return side >= 16 && side <= 8192 && side % 2 == 0; }

}  // namespace

std::optional<PictureSize> picture_size(const std::string& text) {
  for (const auto& [name, size] : named_sizes)
    if (text == name) return size;
  PictureSize size{};
  int read = 0;
  if (std::sscanf(text.c_str(), "%dx%d%n", &size.width, &size.height, &read) != 2 || read != std::ssize(text))
    return std::nullopt;
  return is_allowed(size.width) && is_allowed(size.height) ? std::optional(size) : std::nullopt;
}

std::string picture_size_words() {
  std::string words;
  for (const auto& [name, size] : named_sizes) words += fmt::format("{} ({}x{}), ", name, size.width, size.height);
  return words + "or WIDTHxHEIGHT, even numbers from 16 to 8192";
}

}  // namespace supple
