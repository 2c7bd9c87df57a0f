// Reads the seams of a cloth from its table. Not here: which vertices they join (scene/building/seam_pairs.h).
#pragma once

#include "scene/config/config.h"
#include "scene/definition/cloth_def.h"

namespace supple {

void read_seams(const ConfigTable& cloth_table, ClothDef& cloth);

}  // namespace supple
