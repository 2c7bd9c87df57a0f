// Tests the film of a model without a scene, and films in sizes by name, as somebody sees them who calls the program.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "output/files/png_file.h"
#include "output/motion/point_cache.h"
#include "output/run/run_folder.h"
#include "support/bodies.h"
#include "support/program.h"
#include "support/surfaces.h"

namespace supple {
namespace default_film_test {

using test::box_surface;
using test::moved;
using test::run;
using test::together;

std::string obj_of(const TriMesh& mesh) {
  std::string text;
  for (const auto& p : mesh.points.rowwise()) text += fmt::format("v {} {} {}\n", p[0], p[1], p[2]);
  for (const auto& t : mesh.triangles.rowwise()) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

// A table on legs that are much thinner than its elements.
TriMesh thin_table() {
  TriMesh table = moved(box_surface({0.5, 0.08, 0.4}), {0, 0.8, 0});
  for (const double x : {-0.42, 0.42})
    for (const double z : {-0.32, 0.32}) table = together(table, moved(box_surface({0.03, 0.39, 0.03}), {x, 0.35, z}));
  return table;
}

// A tower that lies on its round side: its axis is z.
TriMesh tower() {
  TriMesh tower = test::sphere_surface(1, 16, 12);
  for (Eigen::Index v = 0; v < tower.points.rows(); ++v) {
    const Vec3 p = tower.points.row(v);
    tower.points.row(v) << p.x(), p.z(), 3 * std::clamp(p.y(), -0.7, 0.7);
  }
  return test::inside_out(tower);
}

class DefaultFilm : public testing::Test {
 protected:
  void film(const std::string& name, const TriMesh& model, const std::vector<std::string>& more = {}) {
    std::ofstream(folder_.path / name) << obj_of(model);
    std::vector<std::string> words = {"render",  name,
                                      "--out",   "run",
                                      "--force", "--no-video",
                                      "--set",   "look.backdrop=plain",
                                      "--set",   "body.model.vertices=1500"};
    words.insert(words.end(), more.begin(), more.end());
    result_ = run(folder_.path, words);
    ASSERT_EQ(result_.status, 0) << result_.err;
  }

  // Returns the box of what is seen in a picture, in shares of its width and height.
  Bounds seen(int frame) const {
    const PngImage image = read_png(picture_file(folder_.path / "run" / "frames", frame));
    Bounds box;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const std::size_t at = 3 * (std::size_t(y) * image.width + x);
        int differs = 0;
        for (std::size_t k = 0; k < 3; ++k) differs += std::abs(int(image.rgb[at + k]) - int(image.rgb[k]));
        if (differs < 24) continue;
        box.include({double(x) / image.width, double(y) / image.height, 0});
        box.include({(x + 1.0) / image.width, (y + 1.0) / image.height, 0});
      }
    }
    return box;
  }

  // Returns the heights of the lowest and the highest drawn point in the last frame [m].
  Eigen::Vector2d heights() const {
    const test::Result skins = run(folder_.path, {"draw", "run", "--skins", "--out", "skins", "--quiet"});
    EXPECT_EQ(skins.status, 0) << skins.err;
    PointCacheReader motion(folder_.path / "skins" / "motion" / "model.pc2");
    const Positions last = motion.frame(motion.frames() - 1);
    return {last.col(1).minCoeff(), last.col(1).maxCoeff()};
  }

  void expect_whole_in_every_picture() const {
    const nlohmann::json profile = test::profile_of(folder_.path / "run");
    for (const auto& row : profile["frames"])
      for (const auto& body : row["bodies"]) EXPECT_EQ(body["in_picture"].get<double>(), 1) << row["frame"];
    for (const int frame : {0, 30, 89}) {
      const Bounds box = seen(frame);
      EXPECT_GT(box.lower.head<2>().minCoeff(), 0) << frame;
      EXPECT_LT(box.upper.head<2>().maxCoeff(), 1) << frame;
    }
  }

  test::TemporaryFolder folder_;
  test::Result result_;
};

const std::vector<std::string> small = {"--size", "192x108"};

TEST_F(DefaultFilm, OfThinLegsStandsOnTheGroundWhereItIsDrawn) {
  film("table.obj", thin_table(), small);
  expect_whole_in_every_picture();
  EXPECT_GT(seen(89).extent().y(), 0.5);
  const Eigen::Vector2d height = heights();
  EXPECT_NEAR(height[0], 0, 1.5e-3) << "a pixel of 720 is a millimetre";
  EXPECT_GT(height[1] - height[0], 0.9 * 0.5 * 0.94) << "its longest side is 1 m, which becomes 0.5 m";
  EXPECT_EQ(result_.err.find("point up"), std::string::npos) << result_.err;
  EXPECT_NE(result_.err.find("sags by at most some 5 % of its height with young = "), std::string::npos) << result_.err;
}

TEST_F(DefaultFilm, StandsATallModelUpAndSaysSo) {
  film("tower.obj", tower(), small);
  EXPECT_NE(result_.err.find("note: tower.obj: its z axis is taken to point up, because"), std::string::npos)
      << result_.err;
  EXPECT_NE(result_.err.find("the camera shows the bodies' whole motion: a rough first pass of all 90 frames"),
            std::string::npos)
      << result_.err;
  expect_whole_in_every_picture();
  EXPECT_GT(seen(89).extent().y(), 0.6);
  const Eigen::Vector2d height = heights();
  EXPECT_NEAR(height[0], 0, 1.5e-3);
  EXPECT_GT(height[1], 0.44);
  EXPECT_LT(height[1], 0.495);
}

TEST_F(DefaultFilm, IsAsStiffAsItsSizeAndItsAxisAskFor) {
  film("table.obj", thin_table(), {"--size", "192x108", "--frames", "1"});
  const auto young = [&] {
    const std::size_t at = result_.err.find("young = ");
    return at == std::string::npos ? 0.0 : std::stod(result_.err.substr(at + 8));
  };
  const double usual = young();
  film("table.obj", thin_table(), {"--size", "192x108", "--frames", "1", "--set", "body.model.size=2"});
  EXPECT_NE(result_.err.find("it is made 2 m long, and falls"), std::string::npos) << result_.err;
  EXPECT_GT(young(), 2.5 * usual) << "stresses of weight grow with the size, and the trials go in steps";
  EXPECT_LT(young(), 6 * usual);
  film("table.obj", thin_table(), {"--size", "192x108", "--frames", "1", "--set", "body.model.up=-y"});
  EXPECT_LT(young(), 0.5 * usual) << "it lies on its top, with its legs in the air";
}

TEST_F(DefaultFilm, IsFramedForEachShapeOfThePicture) {
  for (const char* size : {"108x192", "128x128"}) {
    film("table.obj", thin_table(), {"--size", size});
    expect_whole_in_every_picture();
    const Bounds box = seen(89);
    EXPECT_GT(box.extent().head<2>().maxCoeff(), 0.75) << size;
  }
}

}  // namespace default_film_test
}  // namespace supple
