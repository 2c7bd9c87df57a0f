// A body's fields at chosen frames, for ParaView: fields/BODY-NNNNNN.vtu and the collection fields/BODY.pvd over them.
// docs/exchange.md has the fields.
#pragma once

#include "output/run_folder.h"
#include "output/vtu.h"
#include "scene/assemble.h"
#include "sim/solver/objective.h"

namespace supple {

class FieldWriter {
 public:
  // Makes the folder; throws RunError when it cannot. All that is passed must outlive the writer.
  FieldWriter(const Body& body, const Model& model, const RunFolder& folder, double fps);

  // Writes a frame and brings the collection up to date, so that it can be opened while the film is made; in a film
  // that was resumed it holds what was written before, too. workspace: of the step that led to the state; contact
  // forces are written where there are colliders. Throws RunError.
  void add(int frame, const State& state, const StepInputs& inputs, const Workspace& workspace);

 private:
  void find_earlier(int frame);
  void write_collection() const;

  const Body& body_;
  const Model& model_;
  const RunFolder& folder_;
  double fps_;
  std::vector<int> written_;  // frames
};

}  // namespace supple
