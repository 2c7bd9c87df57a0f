
#include "app/film_run.h"
#include "app/verbs.h"

namespace supple {

void add_render(CommandLine& line) {
  Verb verb = line.verb("render", "Simulate a scene and film it.");
  verb.footer(
      "Example: supple render squirrel --frames 60 --set body.polynomial.material.mu=6e4\n"
      "Leaves frames/, video.mp4, motion/, profile.json and run.json in out/NAME, and states/ if asked.");
  add_film(verb,
           {"SCENE|MODEL",
            "scene file, the name of one that ships (supple list), or a mesh or surface, which falls onto the ground"},
           line.words());
}

}  // namespace supple
