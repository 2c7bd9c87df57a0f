// Makes the film that a command line asks for, with its folder, and with messages on the terminal. The verbs that run a
// scene share this. Not here: the film itself (film/film.h).
#pragma once

#include <string>
#include <vector>

#include "app/verbs.h"
#include "base/trace.h"
#include "film/film.h"

namespace supple {

// Describes a film as the command line asks for it.
struct FilmCommand {
  FilmPlan plan;
  std::vector<std::string> passes = {};  // names of passes, over the scene's
  bool json = false;                     // the result as one line of JSON
  bool table = true;                     // the table of times at the end
  bool page = false;                     // a page of the run (output/pages/run_page.h)
};

// Adds the options that every run of a scene has. --resume is not among them, because it is for single films only.
// folder: where the results are without --out, in words.
void add_film_options(Verb& verb, FilmCommand& command, const std::string& folder);

// Adds the option that chooses how pictures are drawn, and the one that keeps nothing in the user's cache.
void add_gl_option(Verb& verb, GlChoice& gl);
void add_cache_option(Verb& verb, bool& cache);

// Adds the option that chooses the pictures' size. usual: the size without it, in words.
void add_size_option(Verb& verb, std::string& size, const std::string& usual);

// Adds the options of a film's file.
void add_coding_options(Verb& verb, FilmCoding& coding);

// The first adds the option of the film's passes. The second puts these passes before the other settings, which
// override them.
void add_passes_option(Verb& verb, std::vector<std::string>& passes);
void ask_for_passes(const std::vector<std::string>& passes, std::vector<std::string>& settings);

// Lets the film go on from an earlier run where its scene says so, and prints what was done for it.
void go_on(const FilmPlan& plan, LoadedFilm& film);

// Prints warnings of the scene, and the notes from reading meshes.
void say_remarks(const FilmPlan& plan, const LoadedFilm& film);

// Opens a scene by the name that the command line gives. The text of a scene on standard input is read, and that of a
// model's scene is made. Notes on the model are printed, unless `quiet`, and except those that the settings make
// untrue. Throws InputError.
SceneSource opened_scene(const std::string& name, const std::vector<std::string>& settings, bool quiet);

// Gives the plan the text of a scene that is not in a file. Throws InputError.
void take_scene(FilmPlan& plan);

// Makes a verb that films what its argument names. words: the command line with which the program was called.
struct FilmArgument {
  const char *name, *meaning;
};
void add_film(Verb& verb, const FilmArgument& argument, const std::vector<std::string>& words);

// Holds the record of a run after its end, for callers that examine it.
struct FilmRecord {
  RunInfo info;
  std::filesystem::path folder;
  std::string scene;  // its name
  double fps = 0;
  FilmResult result;
  std::vector<ThreadTrace> trace;  // when one was asked for
};

// Makes a film and prints how it ended. Returns the exit status. words: the command line with which the program was
// called, for run.json. record: null where the caller does not need it.
int run_film(const FilmCommand& command, const std::vector<std::string>& words, FilmRecord* record = nullptr);

}  // namespace supple
