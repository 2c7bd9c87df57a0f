// Holds what all pages have in common: the head of the document, colours for light and dark screens and for paper,
// tables that keys scroll and sort, the mark of what has the focus, and files within the page. What only one kind of
// page has is in run_page.cpp, gallery_page.cpp and report_page.cpp.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace supple {

// Returns a document up to the begin of its body. style: the page's own, after the common one. title: plain text.
std::string page_begin(const std::string& title, std::string_view style);

// Returns the scripts and the end of a document. script: the page's own.
std::string page_end(std::string_view script);

// Returns a file as a data: address, so that a page needs no other file. type: the media type of the file, such as
// "image/png". Throws InputError naming the file where it cannot be read.
std::string data_address(const std::filesystem::path& file, std::string_view type);

// Holds a film in a container that browsers know, for a <video>.
struct PageFilm {
  std::filesystem::path file;
  std::string type;  // the media type, such as "video/mp4"
};

// Returns the film of a run's folder, and nothing where the folder has none of that kind (a GIF is a picture to them).
std::optional<PageFilm> page_film(const std::filesystem::path& run);

// Returns the colour of a graph's curve, as a style has it; the colours of a page on a dark screen are lighter ones.
std::string curve_color(std::size_t number);
constexpr std::size_t curve_colors = 8;

}  // namespace supple
