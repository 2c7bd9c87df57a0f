// Prepares pictures with coverage for the encoders of transparent films. Colours of pixels are not multiplied by their
// coverage, in pictures and in films.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace supple {

// Returns the colours of a picture, with those of covered pixels close by where nothing is covered. Lossy encoders and
// programs that scale a film mix neighbouring pixels: so a border keeps its own colour, and black beside it does not
// make it dark.
std::vector<std::uint8_t> filled_colors(int width, int height, std::span<const std::uint8_t> rgb,
                                        std::span<const std::uint8_t> alpha);

// Returns red, green, blue and coverage by pixel, for a format whose pixels are covered or not. A pixel with a colour
// counts as covered if at least half of it is. Black pixels, which are those of shadows, are dithered: where they are
// half covered, every second one counts as covered (Bayer 1973, ordered dither of 4 x 4 pixels). So soft shadows stay
// soft, and what stands still does so in the film.
std::vector<std::uint8_t> dithered_coverage(int width, std::span<const std::uint8_t> rgb,
                                            std::span<const std::uint8_t> alpha);

}  // namespace supple
