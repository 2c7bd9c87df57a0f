#include "app/film_run.h"
#include "app/verbs.h"

namespace supple {

void add_render(CLI::App& app, Action& action, const std::vector<std::string>& command) {
  auto request = std::make_shared<FilmRequest>();
  CLI::App* verb = app.add_subcommand("render", "Simulate a scene and film it.");
  verb->footer(
      "Example: supple render squirrel --frames 60 --set body.polynomial.material.mu=6e4\n"
      "Leaves frames/, video.mp4, motion/, profile.json and run.json in out/NAME, and states/ and fields/ if asked.");
  verb->add_option("SCENE", request->scene, "scene file, or the name of one that ships (supple list)")->required();
  add_film_options(*verb, *request);
  verb->callback([&action, request, command] { action = [request, command] { return run_film(*request, command); }; });
}

}  // namespace supple
