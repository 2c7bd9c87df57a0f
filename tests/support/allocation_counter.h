// Counts calls of operator new and malloc's C++ users in this process, for the tests that nothing is allocated in a
// step.
#pragma once

namespace supple::test {

// Allocations by this thread and all others since the process started.
long allocations();

}  // namespace supple::test
