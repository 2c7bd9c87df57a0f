// Writes a body's fields at chosen frames, for ParaView: fields/BODY-NNNNNN.vtu and the collection fields/BODY.pvd over
// them. docs/exchange.md describes the fields.
#pragma once

#include "output/files/vtu.h"
#include "output/run/run_folder.h"
#include "scene/building/assemble.h"

namespace supple {

struct OpenWorkspace;
struct SceneDef;

class FieldWriter {
 public:
  // Creates the folder; throws RunError when that fails. All that is passed must outlive the writer.
  FieldWriter(const Body& body, const Model& model, const RunFolder& folder, const SceneDef& scene);

  // Writes a frame and updates the collection, so that it can be opened while the film is made. In a film that was
  // resumed, the collection also contains the frames that were written before. workspace: the workspace of the step
  // that led to the state. Contact forces are written where there is anything to touch. Throws RunError.
  void add(int frame, const State& state, const OpenWorkspace& workspace);

 private:
  void find_earlier(int frame);
  void write_collection() const;

  const Body& body_;
  const Model& model_;
  const RunFolder& folder_;
  const SceneDef& scene_;
  std::vector<int> written_;  // frames
};

}  // namespace supple
