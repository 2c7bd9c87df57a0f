#include "sim/model/inputs.h"

namespace supple {

const char* text_of(LineSearch search) {
  switch (search) {
    case LineSearch::armijo: return "armijo";
    case LineSearch::wolfe: return "wolfe";
    case LineSearch::none: return "none";
  }
  return "";
}

}  // namespace supple
