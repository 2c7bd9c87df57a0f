#include "app/sweep/merge.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "app/sweep/sweep_tables.h"
#include "base/console.h"
#include "base/error.h"
#include "film/pictures/contact_sheet.h"
#include "film/plan/shipped_files.h"
#include "output/pages/report_page.h"
#include "output/run/run_folder.h"

namespace supple {
namespace {

constexpr std::size_t most_pictures = 240;  // on one sheet

// Returns the last words of each path, as many as are needed to distinguish the paths: "mu", or "soft.mu" and
// "stiff.mu".
std::vector<std::string> short_names(const SweepDef& sweep) {
  std::vector<std::string> names;
  for (const PathList& axis : sweep.axes) {
    std::size_t from = axis.path.size();
    const auto tells_apart = [&](const std::string& name) {
      return std::ranges::all_of(sweep.axes, [&](const PathList& other) {
        return &other == &axis || (other.path != name && !other.path.ends_with("." + name));
      });
    };
    do {
      const std::size_t dot = from == 0 ? std::string::npos : axis.path.rfind('.', from - 1);
      from = dot == std::string::npos ? 0 : dot;
    } while (from > 0 && !tells_apart(axis.path.substr(from + 1)));
    names.push_back(from == 0 ? axis.path : axis.path.substr(from + 1));
  }
  return names;
}

std::filesystem::path last_picture(const std::filesystem::path& folder) {
  std::filesystem::path last;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "frames", error)) {
    if (entry.path().extension() == ".png" && entry.path().filename() > last.filename()) last = entry.path();
  }
  return last;
}

// Returns the number of columns. In a grid of two or more paths, a row holds the values of the last path, if they fit.
int sheet_columns(const SweepDef& sweep, std::size_t pictures) {
  const std::size_t last = sweep.axes.back().values.size();
  if (sweep.mode == SweepMode::grid && sweep.axes.size() > 1 && last > 1 && last <= 8) return int(last);
  return std::clamp(int(std::ceil(std::sqrt(double(pictures)))), 1, 10);
}

// Writes the contact sheet. Returns false when no point has a picture.
bool write_sheet(const SweepRequest& request, const std::string& title, const std::vector<PointResult>& results) {
  Sheet sheet{title, {}, sheet_columns(request.sweep, std::min(results.size(), most_pictures)), text_font()};
  const std::vector<std::string> names = short_names(request.sweep);
  bool any = false;
  for (std::size_t point = 0; point < std::min(results.size(), most_pictures); ++point) {
    SheetPicture picture;
    const PointEnd end = results[point].outcome.end;
    if (end == PointEnd::done) picture.file = last_picture(request.folder(point));
    if (picture.file.empty()) picture.missing = end == PointEnd::done ? "no picture" : end_text(end);
    any |= !picture.file.empty();
    const std::vector<std::string> values = request.sweep.values(point);
    for (std::size_t a = 0; a < values.size(); ++a) picture.words.push_back(names[a] + " = " + values[a]);
    picture.mark = std::to_string(point);
    sheet.pictures.push_back(std::move(picture));
  }
  const std::filesystem::path file = request.out / "contact-sheet.png";
  std::error_code error;
  std::filesystem::remove(file, error);
  if (!any) return false;
  const PngImage image = compose(sheet);
  write_png(file, image.width, image.height, image.rgb);
  return true;
}

// Joins the different texts that the points have in one field.
std::string distinct(const std::vector<PointResult>& results, std::string PointResult::*thing) {
  std::set<std::string> words;
  for (const PointResult& result : results) words.insert(result.*thing);
  words.erase("");
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : "; ") + word;
  return text;
}

ReportPage page_of(const SweepRequest& request, const std::string& title, const std::vector<PointResult>& results,
                   bool pictures) {
  std::size_t done = 0;
  for (const PointResult& result : results) done += result.outcome.end == PointEnd::done;
  ReportPage page;
  page.title = title;
  page.lead = fmt::format(
      "{} points, {} done. Point by point: {}.", results.size(), done,
      request.sweep.mode == SweepMode::grid ? "every combination of the values" : "the lists of values side by side");
  page.facts = {{"scene", request.file.string()},
                {"processor", distinct(results, &PointResult::cpu)},
                {"kernels", distinct(results, &PointResult::kernels)},
                {"program", program_version()},
                {"build", build_flags()}};
  if (pictures) {
    const std::string part =
        results.size() > most_pictures ? fmt::format(" The first {} points are shown.", most_pictures) : "";
    page.sections.push_back({"sheet", "Contact sheet"});
    page.sections.back().pictures = {{"contact-sheet", "The last frame of every point", part}};
  }
  page.sections.push_back({"points", "Points", "", {sweep_table(request.sweep, results)}});
  page.sections.push_back({"times", "Times", "", {times_table(results)}});
  return page;
}

// Prints which points are not done and how to run them.
void say_missing(const std::vector<PointResult>& results) {
  constexpr std::size_t most_lines = 20;
  std::size_t missing = 0;
  for (std::size_t point = 0; point < results.size(); ++point) {
    const PointOutcome& outcome = results[point].outcome;
    if (outcome.end == PointEnd::done || ++missing > most_lines) continue;
    const std::string status = outcome.exit_status.empty() ? "" : fmt::format(" (exit status {})", outcome.exit_status);
    say(stderr, fmt::format("point {}: {}{}{}{}\n", point, end_text(outcome.end), status,
                            outcome.message.empty() ? "" : ": ", outcome.message));
  }
  if (missing == 0) return;
  if (missing > most_lines) say(stderr, fmt::format("and {} more, in sweep.csv\n", missing - most_lines));
  say(stderr, fmt::format("supple: {} of {} points are not done; --index N repeats one, --jobs N all of them\n",
                          missing, results.size()));
}

}  // namespace

int merge_points(const SweepRequest& request) {
  std::error_code error;
  std::filesystem::create_directories(request.out / "points", error);  // by which a sweep's folder is known
  const std::vector<PointResult> results = read_results(request);
  const std::string title = request.title.empty() ? request.name : request.title;
  const bool pictures = write_sheet(request, title, results);
  for (const std::string& missing : write_page(page_of(request, title, results, pictures), request.out))
    say(stderr, missing + "\n");
  say_missing(results);
  if (!request.quiet) {
    say(stdout, fmt::format("  table    {}\n", (request.out / "sweep.csv").string()));
    if (pictures) say(stdout, fmt::format("  pictures {}\n", (request.out / "contact-sheet.png").string()));
    say(stdout, fmt::format("  page     {}\n", (request.out / "index.html").string()));
  }
  const bool all_done =
      std::ranges::all_of(results, [](const PointResult& r) { return r.outcome.end == PointEnd::done; });
  return all_done ? 0 : 1;
}

}  // namespace supple
