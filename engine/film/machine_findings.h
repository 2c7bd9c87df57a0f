// Finds out what this machine has and lacks for making films.
#pragma once

#include <string>
#include <vector>

namespace supple {

// Describes one thing that the program uses.
struct Finding {
  std::string name;
  bool ok = false;
  bool needed = true;   // for a film
  std::string found;    // what there is, or what is wrong
  std::string purpose;  // what it is for
  std::string package;  // of Debian; empty: it comes with the program or the machine
};

// Looks for all that films and reports use: instructions, OpenGL, programs, fonts, scenes, the cache, room on the disk.
// It draws a triangle and starts the programs, but writes nothing.
std::vector<Finding> examine_machine();

}  // namespace supple
