// Runs other programs (ffmpeg, gnuplot, supple itself for a part of its work) without a shell, either to their end or
// at the same time as this one.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace supple {

struct ProgramEnd {
  int status;          // as waitpid gives it
  std::string output;  // the last 4 kB of standard output and standard error
  double cpu_ms = 0;   // processor time of all its threads
};

// Names a file to another program: by its absolute path, because a bare name could be taken for an option ("-dash"), a
// protocol ("http://...", "concat:...") or a pipe ("|...").
std::string file_word(const std::filesystem::path& file);

// Looks the program up in PATH and runs it with an empty standard input. Returns nothing when it is not installed or
// cannot be started. stop: a function that is called several times a second until it returns true; then the program
// gets SIGINT, and its end is still waited for. A program that can be stopped does not outlive the calling thread: it
// gets SIGTERM when that thread ends in any way. Several threads may call this function at the same time.
std::optional<ProgramEnd> run_program(const std::vector<std::string>& words, const std::function<bool()>& stop = {});

// Runs a program at the same time as this one and feeds its standard input. Ctrl-C on the terminal does not reach it.
// Only one thread may use it at a time. A process that is forked from this one meanwhile closes its copies of the pipes
// at once, because the program's input does not end as long as any process holds it open.
class FedProgram {
 public:
  // Looks the program up in PATH and starts it. The program does not outlive the calling thread: it gets SIGKILL when
  // that thread ends in any way.
  explicit FedProgram(const std::vector<std::string>& words);
  // Ends the program with SIGKILL, unless its end has already been waited for.
  ~FedProgram();
  FedProgram(const FedProgram&) = delete;
  FedProgram& operator=(const FedProgram&) = delete;

  // Gives the program bytes and waits until it has taken them. Returns false once it takes no more, for example after
  // it has ended; that does not raise SIGPIPE.
  bool write(std::span<const std::uint8_t> bytes);

  // Closes the program's input and waits for its end. Returns nothing when the program is not installed or cannot be
  // started.
  std::optional<ProgramEnd> finish();

 private:
  friend struct FedPrograms;  // in child_program.cpp
  bool wait_for_room();
  void close_input();
  void forget();

  pid_t child_ = -1;
  int input_ = -1, output_ = -1;  // our ends of the pipes; -1: closed
  std::string told_;              // the last of what it has written
};

// Gives "was ended by signal 9" or "ended with status 1".
std::string how_it_ended(const ProgramEnd& end);

}  // namespace supple
