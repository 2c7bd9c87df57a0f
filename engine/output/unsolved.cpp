#include "output/unsolved.h"

#include "output/row_tally.h"

namespace supple {

bool is_unsolved(double error_estimate, int iterations, int trials) {
  constexpr double worst_estimate = 0.1;
  constexpr double most_trials = 4;
  return error_estimate > worst_estimate || (iterations > 0 && trials > most_trials * iterations);
}

std::vector<UnsolvedStep> unsolved_steps(const std::vector<FrameRow>& rows) { return RowTally(rows).unsolved(); }
std::string unsolved_text(const std::vector<FrameRow>& rows) { return RowTally(rows).unsolved_text(); }

}  // namespace supple
