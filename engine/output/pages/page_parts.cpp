#include "output/pages/page_parts.h"

#include <fmt/core.h>

#include "base/read_file.h"
#include "output/files/markup.h"
#include "output/run/run_folder.h"

namespace supple {
namespace {

// Curves have the colours of Okabe and Ito (2008), which eyes that do not tell red from green keep apart, and two more.
// Dark colours are for screens alone: paper is white.
constexpr std::string_view common_style = R"css(
:root { color-scheme: light dark; --paper: #fff; --ink: #1d1f21; --soft: #63686e; --line: #d9dbde; --faint: #f5f6f7; --rule: #eceef0;
  --stripe: #1d2f450b; --over: #23548a1c; --shade: #1d2f4533; --clear: #fff0; --link: #23548a; --bad: #b3400a; --mark: #d55e00;
  --warm: #fdf3ec; --focus: #0072b2;
  --curve0: #0072b2; --curve1: #e69f00; --curve2: #009e73; --curve3: #cc79a7; --curve4: #56b4e9; --curve5: #d55e00; --curve6: #767b80;
  --curve7: #8c6d31; }
@media screen and (prefers-color-scheme: dark) {
  :root { --paper: #15171a; --ink: #e4e6e8; --soft: #a0a6ad; --line: #3b4148; --faint: #21252a; --rule: #282d33;
    --stripe: #ffffff0a; --over: #7fb4e626; --shade: #000000b0; --clear: #15171a00; --link: #8abbe8; --bad: #ff9a6b; --mark: #ff8a3d;
    --warm: #38251a; --focus: #6cc0f5;
    --curve0: #55acea; --curve1: #f0b429; --curve2: #2cc79b; --curve3: #e29bc4; --curve4: #9bd5f7; --curve5: #ff8a3d; --curve6: #a9b0b7;
    --curve7: #cdab66; }
}
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body { margin: 0 auto; color: var(--ink); background: var(--paper);
  font: 1rem/1.5 "Source Sans 3", "Source Sans Pro", Lato, "Helvetica Neue", Helvetica, Arial, "Liberation Sans", sans-serif; }
a { color: var(--link); }
.soft, .soft a { color: var(--soft); }
.box { overflow: auto; max-width: 100%; }
table { border-collapse: collapse; font-size: 0.875rem; font-variant-numeric: tabular-nums lining-nums; }
th button { font: inherit; color: inherit; text-align: inherit; background: none; border: 0; margin: 0; padding: 0; cursor: pointer; }
th[aria-sort] button::after { content: " ↑"; }
th[aria-sort="descending"] button::after { content: " ↓"; }
:focus-visible { outline: 3px solid var(--focus); outline-offset: 2px; border-radius: 2px; }
.box:focus-visible, tr:focus-visible { outline-offset: -3px; }
@media screen { .paper { display: none !important; } }
@media print {
  @page { size: A4; margin: 1.5cm; }
  body { padding: 0 !important; max-width: none !important; font-size: 10pt; }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  .screen, video { display: none !important; }
  .box { overflow: visible; max-height: none; }
  table { font-size: 7.5pt; }
  thead { display: table-header-group; }
  th { position: static !important; }
  th, td { padding: 0.15rem 0.35rem !important; white-space: normal !important; overflow-wrap: anywhere; }
  table:not(:has(th:nth-child(15))) td.number { white-space: nowrap !important; }  /* a sheet has room for these */
  tr, .box, figure, .graph, .card { break-inside: avoid; }
  h1, h2, h3, figcaption { break-after: avoid; }
  pre { font-size: 7.5pt; }
}
)css";

// The head of each column becomes a button that sorts the rows below it, by their numbers where most cells begin with
// one. Tables that are wider than the page are reached by Tab, and arrows then scroll them.
constexpr std::string_view common_script = R"js(
"use strict";
for (const table of document.querySelectorAll("table")) {
  const body = table.tBodies[0], heads = table.tHead ? [...table.tHead.rows[0].cells] : [];
  const words = cell => (cell.dataset.value ?? cell.textContent).trim();
  const number = text => parseFloat(text.replace(/^[<>~=+ ]+/, "").replace("−", "-"));
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.title = "Sort by this column";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const up = head.getAttribute("aria-sort") !== "ascending";
      for (const other of heads) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", up ? "ascending" : "descending");
      const rows = [...body.rows].map(row => [words(row.cells[column]), row]);
      const filled = rows.filter(([text]) => text !== "" && text !== "–");
      const numbers = 2 * filled.filter(([text]) => !isNaN(number(text))).length > filled.length;
      const key = numbers ? text => isNaN(number(text)) ? Infinity : number(text) : text => text;
      const order = numbers ? (a, b) => a < b ? -1 : a > b ? 1 : 0 : (a, b) => a.localeCompare(b);
      rows.sort(([a], [b]) => order(key(a), key(b)) * (up ? 1 : -1));
      body.append(...rows.map(([, row]) => row));
    });
  });
}
for (const box of document.querySelectorAll(".box")) box.tabIndex = 0;
)js";

}  // namespace

std::string page_begin(const std::string& title, std::string_view style) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n{}\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n<style>{}{}</style></head><body>\n",
      page_mark, markup_text(title), common_style, style);
}

std::string page_end(std::string_view script) {
  return fmt::format("<script>{}{}</script></body></html>\n", common_script, script);
}

std::optional<PageFilm> page_film(const std::filesystem::path& run) {
  std::error_code error;
  for (const char* kind : {"mp4", "webm"}) {
    std::filesystem::path film = run / (std::string("video.") + kind);
    if (std::filesystem::exists(film, error)) return PageFilm{std::move(film), std::string("video/") + kind};
  }
  return std::nullopt;
}

std::string data_address(const std::filesystem::path& file, std::string_view type) {
  const std::string bytes = read_file(file);
  return fmt::format("data:{};base64,{}", type,
                     base64_text({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}));
}

std::string curve_color(std::size_t number) { return fmt::format("var(--curve{})", number % curve_colors); }

}  // namespace supple
