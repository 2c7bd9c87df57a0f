// Holds the rate of a film as a fraction of whole numbers, so that 30000/1001 frames a second are rounded neither in
// the film's file nor in the times of its frames.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace supple {

class FrameRate {
 public:
  // Takes a number of frames a second, from 1e-9 to 1e9. What is usually written for a rate of television (23.976,
  // 29.97, 59.94) becomes that rate, N x 1000/1001; other numbers become the simplest fraction that is as exact as they
  // are.
  FrameRate(double per_second);  // implicit, because most rates are whole numbers

  // Reads "30000/1001", "24" or "23.976"; returns nothing where the text is of another form, or a number in it is out
  // of range.
  static std::optional<FrameRate> parse(std::string_view text);

  operator double() const { return static_cast<double>(numerator_) / denominator_; }  // frames a second
  int numerator() const { return numerator_; }
  int denominator() const { return denominator_; }

  // Returns the time that so many frames take [s]: the nearest number to the exact one, without drift.
  double time_of(long long frames) const { return static_cast<double>(frames * denominator_) / numerator_; }

  // Returns the rate of a film that keeps one frame in `every`.
  FrameRate over(int every) const;

  // Gives "30", "12.5" or "30000/1001", as parse() and ffmpeg read it.
  std::string text() const;

  bool operator==(const FrameRate&) const = default;

 private:
  FrameRate(long long numerator, long long denominator);

  int numerator_, denominator_;  // without a common factor
};

}  // namespace supple
