#include "sim/contact/find_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/error.h"
#include "sim/contact/lagged_friction.h"
#include "sim/contact/usual_depth.h"
#include "sim/contact/vertex_search.h"
#include "sim/contact/way_out.h"

namespace supple {
namespace {

constexpr int vertex_groups_a_chunk = 8;  // a thread takes so many; fixed, so that results do not depend on threads
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double furthest_way_out = 100;  // the longest way out that is looked for, over the body's size

// Returns how far a point of a body may move out of an overlap in one step [m]. size: the size of the body [m].
double push_out_of(const Model& model, const StepInputs& inputs, double size) {
  return inputs.solver.contact.push_out * size * model.time_step;
}

// Returns k_c over m / h^2 for a collider. The depth of a vertex is inversely proportional to it.
double stiffness_of(const StepInputs& inputs, double size, const ContactWork& work, std::size_t collider) {
  constexpr double most = 1000;  // times the stiffness for a thick collider
  const double share =
      usual_depth(size, (*inputs.colliders)[collider], work.traits[collider].usual_half_thickness) / usual_depth(size);
  return inputs.solver.contact.stiffness * std::min(1 / share, most);
}

// Returns how far a vertex may move until contacts are found anew [m]: a small share of how deep anything is pressed
// into what it touches. A plane that is kept so long is wrong by less than that where the surface bends or ends.
// Returns 0, which means at each iterate, where some part is a solid: finding the contacts of cloth is half of a step
// and more, but finding those of solids is not, and some of their steps would take more trials.
double kept_way(const Model& model, const StepInputs& inputs, ContactWork& work) {
  constexpr double share = 0.1;
  if (std::ranges::any_of(model.parts, &Part::solid)) return 0;
  double least = thinnest_layer(inputs, work.surfaces);
  for (const Part& part : model.parts) least = std::min(least, usual_depth(part.size));
  for (std::size_t c = 0; c < work.traits.size(); ++c)
    least = std::min(least, most_depth((*inputs.colliders)[c], work.traits[c].usual_half_thickness));
  return share * least;
}

// Sets the plane of a point that started inside a collider which the body leaves by a common way: at the end of the
// step the plane lies further along that way, by as much as the point may go in a step or has left to go. The point
// slides out without friction.
void leave(const ColliderView& view, const Way& way, const Vec3& way_out, double field, double push_out,
           QueryMemory& near, Contact& contact) {
  const Eigen::Isometry3d motion = view.motion_after(0);
  const Vec3 local = view.end().linear().transpose() * motion.linear() * way_out;
  double left = 0;
  for (double at = field; at < 0 && left < push_out; at = view.distance(way.a + left * local, near))
    left += std::max(view.clear(-at), 0.02 * push_out);
  contact.normal = motion.linear() * way_out;
  contact.offset = contact.normal.dot(view.end() * way.a) + std::min(left, push_out);
  contact.depth = std::max(0.0, contact.offset - contact.normal.dot(way.x));
}

// Holds the points between vertices that lie on one part's faces.
struct PartFaces {
  std::vector<Vec3> places;            // at the start of the step, for all colliders
  std::vector<double> least_distance;  // by collider: the least signed distance at the start [m]
};

std::vector<PartFaces> faces_by_part(const Model& model, const ContactWork& work) {
  constexpr double far = std::numeric_limits<double>::infinity();
  std::vector<PartFaces> faces(model.parts.size(), {{}, std::vector<double>(work.faces.size(), far)});
  for (std::size_t c = 0; c < work.faces.size(); ++c) {
    for (const FacePoint& face : work.faces[c].points) {
      auto& [places, least] = faces[model.part_number(face.stencil.vertex[0])];
      least[c] = std::min(least[c], face.field);
      places.push_back(face.stencil.at(*work.begin));
    }
  }
  return faces;
}

// Finds a common way out for a part that starts so deep inside a collider that it cannot leave it in this step.
void find_way_out(const Model& model, const StepInputs& inputs, std::size_t p, const PartFaces& faces,
                  ContactWork& work) {
  const std::vector<Collider>& colliders = *inputs.colliders;
  const Part& part = model.parts[p];
  const double push_out = push_out_of(model, inputs, part.size);
  const VertexSearch search{model, inputs, *work.begin, work};
  std::vector<std::size_t> deep;
  for (std::size_t c = 0; c < colliders.size(); ++c) {
    const double least = std::min(search.deepest_start(c, part, -push_out), faces.least_distance[c]);
    if (least < -push_out) deep.push_back(c);
  }
  if (deep.empty()) return;
  std::vector<Eigen::Isometry3d> poses;
  for (const ColliderMotion& motion : inputs.collider_motions) poses.push_back(motion.start);
  Positions points(part.free + std::ssize(faces.places), 3);
  points.topRows(part.free) = work.start.middleRows(part.first_free, part.free);
  for (std::size_t i = 0; i < faces.places.size(); ++i)
    points.row(part.free + Eigen::Index(i)) = faces.places[i].transpose();
  const std::optional<WayOut> way =
      way_out(Obstacles(colliders, poses), points, 0.1 * push_out, furthest_way_out * part.size);
  for (const std::size_t c : deep) work.way_out[c * model.parts.size() + p] = way ? way->direction : Vec3::Zero();
}

void find_ways_out(const Model& model, const StepInputs& inputs, ContactWork& work) {
  if (!has_colliders(inputs)) return;
  work.way_out.assign(inputs.colliders->size() * model.parts.size(), Vec3::Zero());
  const std::vector<PartFaces> faces = faces_by_part(model, work);
  for (std::size_t p = 0; p < model.parts.size(); ++p) find_way_out(model, inputs, p, faces[p], work);
}

// Keeps the memories of colliders that are the same closed surfaces as before, if the number of vertices is the same;
// the others begin empty.
void remember_vertices(const Model& model, const std::vector<Collider>& colliders, ContactWork& work) {
  work.memories.resize(colliders.size());
  for (std::size_t c = 0; c < colliders.size(); ++c) {
    VertexMemories& memories = work.memories[c];
    std::shared_ptr<const TriangleSolid> solid = ShapeProbe(colliders[c].shape).remembered();
    const std::size_t wanted = solid == nullptr ? 0 : std::size_t(model.free);
    if (memories.solid == solid && memories.by_vertex.size() == wanted) continue;
    memories.by_vertex.assign(wanted, {});
    memories.solid = std::move(solid);
  }
}

}  // namespace

Positions drawn_offsets(const Model& model, const Positions& x, Threads* threads) {
  const DrawnPlaces& drawn = model.drawn;
  if (drawn.frames.count() == 0) return Positions(0, 3);
  Positions offsets = Positions::Zero(model.vertices, 3);
  const std::vector<Mat3> frames = frames_at(drawn.frames, x, threads);
  for (std::size_t i = 0; i < frames.size(); ++i)
    offsets.row(drawn.frames.vertex[i]) = (frames[i] * drawn.offset.row(Eigen::Index(i)).transpose()).transpose();
  return offsets;
}

void measure_moves(const Model& model, const Positions& x, const ContactWork& work, std::vector<double>& moves) {
  moves.resize(vertex_groups(model));
  for (int group = 0; group < vertex_groups(model); ++group) {
    double most = 0;
    const int end = std::min(model.free, (group + 1) * vertices_a_group);
    for (int v = group * vertices_a_group; v < end; ++v)
      most = std::max(most, (work.place(x, v) - work.start.row(v).transpose()).squaredNorm());
    moves[group] = std::sqrt(most);
  }
}

void begin_contacts(const Model& model, const StepInputs& inputs, const Positions& q, const Positions& y,
                    Threads* threads, ContactWork& work) {
  const std::size_t colliders = collider_count(inputs);
  const int groups = vertex_groups(model);
  SUPPLE_CHECK(inputs.collider_motions.size(), ==, colliders);
  forget_counts(work);
  work.pressed_at_first.clear();
  work.prediction = &y;
  work.begin = &q;
  work.start = q.topRows(model.free);
  work.drawn_offset = drawn_offsets(model, q, threads);
  if (work.drawn_offset.rows() > 0) work.start += work.drawn_offset.topRows(model.free);
  work.clearance.assign(colliders * model.free, unknown);
  const bool any_deforms = std::ranges::any_of(inputs.collider_motions, &ColliderMotion::deforms);
  work.carried.assign(any_deforms ? colliders * model.free : 0, Vec3::Constant(unknown));
  if (colliders > 0) remember_vertices(model, *inputs.colliders, work);
  work.group_distance.resize(colliders * groups);
  work.collider_move.resize(colliders * groups);
  measure_moves(model, y, work, work.group_free_move);
  work.by_chunk.resize((groups + vertex_groups_a_chunk - 1) / vertex_groups_a_chunk);
  work.traits.clear();
  for (std::size_t c = 0; c < colliders; ++c) {
    const Shape& shape = (*inputs.colliders)[c].shape;
    work.traits.push_back({shape.certainty(), shape.half_thickness(), shape.usual_half_thickness()});
  }
  for (int group = 0; group < groups; ++group) {
    const int first = group * vertices_a_group, count = std::min(model.free - first, vertices_a_group);
    const Vec3 center = work.start.middleRows(first, count).colwise().mean().transpose();
    const double radius = std::sqrt(
        (work.start.middleRows(first, count).rowwise() - center.transpose()).rowwise().squaredNorm().maxCoeff());
    for (std::size_t c = 0; c < colliders; ++c) {
      QueryMemory near;
      const ColliderMotion& motion = inputs.collider_motions[c];
      const ColliderView view((*inputs.colliders)[c], motion, work.traits[c]);
      work.collider_move[c * groups + group] = view.most_moved(center, radius);
      work.group_distance[c * groups + group] = view.least_distance(center, radius, near);
    }
  }
  work.faces.resize(colliders);
  for (std::size_t c = 0; c < colliders; ++c) {
    const Collider& collider = (*inputs.colliders)[c];
    const ColliderView view(collider, inputs.collider_motions[c], work.traits[c]);
    work.faces[c] = {};
    if (inputs.solver.contact.points == ContactPoints::surface)
      begin_face_points(model, collider, view, q, y, threads, work.faces[c]);
  }
  find_ways_out(model, inputs, work);
  begin_surfaces(model, inputs, q, y, work.surfaces);
  work.kept_way = kept_way(model, inputs, work);
}

namespace {

// Finds the planes of a body's points for one collider.
class Planes {
 public:
  Planes(const Model& model, const StepInputs& inputs, const Positions& x, const ColliderView& view, std::size_t c,
         ContactWork& work)
      : model_(model),
        x_(x),
        view_(view),
        way_out_(&work.way_out[c * model.parts.size()]),
        some_leave_(
            std::any_of(way_out_, way_out_ + model.parts.size(), [](const Vec3& way) { return !way.isZero(0); })),
        start_(*work.begin),
        prediction_(*work.prediction),
        pressed_at_first_(work.pressed_at_first),
        collider_(static_cast<std::int32_t>(c)),
        friction_((*inputs.colliders)[c].friction),
        inputs_(inputs),
        work_(work) {}

  void of_vertex(int v, const Way& way, double field, double reach, QueryMemory& near,
                 std::vector<Contact>& list) const {
    Contact contact = contact_at(ContactStencil::at_vertex(v), v);
    const Vec3 offset = work_.offset(v);
    if (is_leaving(v) && field <= 0) {
      leave(view_, way, way_out(v), field, push_out(v), near, contact);
      contact.offset -= contact.normal.dot(offset);
      return list.push_back(contact);
    }
    const std::optional<SurfacePoint> surface = view_.holding(way, field, reach, near);
    if (surface) add(*surface, way, offset, field, 0, near, contact, list);
  }

  // Adds the contact of a face's point. number: the number of the point among the faces' points in this step.
  void of_face(FacePoint& face, std::int32_t number, std::vector<Contact>& list) const {
    const Way way = view_.way(face.stencil.at(start_), face.stencil.at(x_));
    const double reach = reach_of(way.length, view_.length_to(face.stencil.at(prediction_), way));
    if (way.length + reach < view_.clear(face.field)) return;
    Contact contact = contact_at(face.stencil, model_.vertices + number);
    const std::int32_t corner = face.stencil.vertex[0];
    if (is_leaving(corner) && face.field <= 0) {
      leave(view_, way, way_out(corner), face.field, push_out(corner), face.near, contact);
      return list.push_back(contact);
    }
    const std::optional<SurfacePoint> surface = plane_of(view_, face, way, reach, face.near);
    if (surface) add(*surface, way, Vec3::Zero(), face.field, face.slack, face.near, contact, list);
  }

 private:
  // Returns how deep a point is pressed in when a film begins; 0 where nothing is known of it [m].
  double pressed_at_first(std::int32_t number) const {
    const bool known = !pressed_at_first_.empty() && number < model_.free;
    return known ? pressed_at_first_[collider_ * std::size_t(model_.free) + number] : 0;
  }

  double size_at(std::int32_t vertex) const { return model_.part_of(vertex).size; }
  double push_out(std::int32_t vertex) const { return push_out_of(model_, inputs_, size_at(vertex)); }

  const Vec3& way_out(std::int32_t vertex) const { return way_out_[model_.part_number(vertex)]; }
  bool is_leaving(std::int32_t vertex) const { return some_leave_ && !way_out(vertex).isZero(0); }

  Contact contact_at(const ContactStencil& stencil, std::int32_t number) const {
    const double unit =
        stiffness_of(inputs_, size_at(stencil.vertex[0]), work_, collider_) / (model_.time_step * model_.time_step);
    return {stencil, {collider_}, Vec3::Zero(), 0, unit * stencil.mass(model_.mass), 0, number};
  }

  // Adds a contact with the plane through a surface's point, lowered by the slack or, if that is more, by as much of
  // the depth as need not be corrected in this step. offset: the way from the contact's point to the place whose way
  // this is.
  void add(const SurfacePoint& surface, const Way& way, const Vec3& offset, double field, double slack,
           QueryMemory& near, Contact& contact, std::vector<Contact>& list) const {
    contact.normal = view_.end().linear() * surface.normal;
    const std::int32_t corner = contact.stencil.vertex[0];
    if (is_leaving(corner) && contact.normal.dot(way_out(corner)) < 0.5)
      return;  // the points that leave pull it through
    const double fastest = push_out(corner);
    const double deep = field < -fastest ? std::max(0.0, -view_.closest(way.a, near).distance - fastest) : 0;
    contact.offset = contact.normal.dot(view_.end() * surface.point - offset) - std::max(slack, deep);
    contact.depth = std::max(0.0, -gap(contact, x_));
    if (friction_ > 0) {
      contact.stick = inputs_.solver.contact.stick * size_at(corner) * model_.time_step;
      contact.origin = view_.end() * way.a - offset;
      const double depth_before = deep > 0 ? 0 : std::max(-field - slack, pressed_at_first(contact.number));
      const double h = model_.time_step, mass = contact.stencil.mass(model_.mass);
      begin_friction(friction_, depth_before, -gap(contact, prediction_), model_.scheme.inertia * mass / (h * h),
                     contact);
    }
    list.push_back(contact);
  }

  const Model& model_;
  const Positions& x_;
  const ColliderView& view_;
  const Vec3* way_out_;  // by part
  bool some_leave_;
  const Positions& start_;
  const Positions& prediction_;
  const std::vector<double>& pressed_at_first_;
  std::int32_t collider_;
  double friction_;
  const StepInputs& inputs_;
  const ContactWork& work_;
};

}  // namespace

void find_contacts(const Model& model, const StepInputs& inputs, const Positions& x, Threads* threads,
                   ContactWork& work, std::vector<Contact>& found) {
  found.clear();
  find_surface_contacts(model, inputs, *work.begin, *work.prediction, x, threads, work.surfaces, found);
  measure_moves(model, x, work, work.group_move);
  const int groups = vertex_groups(model);
  for (std::size_t c = 0; c < collider_count(inputs); ++c) {
    const VertexSearch search{model, inputs, x, work};
    const ColliderView view = search.view(c);
    const Planes planes(model, inputs, x, view, c, work);
    const int chunks = static_cast<int>(work.by_chunk.size());
    const long questions =
        long(model.free) *
        (work.traits[c].half_thickness > 0 ? 1 : 50);  // thin shapes need rays, meshes need triangles
    run_chunks(threads, chunks, questions, [&](int chunk) {
      std::vector<Contact>& list = work.by_chunk[chunk];
      list.clear();
      for (int group = chunk * vertex_groups_a_chunk; group < std::min(groups, (chunk + 1) * vertex_groups_a_chunk);
           ++group) {
        search.near(c, view, group, [&](int v, const Way& way, double field, double reach) {
          planes.of_vertex(v, way, field, reach, search.memory(c, v), list);
        });
      }
    });
    for (const auto& list : work.by_chunk) found.insert(found.end(), list.begin(), list.end());
    FacePoints& faces = work.faces[c];
    find_face_points(model, view, *work.begin, x, *work.prediction, threads, faces);
    for (std::size_t i = 0; i < faces.points.size(); ++i)
      planes.of_face(faces.points[i], static_cast<std::int32_t>(i), found);
  }
}

}  // namespace supple
