// Tests rates of films as fractions: how they are read and written, and the times of frames.
#include "base/frame_rate.h"

#include <gtest/gtest.h>

#include <cmath>


namespace supple {
namespace frame_rate_test {

TEST(FrameRate, ReadsFractionsAndNumbers) {
  const auto text_of = [](const char* text) {
    const auto rate = FrameRate::parse(text);
    return rate ? rate->text() : "refused";
  };
  EXPECT_EQ(text_of("30000/1001"), "30000/1001");
  EXPECT_EQ(text_of("60/2"), "30");
  EXPECT_EQ(text_of("24"), "24");
  EXPECT_EQ(text_of("12.5"), "12.5");
  EXPECT_EQ(text_of("10/3"), "10/3");
  for (const char* wrong : {"", "/", "30/", "/1001", "30/0", "0", "-24", "1e999", "nan", "30 fps", "30/1/1", "-30/1",
                            "30.5/2", "99999999999/1"})
    EXPECT_EQ(text_of(wrong), "refused") << wrong;
}

TEST(FrameRate, TakesShortFormsForTheRatesOfTelevision) {
  EXPECT_EQ(FrameRate(23.976).text(), "24000/1001");
  EXPECT_EQ(FrameRate(23.98).text(), "24000/1001");
  EXPECT_EQ(FrameRate(29.97).text(), "30000/1001");
  EXPECT_EQ(FrameRate(59.94).text(), "60000/1001");
  EXPECT_EQ(FrameRate(30000.0 / 1001).text(), "30000/1001");
  EXPECT_EQ(FrameRate(29.96).text(), "29.96") << "another number is itself";
}

// Films whose rate is no fraction of television keep the steps that they had when the rate was a number.
TEST(FrameRate, IsTheNumberThatItWasMadeOf) {
  for (const double rate : {1.0, 24.0, 25.0, 30.0, 60.0, 120.0, 12.5, 33.3, 7.0 / 3, 1000.0, 99999.5, 0.01})
    EXPECT_EQ(static_cast<double>(FrameRate(rate)), rate);
  EXPECT_NEAR(FrameRate(M_PI), M_PI, 1e-14);
}

TEST(FrameRate, GivesTimesThatDoNotDrift) {
  const FrameRate rate = *FrameRate::parse("30000/1001");
  EXPECT_EQ(rate.time_of(30000), 1001.0);
  EXPECT_EQ(rate.time_of(17982), 17982 * 1001 / 30000.0) << "ten minutes";
  EXPECT_EQ(rate.time_of(999'990'000), 33366333.0);
  EXPECT_EQ(FrameRate(30).time_of(5), 5 / 30.0);
}

TEST(FrameRate, IsDividedExactly) {
  EXPECT_EQ(FrameRate(30).over(2).text(), "15");
  EXPECT_EQ(FrameRate(30).over(7).text(), "30/7");
  EXPECT_EQ(FrameRate::parse("30000/1001")->over(2).text(), "15000/1001");
}

}  // namespace frame_rate_test
}  // namespace supple
