// Describes `supple bench`. Its work is done by a program of its own, supple-bench, so that whoever makes films need
// not build it; the verb of supple becomes that program, which reads the same words once more.
#pragma once

#include <functional>
#include <string>

#include "app/verbs.h"

namespace supple {

struct BenchOptions {
  std::string name;
  std::string out = "out/bench";
  std::string paper_meshes;
  int threads = 1;
  bool fresh = false, quiet = false;
};

// Adds the verb with its options; `bench` does its work and returns the exit status.
void describe_bench(CommandLine& line, std::function<int(const BenchOptions&)> bench);

}  // namespace supple
