// Converts pictures of sRGB bytes to the colours of a film: planes of BT.709 luma and chroma, as encoders take them.
// Where a file does not say which matrix it has, players assume that of BT.709.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace supple {

// Sets `planes` to Y, Cb and Cr (ITU-R BT.709-6, section 3: Y from 16 to 235, Cb and Cr from 16 to 240), one after the
// other. Chroma has half the width and height; each value lies on an even column and between two rows, as H.264 has it
// where a file does not say otherwise (ITU-T H.264, annex E.2.1). width and height must be even.
void film_planes(int width, int height, std::span<const std::uint8_t> rgb, std::vector<std::uint8_t>& planes);

// Does the same with 10 bits a value (Y from 64 to 940, Cb and Cr from 64 to 960), each in two bytes, the lower one
// first, and with chroma for each pixel. alpha: coverage by pixel, which becomes a fourth plane (0 to 1023); empty:
// there is none.
void fine_film_planes(std::span<const std::uint8_t> rgb, std::span<const std::uint8_t> alpha,
                      std::vector<std::uint8_t>& planes);

}  // namespace supple
