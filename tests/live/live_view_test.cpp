// Tests the camera of a page: it moves as asked, and goes along with what the scene's camera follows.
#include <gtest/gtest.h>

#include <cmath>

#include "live/live_view.h"

namespace supple {
namespace live_view_test {

DrawList list_with(const Camera& camera, std::optional<Vec3> moved = {}) {
  DrawList list;
  list.camera = camera;
  if (moved) list.followed = Followed{0, *moved};
  return list;
}

const Camera front{Vec3(0, 0, 2), Vec3(0, 0, 0), 30};

TEST(LiveView, IsTheScenesUntilItIsChanged) {
  LiveView view;
  EXPECT_EQ(view.see(list_with(front)).eye, front.eye);
  EXPECT_FALSE(view.is_own());
  view.zoom(2);
  EXPECT_TRUE(view.is_own());
  EXPECT_NEAR(view.see(list_with({Vec3(9, 9, 9), Vec3(0, 0, 0), 30})).eye.z(), 1, 1e-12);
  view.home();
  EXPECT_EQ(view.see(list_with(front)).eye, front.eye);
}

TEST(LiveView, OrbitsAboutItsTarget) {
  LiveView view;
  (void)view.see(list_with(front));
  view.orbit({90, 0});
  EXPECT_TRUE(view.see(list_with(front)).eye.isApprox(Vec3(2, 0, 0), 1e-12));
  view.orbit({0, 30});
  EXPECT_NEAR(view.see(list_with(front)).eye.y(), 1, 1e-12);
  for (int i = 0; i < 10; ++i) view.orbit({0, 100});
  const Camera high = view.see(list_with(front));
  EXPECT_NEAR(high.eye.norm(), 2, 1e-12);
  EXPECT_NEAR(high.eye.y(), 2 * std::sin(89 * M_PI / 180), 1e-9);
}

TEST(LiveView, PansByThePicturesHeight) {
  LiveView view;
  (void)view.see(list_with(front));
  view.pan({0, 1});  // the scene goes up by the whole height, so the camera goes down
  const double height = 4 * std::tan(15 * M_PI / 180);
  const Camera camera = view.see(list_with(front));
  EXPECT_TRUE(camera.target.isApprox(Vec3(0, -height, 0), 1e-9)) << camera.target;
  EXPECT_TRUE((camera.eye - camera.target).isApprox(front.eye, 1e-12));
}

TEST(LiveView, GoesAlongWithWhatTheScenesCameraFollows) {
  LiveView view;
  (void)view.see(list_with(front, Vec3(1, 0, 0)));
  view.zoom(2);
  EXPECT_TRUE(view.see(list_with(front, Vec3(1, 0, 0))).eye.isApprox(Vec3(0, 0, 1), 1e-12));
  EXPECT_TRUE(view.see(list_with(front, Vec3(3, 0, 0))).eye.isApprox(Vec3(2, 0, 1), 1e-12));
}

}  // namespace live_view_test
}  // namespace supple
