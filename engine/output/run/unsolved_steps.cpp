#include "output/run/unsolved_steps.h"

#include "output/run/row_tally.h"

namespace supple {

std::vector<UnsolvedStep> unsolved_steps(const std::vector<FrameRow>& rows) { return RowTally(rows).unsolved(); }
std::string unsolved_text(const std::vector<FrameRow>& rows) { return RowTally(rows).unsolved_text(); }

}  // namespace supple
