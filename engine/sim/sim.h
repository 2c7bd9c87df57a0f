// Offers the simulation to other programs: all that is needed to move a body, in the order in which it is called.
//
//   BodyDescription body;                    // mesh, materials by region, handles, time step: sim/model/model.h
//   const Model model = build_model(body);   // no step changes it; several states may share it
//   State state = rest_state(model);         // where the body is; a copy is a snapshot: sim/model/state.h
//   Workspace workspace;                     // scratch, one for each thread that steps; never changes a result
//   StepInputs inputs;                       // gravity, handles' targets, colliders, settings: sim/model/inputs.h
//   const StepReport& report = step(model, inputs, state, workspace);  // once a time step: sim/solver/workspace.h
//
// A body that keeps dents or creeps needs a Model that is not constant, and before each step let_flow(model, state,
// threads, scratch) (sim/model/flow_step.h).
//
// inputs.targets has a row for each of model.handled, in its order: the place where that vertex is held. At rest it is
// model.rest.row(model.handled[i].vertex); without handles the matrix stays empty.
//
// A step that fails says so in the report (failed, failure) and leaves the state as it was. Descriptions that
// contradict themselves throw InputError, a matrix that cannot be factored RunError (base/error.h). Rows of a state are
// in the model's order; in_input_order(model, state.x) sorts them as in the mesh. docs/library.md shows how to build
// against it.
#pragma once

#include <Eigen/Core>

#include "geometry/meshes/mesh.h"                // TetMesh
#include "geometry/shapes/shape.h"               // what a Collider is made of
#include "geometry/tetrahedra/tetrahedralize.h"  // meshes of shapes and boxes
#include "sim/materials/material.h"
#include "sim/measures/measures.h"  // stretch, penetration
#include "sim/model/flow_step.h"
#include "sim/model/inputs.h"
#include "sim/model/model.h"
#include "sim/model/report.h"
#include "sim/model/state.h"
#include "sim/solver/workspace.h"

static_assert(EIGEN_MAX_STATIC_ALIGN_BYTES == 64 && EIGEN_MAX_ALIGN_BYTES == 64,
              "the libraries were built with both of these as 64: define them so (docs/library.md)");
