// Names the benchmarks, for the command line, which offers them, and for the program that runs them.
#pragma once

#include <array>
#include <string_view>

namespace supple {

struct BenchmarkName {
  std::string_view name;
  std::string_view meaning;  // one line
  double minutes;            // rough time on two cores of 2023, to tell how much is left
};

inline constexpr std::array benchmark_names = {
    BenchmarkName{"table1", "time and error by scene, beside the paper's", 3},
    BenchmarkName{"table2", "condition numbers and figure 9, a cube in two poses", 0.3},
    BenchmarkName{"figure7", "L-BFGS, Chebyshev, Newton", 0.3},
    BenchmarkName{"figure8", "initial Hessians", 0.3},
    BenchmarkName{"figure10", "a bar shaken hard", 0.5},
    BenchmarkName{"stability", "hard cases for every material, each with a rule", 15},
    BenchmarkName{"figure13", "window of L-BFGS", 0.3},
    BenchmarkName{"figure14", "how often the full step satisfies Armijo's and Wolfe's conditions", 0.2},
    BenchmarkName{"figure15", "the interval of equation 11", 0.3},
    BenchmarkName{"figure16", "direct solves and conjugate gradients", 0.4},
    BenchmarkName{"figure17", "preconditioners", 0.3},
    BenchmarkName{"rivals", "methods of other papers on the same state", 0.5},
    BenchmarkName{"scenes", "error against milliseconds, scene by scene", 1.5},
    BenchmarkName{"profiles", "performance profiles of all methods on all states", 60},
    BenchmarkName{"minima", "whether converged solvers agree", 1},
    BenchmarkName{"sweeps", "stiffness, Poisson's ratio, resolution", 1.5},
    BenchmarkName{"substeps", "substeps instead of iterations", 1},
    BenchmarkName{"hanging", "the tip of a hanging bar by method", 0.5},
    BenchmarkName{"turning", "stiff bodies that roll, topple, swing and spin, against their solved motion", 4},
    BenchmarkName{"ablation", "from the published settings to ours", 0.3},
    BenchmarkName{"contact", "contact three ways", 0.5},
    BenchmarkName{"touching", "bodies that meet: oracles, cost, error", 15},
    BenchmarkName{"matrix", "what directions start from, beside the paper's", 25},
    BenchmarkName{"scaling", "milliseconds and bytes against vertices", 3},
    BenchmarkName{"roofline", "bytes and operations by stage", 0.5},
};

}  // namespace supple
