#include "sim/model/joined_model.h"

#include <algorithm>

#include "base/error.h"
#include "sim/model/model_values.h"

namespace supple {
namespace {

// Makes the parts of a joined model, and counts its vertices.
void place_parts(const std::vector<const Model*>& bodies, Model& joined) {
  for (const Model* body : bodies) {
    SUPPLE_CHECK(body->parts.size(), ==, 1u);
    Part part = body->parts.front();
    part.first_free = joined.free;
    joined.free += part.free;
    joined.vertices += body->vertices;
    joined.size = std::max(joined.size, part.size);
    joined.total_mass += part.mass;
    joined.parts.push_back(std::move(part));
  }
  std::int32_t held = joined.free;
  for (Part& part : joined.parts) {
    part.first_held = held;
    held += part.held;
  }
}

void place_vertices(const std::vector<const Model*>& bodies, Model& joined) {
  joined.rest.resize(joined.vertices, 3);
  joined.mass.resize(joined.vertices);
  joined.input_of.resize(joined.vertices);
  if (std::ranges::any_of(bodies, [](const Model* body) { return !body->overhang.empty(); }))
    joined.overhang.resize(joined.vertices, 0.0);
  std::int32_t inputs = 0;
  for (std::size_t p = 0; p < bodies.size(); ++p) {
    const Model& body = *bodies[p];
    set_rows(joined.parts[p], body.rest, joined.rest);
    for (std::int32_t v = 0; v < body.vertices; ++v) {
      const std::int32_t at = joined_vertex(joined.parts[p], v);
      joined.mass[at] = body.mass[v];
      if (!body.overhang.empty()) joined.overhang[at] = body.overhang[v];
      joined.input_of[at] = inputs + body.input_of[v];
    }
    inputs += body.vertices;
  }
  joined.internal_of.resize(joined.vertices);
  for (std::int32_t v = 0; v < joined.vertices; ++v) joined.internal_of[joined.input_of[v]] = v;
}

// Joins the places that touch colliders in the stead of vertices.
void join_drawn(const std::vector<const Model*>& bodies, Model& joined) {
  VertexFrames& frames = joined.drawn.frames;
  frames.begin = {0};
  std::vector<Vec3> gradients, offsets;
  for (std::size_t p = 0; p < bodies.size(); ++p) {
    const DrawnPlaces& body = bodies[p]->drawn;
    for (Eigen::Index i = 0; i < body.frames.count(); ++i) {
      frames.vertex.push_back(joined_vertex(joined.parts[p], body.frames.vertex[std::size_t(i)]));
      offsets.emplace_back(body.offset.row(i).transpose());
      for (std::int32_t t = body.frames.begin[std::size_t(i)]; t < body.frames.begin[std::size_t(i) + 1]; ++t) {
        frames.corner.push_back(joined_vertex(joined.parts[p], body.frames.corner[std::size_t(t)]));
        gradients.emplace_back(body.frames.gradient.row(t).transpose());
      }
      frames.begin.push_back(static_cast<std::int32_t>(frames.corner.size()));
    }
  }
  const auto rows = [](const std::vector<Vec3>& list) {
    Positions result(std::ssize(list), 3);
    for (std::size_t i = 0; i < list.size(); ++i) result.row(Eigen::Index(i)) = list[i].transpose();
    return result;
  };
  frames.gradient = rows(gradients);
  joined.drawn.offset = rows(offsets);
}

void place_surfaces(const std::vector<const Model*>& bodies, Model& joined) {
  Eigen::Index triangles = 0;
  for (const Model* body : bodies) triangles += body->surface.rows();
  joined.surface.resize(triangles, 3);
  Eigen::Index at = 0;
  for (std::size_t p = 0; p < bodies.size(); ++p) {
    joined.parts[p].first_triangle = static_cast<std::int32_t>(at);
    for (Eigen::Index t = 0; t < bodies[p]->surface.rows(); ++t, ++at) {
      for (int k = 0; k < 3; ++k) joined.surface(at, k) = joined_vertex(joined.parts[p], bodies[p]->surface(t, k));
    }
  }
}

// Appends the elements of a body, whose regions follow those of the bodies before it.
void add_elements(const Model& body, const Part& part, Model& joined) {
  const auto regions = static_cast<int>(joined.materials.size());
  const auto fabrics = static_cast<int>(joined.fabrics.size());
  for (Model::ChunkRange chunk : body.chunks) {
    chunk.region += chunk.kind == ElementKind::triangle ? fabrics : regions;
    chunk.first_block += joined.blocks;
    chunk.first_vertex += static_cast<int>(joined.chunk_vertex.size());
    chunk.first_corner += joined.corner.size();
    chunk.first_field += joined.field.size();
    joined.chunks.push_back(chunk);
  }
  joined.elements += body.elements;
  joined.blocks += body.blocks;
  joined.largest_chunk = std::max(joined.largest_chunk, body.largest_chunk);
  joined.materials.insert(joined.materials.end(), body.materials.begin(), body.materials.end());
  joined.stiffness.insert(joined.stiffness.end(), body.stiffness.begin(), body.stiffness.end());
  joined.fabrics.insert(joined.fabrics.end(), body.fabrics.begin(), body.fabrics.end());
  joined.fabric_stiffness.insert(joined.fabric_stiffness.end(), body.fabric_stiffness.begin(),
                                 body.fabric_stiffness.end());
  if (!body.fibres.empty()) {
    joined.fibres.resize(std::size_t(regions));
    joined.fibres.insert(joined.fibres.end(), body.fibres.begin(), body.fibres.end());
  }
  joined.energy_may_be_negative |= body.energy_may_be_negative;
  joined.has_slack |= body.has_slack;
  joined.corner.insert(joined.corner.end(), body.corner.begin(), body.corner.end());
  joined.field.insert(joined.field.end(), body.field.begin(), body.field.end());
  joined.single_field.insert(joined.single_field.end(), body.single_field.begin(), body.single_field.end());
  joined.element_of_lane.insert(joined.element_of_lane.end(), body.element_of_lane.begin(), body.element_of_lane.end());
  const auto slots = static_cast<std::int32_t>(joined.chunk_vertex.size());
  for (const std::int32_t v : body.chunk_vertex) joined.chunk_vertex.push_back(joined_vertex(part, v));
  const auto before = static_cast<std::int32_t>(joined.slots.size());
  for (const std::int32_t slot : body.slots) joined.slots.push_back(slots + slot);
  for (std::size_t v = 1; v < body.slot_begin.size(); ++v) joined.slot_begin.push_back(before + body.slot_begin[v]);
}

void add_handles(const Model& body, const Part& part, Model& joined) {
  const std::int32_t handles = joined.handled.empty() ? 0 : joined.handled.back().handle + 1;
  for (const auto& [vertex, handle, holds] : body.handled)
    joined.handled.push_back({joined_vertex(part, vertex), handles + handle, holds});
  if (body.handle_stiffness.empty()) return;
  joined.handle_stiffness.resize(joined.free, 0.0);
  std::copy(body.handle_stiffness.begin(), body.handle_stiffness.end(),
            joined.handle_stiffness.begin() + part.first_free);
}

// Joins the rows of damping, or of bending.
void join_rows(const std::vector<const Model*>& bodies, Model::SparseRows Model::*rows, Model& joined) {
  const bool none = std::ranges::all_of(bodies, [&](const Model* body) { return (body->*rows).begin.empty(); });
  if (none) return;
  Model::SparseRows& all = joined.*rows;
  all.begin.push_back(0);
  const auto add_rows = [&](std::size_t p, std::int32_t first, std::int32_t count) {
    const Model::SparseRows& own = bodies[p]->*rows;
    for (std::int32_t v = first; v < first + count; ++v) {
      for (std::int32_t i = own.begin.empty() ? 0 : own.begin[v]; !own.begin.empty() && i < own.begin[v + 1]; ++i) {
        all.column.push_back(joined_vertex(joined.parts[p], own.column[i]));
        all.value.push_back(own.value[i]);
      }
      all.begin.push_back(static_cast<std::int32_t>(all.column.size()));
    }
  };
  for (std::size_t p = 0; p < bodies.size(); ++p) add_rows(p, 0, joined.parts[p].free);
  for (std::size_t p = 0; p < bodies.size(); ++p) add_rows(p, joined.parts[p].free, joined.parts[p].held);
}

// Joins the energies of cloth that is curved at rest.
void join_curvature(const std::vector<const Model*>& bodies, Model& joined) {
  RestCurvature& all = joined.curvature;
  for (std::size_t p = 0; p < bodies.size(); ++p) {
    const RestCurvature& own = bodies[p]->curvature;
    if (own.empty()) continue;
    if (all.empty()) all.first_term.push_back(0);
    const auto squares = static_cast<std::int32_t>(all.squares()), turns = static_cast<std::int32_t>(all.turns.size());
    const auto terms = static_cast<std::int32_t>(all.terms.size());
    for (int s = 1; s <= own.squares(); ++s) all.first_term.push_back(terms + own.first_term[s]);
    for (const auto& [vertex, factor] : own.terms)
      all.terms.push_back({joined_vertex(joined.parts[p], vertex), factor});
    for (RestCurvature::Turn turn : own.turns) {
      turn.square += squares;
      all.turns.push_back(turn);
    }
    for (RestCurvature::Triangle triangle : own.triangles) {
      for (std::int32_t& corner : triangle.corner) corner = joined_vertex(joined.parts[p], corner);
      triangle.first_turn += turns;
      all.triangles.push_back(triangle);
    }
  }
  if (!all.empty()) all.index(joined.vertices);
}

// Joins the seams, none of which joins two bodies.
void join_seams(const std::vector<const Model*>& bodies, Model& joined) {
  for (std::size_t p = 0; p < bodies.size(); ++p) {
    for (SeamPair pair : bodies[p]->seams.pairs) {
      for (std::int32_t& v : pair.vertex) v = joined_vertex(joined.parts[p], v);
      joined.seams.pairs.push_back(pair);
    }
  }
  if (!joined.seams.empty()) joined.seams.index(joined.vertices);
}

void join_systems(const std::vector<const Model*>& bodies, Model& joined) {
  std::vector<const CholeskyFactor*> factors;
  joined.matrix.resize(joined.free, joined.free);
  Eigen::Index entries = 0;
  for (const Model* body : bodies) entries += body->matrix.nonZeros();
  joined.matrix.reserve(entries);
  for (std::size_t p = 0; p < bodies.size(); ++p) {
    const Model& body = *bodies[p];
    const std::int32_t first = joined.parts[p].first_free;
    for (int column = 0; column < body.free; ++column) {
      joined.matrix.startVec(first + column);
      for (Eigen::SparseMatrix<double>::InnerIterator entry(body.matrix, column); entry; ++entry)
        joined.matrix.insertBack(first + entry.row(), first + column) = entry.value();
    }
    joined.diagonal.insert(joined.diagonal.end(), body.diagonal.begin(), body.diagonal.end());
    for (const System::Coupling& entry : body.couplings)
      joined.couplings.push_back(
          {joined_vertex(joined.parts[p], entry.free), joined_vertex(joined.parts[p], entry.held), entry.value});
    factors.push_back(&body.factor);
  }
  joined.matrix.finalize();
  joined.factor = CholeskyFactor::block_diagonal(factors);
}

}  // namespace

Positions rows_of(const Part& part, const Positions& joined) {
  Positions rows(part.free + part.held, 3);
  rows.topRows(part.free) = joined.middleRows(part.first_free, part.free);
  rows.bottomRows(part.held) = joined.middleRows(part.first_held, part.held);
  return rows;
}

void set_rows(const Part& part, const Positions& rows, Positions& joined) {
  joined.middleRows(part.first_free, part.free) = rows.topRows(part.free);
  joined.middleRows(part.first_held, part.held) = rows.bottomRows(part.held);
}

Model join(const std::vector<const Model*>& bodies) {
  Model joined;
  joined.structure = new_structure();
  joined.id = new_values();
  const Model& first = *bodies.at(0);
  joined.name = first.name;
  for (std::size_t p = 1; p < bodies.size(); ++p) {
    SUPPLE_CHECK(bodies[p]->time_step, ==, first.time_step);
    SUPPLE_CHECK(int(bodies[p]->integrator), ==, int(first.integrator));
    joined.name += ", " + bodies[p]->name;
  }
  joined.time_step = first.time_step;
  joined.integrator = first.integrator;
  joined.scheme = first.scheme;
  place_parts(bodies, joined);
  place_vertices(bodies, joined);
  join_drawn(bodies, joined);
  place_surfaces(bodies, joined);
  joined.slot_begin.push_back(0);
  double stiffness = 0;
  for (std::size_t p = 0; p < bodies.size(); ++p) {
    add_elements(*bodies[p], joined.parts[p], joined);
    add_handles(*bodies[p], joined.parts[p], joined);
    stiffness += bodies[p]->mean_stiffness * bodies[p]->elements;
    joined.strain_stiffness += bodies[p]->strain_stiffness;
  }
  if (std::ranges::any_of(bodies, [](const Model* body) { return body->flows(); })) {
    joined.present_field = joined.field;
    joined.present_single_field = joined.single_field;
  }
  if (!joined.fibres.empty()) joined.fibres.resize(joined.materials.size());
  joined.mean_stiffness = stiffness / joined.elements;
  join_rows(bodies, &Model::damping, joined);
  join_rows(bodies, &Model::bending, joined);
  join_curvature(bodies, joined);
  join_seams(bodies, joined);
  join_systems(bodies, joined);
  return joined;
}

}  // namespace supple
