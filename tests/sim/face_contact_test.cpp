// Tests contact of edges and faces between vertices, with colliders that are finer than the body's surface.
#include "sim/contact/face_points.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "geometry/meshes/cloth.h"
#include "geometry/triangles/surface_thickness.h"
#include "support/contact_scene.h"

namespace supple {
namespace face_contact_test {

using test::cube;
using test::shaken;
using test::shape_of;

// Keeps contact between vertices too.
struct FaceScene : test::ContactScene {
  FaceScene(const BodyDescription& body, std::vector<Collider> all, const Vec3& place = Vec3::Zero())
      : ContactScene(body, std::move(all), place) {
    inputs.solver.contact.points = ContactPoints::surface;
  }
};

// A thin post below the middle of one of the triangles of the cube's lower face, which has 3 x 3 cells of 0.067 m.
Collider post(double friction, double top = 0) {
  return {"post", shape_of(Capsule{Vec3(0.012, top - 1, 0.021), Vec3(0.012, top - 0.004, 0.021), 0.004}), 0, friction};
}

// Brings a scene to its first iterate, with its contacts and their stiff directions.
void prepare(FaceScene& scene) {
  scene.w.prepare(scene.model, scene.inputs.solver);
  begin_step(scene.model, scene.inputs, scene.state, scene.w);
  find_contacts_of(scene.model, scene.inputs, scene.w, scene.w.current);
  find_stiff_directions(scene.model, scene.w.current.contacts, scene.w.current.x, scene.w.correction);
}

int touching_faces(const FaceScene& scene) {
  const std::vector<Contact>& found = scene.w.current.contacts;
  return static_cast<int>(
      std::count_if(found.begin(), found.end(), [](const Contact& c) { return c.depth > 0 && c.stencil.count == 3; }));
}

// Returns the depth of the deepest of 66 evenly spread points of each triangle of the surface.
double deepest_sample(const FaceScene& scene) {
  double deepest = 0;
  for (const auto& corner : scene.model.surface.rowwise()) {
    for (int i = 0; i <= 10; ++i) {
      for (int j = 0; j <= 10 - i; ++j) {
        const Vec3 p = 0.1 * (i * scene.state.x.row(corner[0]) + j * scene.state.x.row(corner[1]) +
                              (10 - i - j) * scene.state.x.row(corner[2]))
                                 .transpose();
        for (std::size_t c = 0; c < scene.colliders.size(); ++c) {
          const Vec3 local = scene.inputs.collider_motions[c].end.inverse() * p;
          deepest = std::max(deepest, -scene.colliders[c].shape.distance(local));
        }
      }
    }
  }
  return deepest;
}

TEST(FaceContact, GradientIsTheDerivativeOfTheEnergy) {
  FaceScene scene(cube(3), {post(0.4)}, Vec3(0, 0.1005, 0));
  scene.inputs.gravity.setZero();
  scene.state.v.rowwise() = Eigen::RowVector3d(0.02, -0.07, 0.01);
  prepare(scene);
  ASSERT_GT(touching_faces(scene), 0);
  test::expect_derivative_of_contacts(scene);
}

// The planes are found again at each point.
TEST(FaceContact, PlanesGiveTheDerivativeOfTheEnergyFoundAnew) {
  const Shape shapes[] = {post(0).shape, shape_of(Sphere{0.05}), shape_of(Box{Vec3(0.01, 0.03, 0.01), 0}),
                          shape_of(Box{Vec3(0.3, 0.03, 0.01), 0.002})};
  for (const Shape& shape : shapes) {
    const double top = shape.bounds().upper.y();
    FaceScene scene(cube(3), {{"", shape}}, Vec3(0.01, top + 0.1005, 0.02));
    scene.inputs.gravity.setZero();
    scene.state.v.rowwise() = Eigen::RowVector3d(0.02, -0.07, 0.01);
    prepare(scene);
    ASSERT_GT(touching_faces(scene), 0) << top;
    const Positions x = scene.w.current.x, direction = shaken(Positions::Zero(scene.model.free, 3), 1, 6);
    Positions gradient = Positions::Zero(scene.model.free, 3);
    const double slope = add_contacts(scene.w.current.contacts, x, nullptr, direction, &gradient).slope;
    const auto energy = [&](double h) {
      Positions moved = x;
      moved.topRows(scene.model.free) += h * direction;
      std::vector<Contact> found;
      find_contacts(scene.model, scene.inputs, moved, nullptr, scene.w.contact, found);
      return contact_energy(found, moved);
    };
    double best = 1e300;
    for (const double h : {1e-6, 1e-7}) best = std::min(best, std::abs((energy(h) - energy(-h)) / (2 * h) - slope));
    EXPECT_LT(best, 1e-5 * std::abs(slope)) << top;
  }
}

// Compares (A + K)^-1 by the Woodbury identity, with contacts of faces and tangents of friction, with a dense inverse.
TEST(FaceContact, LowRankDirectionsSolveTheSystem) {
  FaceScene scene(cube(3), {post(0.5), {"ball", shape_of(Sphere{0.01}), 0, 0.5}}, Vec3(0, 0.1005, 0));
  scene.inputs.collider_motions[1].start = scene.inputs.collider_motions[1].end =
      test::moved_to(Vec3(-0.07, -0.0105, -0.05));
  scene.state.v.rowwise() = Eigen::RowVector3d(0.001, -0.05, 0);
  prepare(scene);
  ASSERT_GT(touching_faces(scene), 1);
  const auto touching = std::ranges::count_if(scene.w.current.contacts, [](const Contact& c) { return c.depth > 0; });
  ASSERT_GT(std::ssize(scene.w.correction.wanted), touching);
  const int n = scene.model.free;
  Eigen::MatrixXd inverse(3 * n, 3 * n);
  Positions r(n, 3), z(n, 3);
  for (int column = 0; column < 3 * n; ++column) {
    r.setZero();
    r.data()[column] = 1;
    scene.model.factor.solve(r.data(), z.data(), scene.w.solve_scratch);
    inverse.col(column) = Eigen::Map<const Eigen::VectorXd>(z.data(), z.size());
  }
  Eigen::MatrixXd system = inverse.inverse();
  for (const StiffDirection& s : scene.w.correction.wanted) {
    Positions along = Positions::Zero(n, 3);
    s.add(1, along);
    const Eigen::Map<const Eigen::VectorXd> vector(along.data(), along.size());
    system += s.stiffness * vector * vector.transpose();
  }
  r = shaken(Positions::Zero(n, 3), 1, 2);
  const Eigen::VectorXd wanted = system.ldlt().solve(Eigen::Map<const Eigen::VectorXd>(r.data(), r.size()));
  apply_inverse(scene.model, {}, scene.w.correction, scene.w.solve_scratch, r, z);
  EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(z.data(), z.size()) - wanted).norm(), 1e-4 * wanted.norm());
}

TEST(FaceContact, MomentumChangesByTheImpulsesOfGravityAndContacts) {
  FaceScene scene(cube(3), {post(0.3)}, Vec3(0, 0.101, 0));
  scene.state.v.rowwise() = Eigen::RowVector3d(0.05, -0.4, 0.02);
  int touched = 0;
  for (int frame = 0; frame < 4; ++frame) {
    const auto momentum = [&] {
      Vec3 sum = Vec3::Zero();
      for (int v = 0; v < scene.model.vertices; ++v) sum += scene.model.mass[v] * Vec3(scene.state.v.row(v));
      return sum;
    };
    const Vec3 before = momentum();
    const StepReport& report = scene.step();
    ASSERT_FALSE(report.failed);
    touched += touching_faces(scene);
    const double h = scene.model.time_step;
    const Vec3 left = scene.w.current.gradient.colwise().sum().transpose();  // zero at a minimum
    const Vec3 impulse = h * (scene.model.total_mass * scene.inputs.gravity + report.contact_force);
    EXPECT_LT((momentum() - before - impulse - h * left).norm(), 1e-10 * (before.norm() + impulse.norm())) << frame;
    EXPECT_LT((report.collider_forces[0] - report.contact_force).norm(), 1e-10 * report.contact_force.norm() + 1e-12);
  }
  EXPECT_GT(touched, 0);
}

TEST(FaceContact, SurfacesStayAboveWhatIsFinerThanTheirCells) {
  Shape fork = shape_of(Capsule{Vec3(-0.05, -1, 0.01), Vec3(-0.05, -0.005, 0.01), 0.005});
  fork.root.parts.push_back({Capsule{Vec3(0.01, -1, 0.01), Vec3(0.01, -0.005, 0.01), 0.005}});
  fork.root.parts.push_back({Capsule{Vec3(0.03, -1, 0.01), Vec3(0.03, -0.005, 0.01), 0.005}});
  const std::pair<std::string, Shape> obstacles[] = {{"post", shape_of(Box{Vec3(0.0035, 0.5, 0.0035), 0})},
                                                     {"knife", shape_of(Box{Vec3(1, 0.5, 0.003), 0})},
                                                     {"fork", fork},
                                                     {"rim", shape_of(Box{Vec3(0.5, 0.5, 0.5), 0})}};
  for (const auto& [name, shape] : obstacles) {
    const double top = shape.bounds().upper.y(), aside = name == "rim" ? 0.55 : 0.0;
    BodyDescription body = cube(3, Corotated{6e4, 1.2e5});
    if (name == "rim") body.mesh.rest *= Eigen::AngleAxisd(0.6, Vec3::UnitZ()).toRotationMatrix().transpose();
    for (const double speed : {0.5, 3.0}) {
      FaceScene scene(body, {{name, shape, 0, 0.4}}, Vec3(aside + 0.004, top + 0.15, 0.013));
      scene.state.v.col(1).setConstant(-speed);
      double deepest = 0;
      int touched = 0;
      for (int frame = 0; frame < 8; ++frame) {
        ASSERT_FALSE(scene.step().failed);
        deepest = std::max(deepest, deepest_sample(scene));
        touched += scene.w.contact.counts.touching;
      }
      EXPECT_GT(touched, 0) << name << " at " << speed;
      EXPECT_LT(deepest, (name == "rim" ? 0.005 : 0.012) * scene.model.size) << name << " at " << speed;
      // A cube that nothing holds falls by more than its height. A post of a tenth of a cell does not stop it at 3 m/s.
      if (name != "rim" && !(name == "post" && speed > 1)) {
        // It starts beside the middle of the knife, on which it topples over.
        const bool beside = name == "knife" && std::abs(scene.center().z()) > 0.1;
        EXPECT_TRUE(scene.center().y() > top + 0.05 || beside) << name << " at " << speed;
      }
    }
  }
}

// What the tine that is nearest to a triangle's middle says of the triangle does not hold of the other tines of a piece
// with hollows: two posts that are blended by next to nothing, and so are one piece, must touch what they touch as two.
TEST(FaceContact, PiecesWithHollowsAreFoundFromAllSides) {
  int of_posts = 0, of_one_piece = 0;
  for (const double blend : {0.0, 1e-9}) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-0.1, 0.1), below(0, 0.012);
    for (int i = 0; i < 200; ++i) {
      Shape posts;
      for (const double low : {0.0, below(random)}) {
        const double x = place(random), z = place(random);
        ShapePart part{Capsule{Vec3(x, -1, z), Vec3(x, -0.003 - low, z), 0.003}};
        part.blend = blend;
        posts.root.parts.push_back(part);
      }
      ASSERT_EQ(pieces_of(posts).size(), blend > 0 ? 1u : 2u);
      FaceScene scene(cube(3), {{"posts", posts}}, Vec3(0, 0.1005, 0));
      scene.inputs.gravity.setZero();
      scene.state.v.col(1).setConstant(-0.1);
      prepare(scene);
      (blend > 0 ? of_one_piece : of_posts) += touching_faces(scene);
    }
  }
  EXPECT_GT(of_posts, 50);
  EXPECT_EQ(of_one_piece, of_posts);
}

// Vertices of the cloth land beside the bars' edges, and rest in bars that have little room for what a step does
// freely.
TEST(FaceContact, AClothInShortStepsStaysWholeOnBarsBetweenItsVertices) {
  BodyDescription net = test::spring_net(12);
  net.surface = cloth_grid({0.4, 0.4}, {12, 12}).surface.triangles;
  net.time_step = 1.0 / 120;
  for (double& mass : net.point_mass) mass *= 0.2;
  net.mesh.rest.rowwise() -= Eigen::RowVector3d(0.2, 0.2, 0);
  const Eigen::Matrix3d level =
      (Eigen::AngleAxisd(0.26, Vec3::UnitY()) * Eigen::AngleAxisd(-0.5 * 3.14159265358979, Vec3::UnitX()))
          .toRotationMatrix();
  net.mesh.rest = net.mesh.rest * level.transpose();
  Shape bars;
  for (const double x : {-0.12, -0.04, 0.04, 0.12}) {
    bars.root.parts.push_back({Box{Vec3(0.005, 0.005, 0.3), 0}});
    bars.root.parts.back().to_local = Eigen::Translation3d(-x, 0, 0);
  }
  FaceScene scene(net, {{"bars", bars, 0, 0.3}}, Vec3(0, 0.05, 0));
  scene.state.v.col(1).setConstant(-1);
  const auto kinetic = [&] {
    double sum = 0;
    for (int v = 0; v < scene.model.free; ++v) sum += 0.5 * scene.model.mass[v] * scene.state.v.row(v).squaredNorm();
    return sum;
  };
  const double energy = kinetic() + 9.81 * 0.1 * scene.model.total_mass;  // falling by 0.1 m included
  double most = 0;
  for (int frame = 0; frame < 40; ++frame) {
    ASSERT_FALSE(scene.step().failed);
    most = std::max(most, kinetic() + elastic_energy(scene.model, scene.w, scene.state.x));
  }
  EXPECT_GT(scene.w.contact.counts.touching, 0);
  EXPECT_LT(most, 1.2 * energy);
}

TEST(FaceContact, CostsNothingWhereCollidersAreCoarserThanTheSurface) {
  FaceScene scene(cube(6), {{"ground", shape_of(HalfSpace{Vec3::UnitY(), 0})}, {"ball", shape_of(Sphere{3})}},
                  Vec3(0, 0.1, 0));
  scene.inputs.collider_motions[1].start = scene.inputs.collider_motions[1].end = test::moved_to(Vec3(0, -3, 0));
  for (int frame = 0; frame < 3; ++frame) scene.step();
  EXPECT_GT(scene.w.contact.counts.touching, 0);
  for (const FacePoints& faces : scene.w.contact.faces) {
    EXPECT_TRUE(faces.pieces.empty());
    EXPECT_TRUE(faces.points.empty());
    EXPECT_TRUE(faces.newest.empty());
  }
}

TEST(FaceContact, FlatFacesOnFlatFacesNeedNoPoints) {
  FaceScene scene(cube(3), {{"table", shape_of(Box{Vec3(0.5, 0.1, 0.5), 0})}}, Vec3(0, 0.2, 0));
  for (int frame = 0; frame < 5; ++frame) scene.step();
  EXPECT_EQ(scene.w.contact.counts.touching, 16);
  EXPECT_TRUE(scene.w.contact.faces[0].points.empty());
}

TEST(FaceContact, SameBitsForAnyNumberOfThreads) {
  const auto hashes = [](Threads* threads) {
    FaceScene scene(cube(6), {post(0.3), {"box", shape_of(Box{Vec3(0.02, 0.1, 0.5), 0})}}, Vec3(0, 0.102, 0));
    scene.inputs.collider_motions[1].start = scene.inputs.collider_motions[1].end =
        test::moved_to(Vec3(-0.05, -0.11, 0));
    scene.w.threads = threads;
    std::vector<std::uint64_t> list;
    for (int frame = 0; frame < 10; ++frame) {
      scene.step();
      list.push_back(state_hash(scene.model, scene.state));
    }
    EXPECT_FALSE(scene.w.contact.faces[0].points.empty());
    return list;
  };
  Threads three(3);
  EXPECT_EQ(hashes(nullptr), hashes(&three));
}

}  // namespace face_contact_test
}  // namespace supple
