// Asks a shape for its distances at the places of a lattice, which are many and near each other. Where the shape is a
// union of closed surfaces, most of their triangles can be left out. This saves work and changes no answer: each has
// the bits of Shape::distance. The shape can be swollen: then all that is nearer to it than a length belongs to it,
// too.
#pragma once

#include <vector>

#include "geometry/shapes/shape.h"
#include "geometry/solids/triangle_solid.h"

namespace supple {

class LatticeProbe {
 public:
  // The shape must outlive the probe. swell: what is subtracted from all distances [m].
  explicit LatticeProbe(const Shape& shape, double swell = 0);

  // Keeps what one caller has found so far, which saves later questions work.
  using Memory = std::vector<QueryMemory>;
  Memory memory() const { return Memory(surfaces_.size()); }

  double distance(const Vec3& p, Memory& near) const;

  // Returns how far the surface is, at least, from a place with this distance [m]. It is 0 where a surface has holes:
  // sides change in holes, far from triangles, so that nothing is known.
  double clearance(double distance) const { return certainty_ * std::abs(distance); }

  // Asks about places on a straight way, which is short.
  class Way {
   public:
    // start, length: where the way begins, and how far it leads [m]. The probe and the memory must outlive this object.
    Way(const LatticeProbe& probe, const Vec3& start, double length, Memory& near);
    // Returns the distance at a place of the way. ahead: the largest distance from p of the places that are asked about
    // after p [m].
    double distance(const Vec3& p, double ahead);

   private:
    struct Surface {
      std::size_t number;
      NearLeaves leaves;  // none: they are not known yet
    };
    double of_surface(Surface& surface, const Vec3& p, double ahead);

    const LatticeProbe& probe_;
    Memory& near_;
    std::vector<Surface> surfaces_;  // those that matter on the way
  };

 private:
  Vec3 local(std::size_t surface, const Vec3& p) const {
    return surfaces_[surface]->to_local * p / surfaces_[surface]->scale;
  }
  const TriangleSolid& solid(std::size_t surface) const {
    return *std::get<ClosedSurface>(surfaces_[surface]->primitive).solid;
  }

  const Shape& shape_;
  double swell_;
  double certainty_ = 0;
  std::vector<const ShapePart*> surfaces_;  // all parts of a union of closed surfaces; empty for other shapes
};

}  // namespace supple
