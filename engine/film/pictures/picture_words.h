// Writes what a picture says in words beside captions: the headline, a line at its top, and a note below the caption of
// each body. Not here: captions, which are BodyDef::label as it stands, and where words stand (render/captions.h,
// render/overlays.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "output/run/profile.h"
#include "render/font.h"
#include "scene/replay/script.h"

namespace supple {

// Returns the line at the top; empty where the scene asks for none. time: the time of the film [s].
std::string headline_text(const SceneDef& scene, double time);

// Returns a headline as wide as any of the film.
std::string longest_headline(const SceneDef& scene);

// Returns the note below a body; empty where the scene asks for none. row: the body's row of the frame; null where it
// is not known, and then the note names only the method.
std::string note_text(const TextDef& text, const BodyDef& body, const BodyRow* row);

// Returns a note that is as long as any of the scene's, so that captions can keep room for it.
std::string longest_note(const SceneDef& scene);

// Returns the subtitle of a picture; several that are shown at one time stand one below the other; empty where there is
// none. time: the time of the film [s].
std::string subtitle_text(const TextDef& text, double time);

// Returns all subtitles that pictures of the film may show, each once.
std::vector<std::string> all_subtitles(const TextDef& text);

// Warns of characters in the title, in captions and in subtitles, at any time of the film, for which no installed font
// has a glyph: the pictures show boxes in their place. font: the font of the words; where it is empty there are no
// words, and there is no warning.
std::optional<Problem> letters_warning(const Script& script, const Font& font);

}  // namespace supple
