#include "sim/model/report.h"

namespace supple {

const char* text_of(StopReason reason) {
  switch (reason) {
    case StopReason::iterations: return "iterations";
    case StopReason::round_off: return "round-off";
    case StopReason::target_error: return "target error";
    case StopReason::line_search_failed: return "line search failed";
  }
  return "";
}

}  // namespace supple
