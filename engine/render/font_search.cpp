#include "render/font_search.h"

#include <algorithm>
#include <map>
#include <memory>

#ifdef SUPPLE_SCRIPTS
#include <fontconfig/fontconfig.h>
#endif

namespace supple {

#ifdef SUPPLE_SCRIPTS
namespace {

struct Release {
  void operator()(FcPattern* pattern) const { FcPatternDestroy(pattern); }
  void operator()(FcCharSet* set) const { FcCharSetDestroy(set); }
  void operator()(FcObjectSet* set) const { FcObjectSetDestroy(set); }
  void operator()(FcFontSet* set) const { FcFontSetDestroy(set); }
};
template <class T>
using Owned = std::unique_ptr<T, Release>;

FcChar8* name_of_family(const std::string& family) {
  return reinterpret_cast<FcChar8*>(const_cast<char*>(family.c_str()));
}

// Returns what every search asks for: an upright font of usual weight, with outlines in one colour.
Owned<FcPattern> upright_of(const std::string& family) {
  Owned<FcPattern> pattern(FcPatternCreate());
  FcPatternAddString(pattern.get(), FC_FAMILY, name_of_family(family));
  FcPatternAddInteger(pattern.get(), FC_WEIGHT, FC_WEIGHT_REGULAR);
  FcPatternAddInteger(pattern.get(), FC_SLANT, FC_SLANT_ROMAN);
  FcPatternAddBool(pattern.get(), FC_SCALABLE, FcTrue);
  FcPatternAddBool(pattern.get(), FC_COLOR, FcFalse);
  return pattern;
}

Owned<FcPattern> best_match(FcPattern* pattern) {
  FcConfigSubstitute(nullptr, pattern, FcMatchPattern);
  FcDefaultSubstitute(pattern);
  FcResult result = FcResultNoMatch;
  return Owned<FcPattern>(FcFontMatch(nullptr, pattern, &result));
}

std::optional<Font> font_in(FcPattern* match) {
  FcChar8* file = nullptr;
  if (match == nullptr || FcPatternGetString(match, FC_FILE, 0, &file) != FcResultMatch) return std::nullopt;
  int face = 0;
  FcPatternGetInteger(match, FC_INDEX, 0, &face);
  return Font{reinterpret_cast<const char*>(file), face};
}

// Tells whether the letters of a font are drawn from outlines in one colour.
bool has_outlines(FcPattern* match) {
  FcBool scalable = FcFalse, color = FcFalse;
  FcPatternGetBool(match, FC_SCALABLE, 0, &scalable);
  FcPatternGetBool(match, FC_COLOR, 0, &color);
  return scalable == FcTrue && color == FcFalse;
}

std::optional<Font> find_font_with(char32_t character) {
  const Owned<FcPattern> pattern = upright_of("sans-serif");
  const Owned<FcCharSet> wanted(FcCharSetCreate());
  FcCharSetAddChar(wanted.get(), character);
  FcPatternAddCharSet(pattern.get(), FC_CHARSET, wanted.get());
  const Owned<FcPattern> match = best_match(pattern.get());
  FcCharSet* has = nullptr;
  if (!match || !has_outlines(match.get()) || FcPatternGetCharSet(match.get(), FC_CHARSET, 0, &has) != FcResultMatch ||
      !FcCharSetHasChar(has, character))
    return std::nullopt;
  return font_in(match.get());
}

// Tells whether a font is called by this name, in any of its languages.
bool is_of_family(FcPattern* match, const std::string& family) {
  FcChar8* name = nullptr;
  for (int i = 0; FcPatternGetString(match, FC_FAMILY, i, &name) == FcResultMatch; ++i)
    if (FcStrCmpIgnoreCase(name, name_of_family(family)) == 0) return true;
  return false;
}

}  // namespace

bool searches_fonts() { return true; }

std::optional<Font> font_of_family(const std::string& family) {
  const Owned<FcPattern> match = best_match(upright_of(family).get());
  if (!match || !is_of_family(match.get(), family) || !has_outlines(match.get())) return std::nullopt;
  return font_in(match.get());
}

std::vector<std::string> font_families() {
  std::vector<std::string> names;
  const Owned<FcPattern> any(FcPatternCreate());
  const Owned<FcObjectSet> asked(FcObjectSetBuild(FC_FAMILY, nullptr));
  const Owned<FcFontSet> fonts(FcFontList(nullptr, any.get(), asked.get()));
  for (int f = 0; fonts && f < fonts->nfont; ++f) {
    FcChar8* name = nullptr;
    if (FcPatternGetString(fonts->fonts[f], FC_FAMILY, 0, &name) == FcResultMatch)
      names.emplace_back(reinterpret_cast<const char*>(name));
  }
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

// Remembers what it has found: a search compares all installed fonts, which takes milliseconds, and the width of a text
// is asked for many times.
std::optional<Font> font_with(char32_t character) {
  thread_local std::map<char32_t, std::optional<Font>> found;
  const auto [entry, is_new] = found.try_emplace(character);
  if (is_new) entry->second = find_font_with(character);
  return entry->second;
}

#else

bool searches_fonts() { return false; }
std::optional<Font> font_of_family(const std::string&) { return std::nullopt; }
std::vector<std::string> font_families() { return {}; }
std::optional<Font> font_with(char32_t) { return std::nullopt; }

#endif

}  // namespace supple
