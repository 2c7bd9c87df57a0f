// Makes one HTML page of many runs: a card for each scene with its film and its figures, and a table of all. Everything
// that the page needs is in it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace supple {

// Describes one scene of a gallery.
struct GalleryScene {
  std::string name;              // of its file
  std::string title;             // empty: the name
  std::filesystem::path folder;  // of its run; empty where there is none
  std::string trouble;           // why there is no whole film; empty where there is one
};

// Returns the page. heading: the text above the cards. note: the text of the line below it. Throws InputError where a
// run's records are damaged.
std::string gallery_page(const std::string& heading, const std::string& note, const std::vector<GalleryScene>& scenes);

}  // namespace supple
