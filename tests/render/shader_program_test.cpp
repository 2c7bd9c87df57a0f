// Tests what is said of a shader that does not compile.
#include "render/program.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/error.h"
#include "render/gl_context.h"
#include "support/bodies.h"

namespace supple {
namespace shader_program_test {

std::string message_for(const test::TemporaryFolder& folder) {
  try {
    const GlContext context(GlChoice::osmesa);
    const GlTable gl = load_gl(context);
    const Program program(gl, folder.path, "plain", "broken", {"SAMPLES 4", "PAINTED"});
  } catch (const RunError& error) {
    return error.what();
  }
  return "";
}

TEST(Program, AnErrorNamesTheFileAndItsLine) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "plain.vert") << "#version 330 core\nvoid main() { gl_Position = vec4(0.0); }\n";
  std::ofstream(folder.path / "part.glsl") << "float two() {\n  return 2.0;\n}\n";
  std::ofstream(folder.path / "broken.frag")
      << "#version 330 core\n#include \"part.glsl\"\nout vec4 pixel;\nvoid main() {\n  pixel = nothing;\n}\n";
  const std::string own = message_for(folder);
  EXPECT_NE(own.find((folder.path / "broken.frag").string() + ":5"), std::string::npos) << own;
  std::ofstream(folder.path / "broken.frag")
      << "#version 330 core\n#include \"part.glsl\"\nout vec4 pixel;\nvoid main() {\n  pixel = vec4(two());\n}\n";
  EXPECT_EQ(message_for(folder), "");
  std::ofstream(folder.path / "part.glsl") << "float two() {\n  return unknown;\n}\n";
  const std::string included = message_for(folder);
  EXPECT_NE(included.find((folder.path / "part.glsl").string() + ":2"), std::string::npos) << included;
}

// The lines of a file that is left out are not those of the file that would include it.
TEST(Program, AnErrorBehindAnIncludeThatIsLeftOutHasItsLine) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "plain.vert") << "#version 330 core\nvoid main() { gl_Position = vec4(0.0); }\n";
  std::ofstream(folder.path / "part.glsl") << "float two() {\n  return 2.0;\n}\n";
  std::ofstream(folder.path / "broken.frag") << "#version 330 core\n#ifdef ABSENT\n#include \"part.glsl\"\n#endif\n"
                                                "out vec4 pixel;\nvoid main() {\n  pixel = nothing;\n}\n";
  const std::string message = message_for(folder);
  EXPECT_NE(message.find((folder.path / "broken.frag").string() + ":7"), std::string::npos) << message;
}

}  // namespace shader_program_test
}  // namespace supple
