// The program supple makes films of soft bodies from scene files. Exit status: 0 done, 1 the run failed, 2 the input is
// wrong, 130 interrupted.
#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <new>
#include <sstream>

#include "app/verbs.h"
#include "base/console.h"
#include "base/error.h"
#include "base/text.h"
#include "output/run_folder.h"

namespace {

// The message for a first word that is no verb, for which CLI11 would only say that a subcommand is required.
std::string unknown_word(const CLI::App& app, const std::string& word) {
  std::vector<std::string> known = {"--help", "--version"};
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    if (!verb->get_group().empty()) known.push_back(verb->get_name());
  const std::string nearest = supple::nearest_word(word, known);
  return fmt::format("supple: no {} '{}'{}\nTry: supple --help\n", word.starts_with("-") ? "option" : "verb", word,
                     nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest));
}

int run(int argc, char** argv) {
  CLI::App app("Simulates soft bodies fast and accurately, and films them.", "supple");
  app.require_subcommand(1);
  app.footer(
      "Examples: supple render squirrel --frames 60\n"
      "          supple list");
  app.set_version_flag("--version", supple::program_version());
  app.failure_message([](const CLI::App* a, const CLI::Error& e) {
    return fmt::format("supple: {}\nTry: supple {}--help\n", e.what(),
                       a->get_subcommands().empty() ? "" : a->get_subcommands().front()->get_name() + " ");
  });
  const std::vector<std::string> command(argv, argv + argc);
  supple::Action action;
  supple::add_render(app, action, command);
  supple::add_replay(app, action, command);
  supple::add_sweep(app, action, command);
  supple::add_profile(app, action, command);
  supple::add_bench(app, action);
  supple::add_check(app, action);
  supple::add_mesh(app, action);
  supple::add_info(app, action);
  supple::add_compare(app, action);
  supple::add_list(app, action);
  supple::add_doctor(app, action);
  supple::add_complete(app, action, command);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    return app.exit(asked);
  } catch (const CLI::ParseError& error) {
    std::ostringstream help, message;
    (void)app.exit(error, help, message);
    const bool no_verb = app.get_subcommands().empty() && !app.remaining().empty();
    supple::say(stderr, no_verb ? unknown_word(app, app.remaining().front()) : message.str());
    return 2;
  }
  const int status = action();
  const bool said = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  return status == 0 && !said ? 1 : status;
}

// A file that is opened while a standard stream is closed would get the stream's number, and then its words. A user who
// closes a stream wants to hear nothing, so such a stream leads nowhere.
void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0) (void)::open("/dev/null", O_RDWR);  // the lowest that is free: this one
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  std::signal(SIGPIPE, SIG_IGN);  // a run continues when its listener has gone
  try {
    return run(argc, argv);
  } catch (const supple::InputError& error) {
    supple::say(stderr, fmt::format("{}\n", error.what()));
    return 2;
  } catch (const std::bad_alloc&) {
    supple::say(stderr, fmt::format("supple: out of memory\n"));
    return 1;
  } catch (const std::exception& error) {
    supple::say(stderr, fmt::format("supple: {}\n", error.what()));
    return 1;
  }
}
