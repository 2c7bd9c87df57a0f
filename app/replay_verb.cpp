
#include "app/film_run.h"
#include "app/verbs.h"

namespace supple {

void add_replay(CommandLine& line) {
  Verb verb = line.verb("replay", "Film a scene whose parameters change while it runs.");
  verb.footer(
      "Example: supple replay softening --record first.rec && supple replay softening --verify first.rec\n"
      "A replay names a scene and timed changes: docs/replays.md. `supple info --live SCENE` lists what can change.\n"
      "Leaves what `supple render` leaves.");
  add_film(verb, {"REPLAY", "replay file, the name of one that ships (supple list), or - for standard input"},
           line.words());
}

}  // namespace supple
