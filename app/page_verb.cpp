#include <fmt/core.h>

#include <memory>

#include "app/verbs.h"
#include "base/console.h"
#include "output/files/whole_file.h"
#include "output/pages/run_page.h"

namespace supple {

void add_page(CommandLine& line) {
  struct PageOptions {
    std::string run, out;
  };
  auto options = std::make_shared<PageOptions>();
  Verb verb = line.verb("page", "One HTML page of a run: film, times, errors, contacts, slowest frames.");
  verb.footer(
      "Example: supple page out/squirrel\n"
      "The page needs no other file and loads nothing, so it can be sent by mail. Its graphs have a cursor that goes "
      "along "
      "with the film; a click on them moves the film.");
  verb.option("RUN", options->run, "folder that supple render left").required();
  verb.option("--out", options->out, "file for the page [RUN/index.html]");
  verb.runs([options] {
    const std::filesystem::path file =
        options->out.empty() ? std::filesystem::path(options->run) / "index.html" : std::filesystem::path(options->out);
    write_whole_file(file, run_page(read_run(options->run)));
    say(stdout, fmt::format("  {}\n", file.string()));
    return 0;
  });
}

}  // namespace supple
