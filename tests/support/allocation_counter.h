// Counts the allocations of this process, by operator new and by malloc, for the tests that a step allocates nothing.
#pragma once

namespace supple::test {

// Returns the number of allocations by all threads since the process started.
long allocations();

}  // namespace supple::test
