// The program supple makes films of soft bodies from scene files.
#include "app/program.h"
#include "app/verbs.h"

namespace supple {
namespace {

void add_verbs(CommandLine& line) {
  add_render(line);
  add_replay(line);
  add_live(line);
  add_draw(line);
  add_page(line);
  add_gallery(line);
  add_sweep(line);
  add_profile(line);
  add_bench(line);
  add_check(line);
  add_mesh(line);
  add_info(line);
  add_compare(line);
  add_list(line);
  add_doctor(line);
  add_complete(line);
}

}  // namespace
}  // namespace supple

int main(int argc, char** argv) { return supple::run_command_line(argc, argv, supple::add_verbs); }
