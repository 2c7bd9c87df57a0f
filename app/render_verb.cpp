
#include "app/film_run.h"
#include "app/verbs.h"

namespace supple {

void add_render(CommandLine& line) {
  Verb verb = line.verb("render", "Simulate a scene and film it.");
  verb.footer(
      "Examples: supple render squirrel --frames 60 --set body.polynomial.material.mu=6e4\n"
      "          supple render my-scene.toml --preview\n"
      "Leaves frames/, video.mp4, poster.png, sheet.png, motion/, profile.json and run.json in out/NAME, and states/ "
      "if "
      "asked. Another run that is there stays: this one then goes to out/NAME-2.");
  add_film(
      verb,
      {"SCENE|MODEL",
       "scene file, the name of one that ships (supple list), a mesh or surface, which falls onto the ground, or - for "
       "a scene on standard input"},
      line.words());
}

}  // namespace supple
