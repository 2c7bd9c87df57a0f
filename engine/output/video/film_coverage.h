// Prepares pictures with coverage for the encoders of transparent films. Colours of pixels are not multiplied by their
// coverage, in pictures and in films.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace supple {

// Returns the colours with others where nothing is covered: those of covered pixels close by. Encoders that lose a
// little mix neighbours, and programs that scale a film do; a border then keeps its own colour, where black would make
// it dark.
std::vector<std::uint8_t> filled_colors(int width, int height, std::span<const std::uint8_t> rgb,
                                        std::span<const std::uint8_t> alpha);

// Returns red, green, blue and coverage by pixel, for a format whose pixels are covered or not. A pixel with a colour
// is covered where at least half of it is. Of black, which is what shadows are, a part that is half covered has every
// second pixel (Bayer 1973, ordered dither of 4 x 4 pixels), so that soft shadows stay soft, and what stands still does
// so in the film.
std::vector<std::uint8_t> dithered_coverage(int width, std::span<const std::uint8_t> rgb,
                                            std::span<const std::uint8_t> alpha);

}  // namespace supple
