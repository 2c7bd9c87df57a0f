#include "support/places.h"

namespace supple::test {

constinit const char* const source_folder_name = SUPPLE_SOURCE_FOLDER;
constinit const char* const build_folder_name = SUPPLE_BUILD_FOLDER;
constinit const char* const program_name = SUPPLE_PROGRAM;
constinit const char* const failing_calls_name = SUPPLE_FAILING_CALLS;

}  // namespace supple::test
