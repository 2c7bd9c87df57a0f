#include "film/pictures/film_stills.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/read_file.h"
#include "film/pictures/contact_sheet.h"
#include "film/plan/shipped_files.h"
#include "output/files/png_file.h"
#include "output/files/whole_file.h"
#include "output/run/run_folder.h"

namespace supple {

std::filesystem::path write_sheet(const std::filesystem::path& folder, const std::string& title,
                                  const std::vector<double>& times) {
  constexpr int most = 12, columns = 4;
  const auto count = static_cast<int>(times.size());
  const int shown = std::min(most, count);
  Sheet sheet{title, {}, std::min(columns, count), text_font()};
  for (int i = 0; i < shown; ++i) {
    const int picture = shown == 1 ? 0 : i * (count - 1) / (shown - 1);
    sheet.pictures.push_back(
        {picture_file(folder / "frames", picture), {}, {fmt::format("{:.2f} s", times[picture])}, {}});
  }
  const PngImage image = compose(sheet);
  const std::filesystem::path file = folder / "sheet.png";
  write_png(file, image.width, image.height, image.rgb);
  return file;
}

std::vector<std::filesystem::path> write_stills(const std::filesystem::path& folder, const std::string& title,
                                                const std::vector<double>& times) {
  const auto middle = static_cast<int>(times.size()) / 2;
  write_whole_file(folder / "poster.png", read_file(picture_file(folder / "frames", middle)));
  return {folder / "poster.png", write_sheet(folder, title, times)};
}

}  // namespace supple
