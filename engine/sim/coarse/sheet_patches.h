// Finds how the clusters of cloth turn in a motion. A patch holds the vertices of a sheet that belong most to one
// cluster; it turns as the rigid body of these masses would that has their angular momentum.
#pragma once

#include <vector>

#include "sim/coarse/cluster_turn.h"
#include "sim/coarse/clusters.h"

namespace supple {

struct SheetPatch {
  std::int32_t cluster = 0;
  std::vector<std::int32_t> vertex;  // held ones too
  std::vector<double> mass;          // of each [kg]
  double stiffness = 0;              // the integral of k [J]
};

// Lists the patches of the parts that are made of triangles, with the values of the model.
std::vector<SheetPatch> make_patches(const Model& model, const Clusters& clusters);

// Returns the turn of a patch in a motion (n x 3, or of the free vertices alone) from x.
ClusterTurn turn_of(const SheetPatch& patch, const Positions& x, const Positions& motion);

}  // namespace supple
