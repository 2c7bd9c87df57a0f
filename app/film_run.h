// A film from the command line to its folder, with words on the terminal: what the verbs that run a scene have in
// common. Not here: the film itself (film/film.h).
#pragma once

#include <string>
#include <vector>

#include "app/verbs.h"
#include "base/trace.h"
#include "film/film.h"

namespace supple {

// A film as the command line asks for it.
struct FilmCommand {
  FilmPlan plan;
  bool json = false;  // the result as one line of JSON
  bool table = true;  // the table of times at the end
  bool page = false;  // a page of the run (output/run_page.h)
};

// Adds the options that every run of a scene has. --resume is not among them: it is for single films.
void add_film_options(Verb& verb, FilmCommand& command);

// Makes a verb one that films what its argument names. words: as the program was called.
struct FilmArgument {
  const char *name, *meaning;
};
void add_film(Verb& verb, const FilmArgument& argument, const std::vector<std::string>& words);

// The record of a run once it is over, for callers that examine it.
struct FilmRecord {
  RunInfo info;
  std::filesystem::path folder;
  std::string scene;  // its name
  double fps = 0;
  FilmResult result;
  std::vector<ThreadTrace> trace;  // when one was asked for
};

// Makes a film and tells how it went. Returns the exit status. words: as the program was called, for run.json. record:
// null where the caller does not look closer.
int run_film(const FilmCommand& command, const std::vector<std::string>& words, FilmRecord* record = nullptr);

}  // namespace supple
