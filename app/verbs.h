// Declares the program's verbs, each of which has a file of its own. Each adds itself to the command line, together
// with the action that it performs.
#pragma once

#include "app/command_line.h"

namespace supple {

void add_render(CommandLine& line);
void add_replay(CommandLine& line);
void add_live(CommandLine& line);
void add_draw(CommandLine& line);
void add_page(CommandLine& line);
void add_gallery(CommandLine& line);
void add_sweep(CommandLine& line);
void add_profile(CommandLine& line);
void add_check(CommandLine& line);
void add_mesh(CommandLine& line);
void add_info(CommandLine& line);
void add_list(CommandLine& line);
void add_compare(CommandLine& line);
void add_bench(CommandLine& line);
void add_doctor(CommandLine& line);
void add_complete(CommandLine& line);

}  // namespace supple
