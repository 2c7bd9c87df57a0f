// The program's verbs, a file each. Each adds itself to the command line, and sets the action when it was called.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace supple {

// The action that main runs once the command line is understood. It returns the exit status.
using Action = std::function<int()>;

void add_render(CLI::App& app, Action& action, const std::vector<std::string>& command);
void add_replay(CLI::App& app, Action& action, const std::vector<std::string>& command);
void add_sweep(CLI::App& app, Action& action, const std::vector<std::string>& command);
void add_profile(CLI::App& app, Action& action, const std::vector<std::string>& command);
void add_check(CLI::App& app, Action& action);
void add_mesh(CLI::App& app, Action& action);
void add_info(CLI::App& app, Action& action);
void add_list(CLI::App& app, Action& action);
void add_compare(CLI::App& app, Action& action);
void add_bench(CLI::App& app, Action& action);
void add_doctor(CLI::App& app, Action& action);
void add_complete(CLI::App& app, Action& action, const std::vector<std::string>& command);

}  // namespace supple
