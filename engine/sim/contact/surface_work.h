// Holds what a step knows of the surfaces of a joined model's parts, for the searches of surface_contacts.h.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "geometry/triangles/moving_surface.h"
#include "geometry/triangles/two_edges.h"
#include "sim/contact/own_sheet.h"
#include "sim/contact/own_surface.h"
#include "sim/contact/surface_contacts.h"

namespace supple {

struct SurfaceWork::Parts {
  using Place = MovingSurface::Place;

  struct Surface {
    Triangles triangles;               // the part's triangles, by vertices of its own model
    std::vector<std::int32_t> points;  // vertices of the joined model that may touch others, ascending
    std::vector<char> sharp;           // by point: whether the normals of two faces at it are far apart at rest
    double edge = 0;                   // the mean length of the surface's edges at rest [m]
    double layer = 0;                  // how far a sheet keeps others from it; 0 for a solid [m]
    double overhang = 0;               // the largest overhang of its points [m]
    std::vector<EdgeEnds> edges;       // each edge once, by vertices of the joined model
    // By triangle: where those of its edges begin in `edges` that no earlier triangle has; and the end of all.
    std::vector<std::int32_t> edge_begin;
    // By edge of a solid: the triangle that runs from its lower vertex to the higher one, and the other one; -1 where
    // there are not just these two.
    std::vector<std::array<std::int32_t, 2>> edge_faces;
    // The edges of a solid at which it is convex, and the normals of the faces are far apart at rest; ascending.
    std::vector<std::int32_t> sharp_edges;
    std::unique_ptr<MovingSurface> moving;  // null where no part may touch this one
    std::unique_ptr<OwnSurface> own;        // of a solid; null where it does not touch itself
    std::unique_ptr<OwnSheet> own_sheet;    // of a sheet; null where it does not touch itself
    Vec3 carried = Vec3::Zero();            // the mean motion of the part from q to the present iterate [m]
    double own_move = 0;                    // how far its vertices move beside that at most [m]
    Vec3 carried_freely = Vec3::Zero();     // the mean motion of the part from q to the prediction [m]
    double free_move = 0;                   // how far its vertices move beside that at most [m]
  };
  // Holds what is known of a point when the step begins.
  struct Beginning {
    bool is_known = false;
    std::optional<Place> place;  // the place that may hold it; nothing: outside, far from the surface
    double nearest = 0;          // the distance of the surface; 0 where it is too far to be found [m]
  };
  // Holds what is known of a point that may meet a sheet: where it is when the step begins, and what was found last.
  struct BesideSheet {
    double asked = -1;       // how far away the sheet was looked for at the start; negative: it was not [m]
    double distance = 0;     // the sheet's distance at the start; infinite where it is further away than that [m]
    double side = 0;         // the sheet's side to which the point belongs then: 1 front, -1 back, 0 beyond the border
    double above = 0;        // how far it is in front of the sheet then, negative behind [m]
    std::int32_t last = -1;  // the triangle that was closest at the latest iterate; -1: none was
  };
  // Holds the way on which all points of a part leave another part, in which a good share of them begins the step deep.
  struct CommonWay {
    bool is_known = false;
    Vec3 direction = Vec3::Zero();
    double length = 0;  // the way until all are out; 0: each point leaves by what is closest to it [m]
  };
  // Holds what is known in a step of the points of a part that may touch the part itself.
  struct OwnMemory {
    OwnSurface::Pairs pairs;                   // by vertices and triangles of the part's own model
    Positions found_for;                       // the end of the motion for which they were found [m]
    std::vector<std::optional<Place>> inside;  // by vertex: the place out of which it has to come, if it begins inside
    OwnSheet::Pairs of_sheet;                  // the pairs of a sheet, which has no inside
  };

  std::uint64_t structure = 0;                          // of the model that the surfaces belong to
  std::vector<Surface> surfaces;                        // by part
  std::vector<std::vector<Beginning>> beginnings;       // by meeting and point; empty where no point was asked
  std::vector<std::vector<BesideSheet>> beside_sheets;  // by meeting and point; empty where no point was asked
  std::vector<CommonWay> common_ways;                   // by meeting
  std::vector<char> only_sharp;                         // by meeting: whether it is about its part's sharp points alone
  std::vector<OwnMemory> own_points;                    // by part
  // Scratch memory of a search for contacts.
  std::vector<std::vector<Contact>> by_chunk;
  std::vector<const Contact*> unordered, by_number;
  std::vector<std::size_t> first_of;
};

// Makes the surfaces of a model's parts, and prepares those that something may touch.
void make_surfaces(const Model& model, const StepInputs& inputs, SurfaceWork::Parts& work);

}  // namespace supple
