#include "film/plan/film_coding.h"

#include <fmt/format.h>

#include "base/error.h"
#include "output/files/exr_file.h"
#include "scene/definition/look_def.h"
#include "scene/definition/scene_def.h"

namespace supple {

FilmCoding coding_for(const FilmCoding& asked, const SceneDef& scene) {
  FilmCoding coding = asked;
  coding.coverage = is_transparent(scene.look.backdrop);
  if (!coding.coverage || holds_coverage(coding.chosen())) return coding;
  std::vector<std::string_view> allowed;
  for (const Name<FilmFormat>& name : Names<FilmFormat>::table)
    if (holds_coverage(name.value)) allowed.push_back(name.text);
  throw InputError(
      fmt::format("--format {}", name_of(coding.chosen())),
      fmt::format("a film of this format cannot be transparent, as look.backdrop = \"{}\" asks for: allowed "
                  "are {}",
                  name_of(scene.look.backdrop), fmt::join(allowed, ", ")));
}

void check_passes(const SceneDef& scene) {
  if (scene.output.passes.empty() || writes_exr()) return;
  throw InputError(
      "output.passes",
      "needs OpenEXR, without which this program was built (Debian: libopenexr-dev); without passes the film "
      "can be made");
}

}  // namespace supple
