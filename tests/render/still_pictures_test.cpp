// Tests that pictures in which nothing has moved, or the camera alone, are those that a new renderer draws.
#include <gtest/gtest.h>

#include "render/renderer.h"
#include "support/places.h"

namespace supple {
namespace still_pictures_test {

const std::filesystem::path shaders = test::source_folder / "shaders";

// A square over the ground, which casts a shadow.
struct Scenery {
  Stage stage;
  DrawList list;

  Scenery() {
    DrawMesh mesh;
    std::vector<float> places;
    for (const float x : {-0.3f, 0.3f}) {
      for (const float z : {-0.3f, 0.3f}) {
        places.insert(places.end(), {x, 0.3f, z});
        mesh.rest.include(Vec3(x, 0.3, z));
      }
    }
    mesh.triangles = {0, 1, 2, 1, 3, 2};
    mesh.occlusion.assign(4, 1.0f);
    mesh.two_sided = true;
    stage.meshes.push_back(std::move(mesh));
    stage.width = 160;
    stage.height = 90;
    list.positions.push_back(std::move(places));
    list.camera.eye = Vec3(0.3, 0.9, 2.0);
    list.camera.target = Vec3(0, 0.2, 0);
    stage.first_camera = list.camera;
  }
  std::vector<std::uint8_t> drawn_anew(const DrawList& of) const {
    return Renderer(stage, GlChoice::osmesa, shaders).draw(of).rgb;
  }
};

// Each list is drawn by a renderer of its own first: there is one current context on a thread.
TEST(StillPictures, AreThoseThatANewRendererDraws) {
  const Scenery scenery;
  std::vector<DrawList> lists = {scenery.list};
  const auto next = [&]() -> DrawList& { return lists.emplace_back(DrawList(lists.back())); };
  next().camera.eye.x() += 0.2;
  next().positions[0][1] += 0.2f;
  next().marks.push_back({0, 0.5f, 0, 1});
  next().marks.clear();
  std::vector<std::vector<std::uint8_t>> wanted;
  for (const DrawList& list : lists) wanted.push_back(scenery.drawn_anew(list));
  Renderer renderer(scenery.stage, GlChoice::osmesa, shaders);
  for (std::size_t i = 0; i < lists.size(); ++i) {
    if (i > 0) {
      EXPECT_NE(wanted[i], wanted[i - 1]) << i;
    }
    for (const bool again : {false, true}) EXPECT_EQ(renderer.draw(lists[i]).rgb, wanted[i]) << i << again;
  }
}

TEST(StillPictures, TakeNewColoursAndMeshes) {
  Scenery scenery;
  Renderer renderer(scenery.stage, GlChoice::osmesa, shaders);
  const std::vector<std::uint8_t> first = renderer.draw(scenery.list).rgb;
  DrawList change = scenery.list;
  change.colors = StageColors{Vec3(0.1, 0.3, 0.2), Vec3(0.2, 0.1, 0.3), 1.0};
  const std::vector<std::uint8_t> colored = renderer.draw(change).rgb;
  EXPECT_NE(colored, first);
  EXPECT_EQ(renderer.draw(scenery.list).rgb, colored) << "the colours stay";
  DrawMesh mesh = scenery.stage.meshes[0];
  mesh.color = Vec3(0.9, 0.1, 0.1);
  change = scenery.list;
  change.renewed.emplace_back(0, mesh);
  const std::vector<std::uint8_t> renewed = renderer.draw(change).rgb;
  EXPECT_NE(renewed, colored);
  EXPECT_EQ(renderer.draw(scenery.list).rgb, renewed) << "the mesh stays";
}

// What moved while the shutter was open stands elsewhere in the last of its pictures.
TEST(StillPictures, AreNotThoseOfAnExposure) {
  const Scenery scenery;
  DrawList open = scenery.list, seen_from_beside = scenery.list;
  open.exposure.emplace();
  open.exposure->open = 0.5;
  open.exposure->before = scenery.list.positions;
  open.exposure->camera_before = scenery.list.camera;
  for (float& place : open.exposure->before.front()) place += 0.1f;
  seen_from_beside.camera.eye.x() += 0.2;
  const std::vector<std::uint8_t> sharp = scenery.drawn_anew(scenery.list);
  const std::vector<std::uint8_t> beside = scenery.drawn_anew(seen_from_beside);
  Renderer renderer(scenery.stage, GlChoice::osmesa, shaders);
  EXPECT_EQ(renderer.draw(scenery.list).rgb, sharp);
  renderer.draw(open);
  EXPECT_EQ(renderer.draw(seen_from_beside).rgb, beside);
}

}  // namespace still_pictures_test
}  // namespace supple
