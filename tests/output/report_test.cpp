#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "base/error.h"
#include "output/files/markup.h"
#include "output/files/whole_file.h"
#include "output/pages/report_page.h"
#include "support/bodies.h"

namespace supple {
namespace report_test {

using Records = std::vector<std::vector<std::string>>;

// Replaces PATH while the object lives.
class OtherPath {
 public:
  explicit OtherPath(const std::string& path) : before_(std::getenv("PATH")) { ::setenv("PATH", path.c_str(), 1); }
  ~OtherPath() { ::setenv("PATH", before_.c_str(), 1); }

 private:
  std::string before_;
};

bool has_gnuplot() { return std::system("command -v gnuplot >/dev/null 2>&1") == 0; }

void write_program(const std::filesystem::path& path, const std::string& text) {
  write_whole_file(path, text);
  ::chmod(path.c_str(), 0755);
}

ReportTable table_of(const std::string& name) {
  return {name,
          "Times & errors",
          "First <paragraph>.\n\nSecond.",
          {"model", "time, ours [ms]", "error \"e\""},
          {{"bar", "12.3", "1.23e-4"}, {"a, \"b\"\nc", "", "007"}, {"<i>hippo</i>", "-4", "1e999"}}};
}

ReportPlot plot_of(const std::string& name, int count) {
  ReportPlot plot;
  plot.name = name;
  plot.title = "Error <against> time";
  plot.x_label = "time [ms]";
  plot.y_label = "relative error";
  for (int s = 0; s < count; ++s) {
    PlotSeries series{s == 1 ? "a<b & \"c\" it's x_1" : "method " + std::to_string(s), {}, {}, s == 0};
    for (int i = 0; i < 40; ++i) {
      series.x.push_back(i);
      series.y.push_back(i == 39 ? 0 : std::exp(-0.1 * i * (s + 1)));
    }
    plot.series.push_back(series);
  }
  return plot;
}

std::set<std::string> ids_of(const std::string& markup) {
  std::set<std::string> ids;
  const std::regex id(" id=[\"']([^\"']*)[\"']");
  for (std::sregex_iterator it(markup.begin(), markup.end(), id), end; it != end; ++it)
    EXPECT_TRUE(ids.insert((*it)[1]).second) << "twice: " << (*it)[1];
  return ids;
}

std::string refusal(const std::filesystem::path& folder, const std::string& text) {
  write_whole_file(folder / "bad.csv", text);
  try {
    read_csv(folder / "bad.csv");
  } catch (const InputError& error) {
    EXPECT_EQ(error.problems().size(), 1u);
    return std::string(error.what()).substr(folder.string().size() + 1);
  }
  return "";
}

TEST(ReportTable, NumbersAreShortAndKeepTheirDigits) {
  EXPECT_EQ(number_text(1.2345e-4), "1.23e-4");
  EXPECT_EQ(number_text(12.345), "12.3");
  EXPECT_EQ(number_text(9.996), "10.0");
  EXPECT_EQ(number_text(0.01), "0.0100");
  EXPECT_EQ(number_text(0.00099996), "0.00100");
  EXPECT_EQ(number_text(33666), "33666");
  EXPECT_EQ(number_text(1234.56), "1235");
  EXPECT_EQ(number_text(-2.5e7), "-2.50e7");
  EXPECT_EQ(number_text(3.14159, 5), "3.1416");
  EXPECT_EQ(number_text(1.6e-9, 1), "2e-9");
  EXPECT_EQ(number_text(0), "0");
  EXPECT_EQ(number_text(-0.0), "0");
  EXPECT_EQ(number_text(std::nan("")), "");
  EXPECT_EQ(number_text(-INFINITY), "-inf");
}

TEST(ReportTable, CsvGivesBackEveryCell) {
  const test::TemporaryFolder folder;
  const ReportTable table = table_of("table1");
  write_csv(table, folder.path);
  const Records records = read_csv(folder.path / "table1.csv");
  ASSERT_EQ(records.size(), 4u);
  EXPECT_EQ(records[0], (std::vector<std::string>{"row", "model", "time, ours [ms]", "error \"e\""}));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(records[i + 1][0], std::to_string(i + 1));
    EXPECT_EQ(std::vector<std::string>(records[i + 1].begin() + 1, records[i + 1].end()), table.rows[i]);
  }
  EXPECT_EQ(test::read_file(folder.path / "table1.csv").substr(0, 63),
            "row,model,\"time, ours [ms]\",\"error \"\"e\"\"\"\n1,bar,12.3,1.23e-4\n2,");
}

TEST(ReportTable, CsvMayEndItsLinesInEitherWay) {
  const test::TemporaryFolder folder;
  write_whole_file(folder.path / "a.csv", "a,b\r\n1,\"x\r\ny\"\r\n,");
  EXPECT_EQ(read_csv(folder.path / "a.csv"), (Records{{"a", "b"}, {"1", "x\r\ny"}, {"", ""}}));
}

TEST(ReportTable, MalformedCsvIsRefusedWithItsPlace) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(refusal(folder.path, ""), "bad.csv: is empty; a table has at least a header");
  EXPECT_EQ(refusal(folder.path, "a,b\n1\n"), "bad.csv:2: 1 fields; the header has 2");
  EXPECT_EQ(refusal(folder.path, "a,b\n\"x\ny\",2\n1,2,3\n"), "bad.csv:4: 3 fields; the header has 2");
  EXPECT_EQ(refusal(folder.path, "a\n1\"2\n"), "bad.csv:2:2: a quote inside a field that does not begin with one");
  EXPECT_EQ(refusal(folder.path, "a\n\"1\"2\n"), "bad.csv:2:4: text after the quote that closes the field");
  EXPECT_EQ(refusal(folder.path, "a,b\n1,\"2\n3"), "bad.csv:2:3: this quote is never closed");
  EXPECT_EQ(refusal(folder.path, "a\rb\n"), "bad.csv:1:3: a carriage return that no line feed follows");
  EXPECT_THROW(read_csv(folder.path / "none.csv"), InputError);
}

TEST(ReportTable, JsonHasNumbersWhereCellsAreNumbers) {
  const test::TemporaryFolder folder;
  write_json(table_of("t"), folder.path);
  const auto rows = nlohmann::json::parse(test::read_file(folder.path / "t.json"));
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0]["row"], 1);
  EXPECT_EQ(rows[0]["model"], "bar");
  EXPECT_EQ(rows[0]["time, ours [ms]"], 12.3);
  EXPECT_EQ(rows[0]["error \"e\""], 1.23e-4);
  EXPECT_TRUE(rows[1]["time, ours [ms]"].is_null());
  EXPECT_EQ(rows[1]["error \"e\""], "007");
  EXPECT_EQ(rows[2]["time, ours [ms]"], -4);
  EXPECT_EQ(rows[2]["error \"e\""], "1e999");
  for (const char* text : {"", "inf", "nan", "1 ", " 1", "+1", "0x10", "1.", ".5", "true", "[1]", "1,2"})
    EXPECT_FALSE(reads_as_number(text)) << text;
}

TEST(ReportTable, JsonHasListsAndTruthsAsWhatTheyAre) {
  const test::TemporaryFolder folder;
  write_json({.name = "t", .columns = {"a"}, .rows = {{"[0, -9.5, 0]"}, {"true"}, {"[soft, stiff]"}, {"truly"}}},
             folder.path);
  const auto rows = nlohmann::json::parse(test::read_file(folder.path / "t.json"));
  EXPECT_EQ(rows[0]["a"], nlohmann::json::parse("[0, -9.5, 0]"));
  EXPECT_EQ(rows[1]["a"], true);
  EXPECT_EQ(rows[2]["a"], "[soft, stiff]");
  EXPECT_EQ(rows[3]["a"], "truly");
}

TEST(ReportTable, ChecksNamesColumnsAndRows) {
  const test::TemporaryFolder folder;
  ReportTable table = table_of("../t");
  EXPECT_THROW(write_csv(table, folder.path), std::logic_error);
  table = table_of("t");
  table.rows[1].pop_back();
  EXPECT_THROW(write_csv(table, folder.path), std::logic_error);
  table = table_of("t");
  table.columns[2] = "model";
  EXPECT_THROW(write_json(table, folder.path), std::logic_error);
}

TEST(ReportMarkup, EscapesTextAndPrefixesIdsInTagsOnly) {
  EXPECT_EQ(markup_text("a<b & \"c\"\x01'"), "a&lt;b &amp; &quot;c&quot; &#39;");
  EXPECT_EQ(with_id_prefix("<g id='a'> id=\"b\" <use xlink:href='#a' fill=\"url(#c)\"/>", "p-"),
            "<g id='p-a'> id=\"b\" <use xlink:href='#p-a' fill=\"url(#p-c)\"/>");
  EXPECT_EQ(count_code_points("µm²"), 3u);
}

TEST(ReportMarkup, WritesBytesAsBase64) {
  const auto text = [](std::string_view bytes) {
    return base64_text({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  };
  EXPECT_EQ(text(""), "");
  EXPECT_EQ(text("f"), "Zg==");
  EXPECT_EQ(text("fo"), "Zm8=");
  EXPECT_EQ(text("foobar"), "Zm9vYmFy");
  EXPECT_EQ(text("\xff\xfe\xfd"), "//79");
}

TEST(ReportPlot, DrawsEverySeriesUnderItsName) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const test::TemporaryFolder folder;
  std::string why;
  ASSERT_TRUE(write_plot(plot_of("figure-1", 14), folder.path, &why)) << why;
  const std::string svg = test::read_file(folder.path / "figure-1.svg");
  for (const char* text : {"<title>Error &lt;against&gt; time</title>", "<title>method 0</title>",
                           "<text>a&lt;b &amp; ", "it's x_1</text>", "<text>method 13</text>", "relative error"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  EXPECT_EQ(svg.find("<title>gnuplot"), std::string::npos);
  for (const std::string& id : ids_of(svg)) EXPECT_EQ(id.rfind("figure-1-", 0), 0u) << id;
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path), {}), 2);
  const Records records = read_csv(folder.path / "figure-1.csv");
  ASSERT_EQ(records.size(), 1u + 14 * 40);
  EXPECT_EQ(records[40], (std::vector<std::string>{"method 0", "39", "0"}));
}

// To gnuplot, such names by themselves would be commands of a shell, or an option.
TEST(ReportPlot, IsDrawnInAFolderOfAnyName) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const test::TemporaryFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path);
  for (const char* name : {"|cat", "< echo", "-persist"}) {
    std::filesystem::create_directory(name);
    std::string why;
    EXPECT_TRUE(write_plot(plot_of("figure-1", 2), name, &why)) << why;
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(name) / "figure-1.svg")) << name;
  }
  std::filesystem::current_path(before);
}

TEST(ReportPlot, DrawsAllKindsOfAxesAndStyles) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const test::TemporaryFolder folder;
  const std::vector<std::vector<double>> values = {
      {5, 5, 5}, {12, 13, 14}, {1, 30, 50}, {1e-300, 1, 1e300}, {1, NAN, INFINITY}};
  std::string why;
  int drawn = 0;
  for (const auto style : {ReportPlot::Style::lines, ReportPlot::Style::points, ReportPlot::Style::steps}) {
    for (const bool log : {false, true}) {
      for (const auto& y : values) {
        ReportPlot plot;
        plot.name = "p";
        plot.log_x = plot.log_y = log;
        plot.style = style;
        plot.series = {{"", {1, 2, 3}, y}};
        EXPECT_TRUE(write_plot(plot, folder.path, &why)) << why;
        plot.y_min = 2, plot.y_max = 2.2;
        EXPECT_TRUE(write_plot(plot, folder.path, &why)) << why;
        ++drawn;
      }
    }
  }
  EXPECT_EQ(drawn, 30);
}

TEST(ReportPlot, WithoutGnuplotKeepsTheNumbersAndSaysWhatToInstall) {
  const test::TemporaryFolder folder;
  write_whole_file(folder.path / "f.svg", "of an earlier run");
  const OtherPath path((folder.path / "nothing").string());
  std::string why;
  EXPECT_FALSE(write_plot(plot_of("f", 2), folder.path, &why));
  EXPECT_EQ(why, "no picture of f: gnuplot is not installed (Debian: gnuplot-nox); its numbers are in f.csv");
  EXPECT_FALSE(write_plot(plot_of("f", 2), folder.path, nullptr));
  EXPECT_EQ(read_csv(folder.path / "f.csv").size(), 81u);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path), {}), 1);
}

TEST(ReportPlot, AGnuplotThatFailsLosesNothing) {
  const test::TemporaryFolder folder, programs;
  const OtherPath path(programs.path.string());
  const auto reason = [&](const std::string& program) {
    write_program(programs.path / "gnuplot", "#!/bin/sh\n" + program);
    std::string why;
    EXPECT_FALSE(write_plot(plot_of("f", 2), folder.path, &why));
    EXPECT_EQ(read_csv(folder.path / "f.csv").size(), 81u);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path), {}), 1);
    return why;
  };
  EXPECT_EQ(reason("kill -9 $$"), "no picture of f: gnuplot was ended by signal 9; its numbers are in f.csv");
  EXPECT_EQ(reason("echo broken; exit 3"),
            "no picture of f: gnuplot ended with status 3: broken; its numbers are in f.csv");
  EXPECT_EQ(reason("exit 0"), "no picture of f: gnuplot wrote no SVG; its numbers are in f.csv");
}

TEST(ReportPlot, SaysWhenNothingCanBeDrawn) {
  const test::TemporaryFolder folder;
  ReportPlot plot;
  plot.name = "f";
  plot.series = {{"s", {1, 2}, {0, NAN}}};
  std::string why;
  EXPECT_FALSE(write_plot(plot, folder.path, &why));
  EXPECT_EQ(why, "no picture of f: it has no point that can be drawn; its numbers are in f.csv");
  EXPECT_EQ(test::read_file(folder.path / "f.csv"), "series,x,y\ns,1,0\ns,2,\n");
}

ReportPage page_of() {
  ReportTable narrow = table_of("table2");
  narrow.page_columns = {"error \"e\"", "model"};
  return {"Report <1>",
          "Lead.",
          {{"machine", "a & b"}},
          {{"table1", "Tables", "One.\n\nTwo.", {table_of("table1"), narrow}, {}},
           {"plots", "Plots", "", {}, {plot_of("figure1", 3), plot_of("figure2", 14)}}}};
}

TEST(ReportPage, ShowsEveryRowAndNeedsNothingFromElsewhere) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(write_page(page_of(), folder.path).empty(), has_gnuplot());
  const std::string html = test::read_file(folder.path / "index.html");
  for (const char* text :
       {"<h1>Report &lt;1&gt;</h1>", "<dt>machine</dt><dd>a &amp; b</dd>", "<p>One.</p>\n<p>Two.</p>",
        "<p>First &lt;paragraph&gt;.</p>\n<p>Second.</p>", "<a href=\"#section-table1\">Tables</a>",
        "<tr><td class=\"row\">1</td><td class=\"short\">bar</td><td class=\"number\">12.3</td>"
        "<td class=\"number\">1.23e-4</td></tr>",
        "<tr><td class=\"row\">2</td><td class=\"short\">a, &quot;b&quot;\nc</td><td class=\"number\"></td>",
        "<tr><td class=\"row\">3</td><td class=\"number\">1e999</td><td "
        "class=\"short\">&lt;i&gt;hippo&lt;/i&gt;</td></tr>",
        "time, ours <span class=\"unit\">[ms]</span>", "2 of 3 columns shown"})
    EXPECT_NE(html.find(text), std::string::npos) << text;
  for (const char* outside : {"http", "<script src", "<link", "src=", "@import", "url(h"})
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
  const std::set<std::string> ids = ids_of(html);
  const std::regex link("href=[\"'](#?)([^\"']+)[\"']");
  int links = 0;
  for (std::sregex_iterator it(html.begin(), html.end(), link), end; it != end; ++it, ++links) {
    const std::string target = (*it)[2];
    const bool inside = (*it)[1].length() == 1;
    EXPECT_TRUE(inside ? ids.count(target) > 0 : std::filesystem::exists(folder.path / target)) << target;
  }
  EXPECT_GE(links, 12);
}

TEST(ReportPage, HoldsPicturesAndRoundsWhereATableSaysSo) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "sheet.png") << "foobar";
  ReportTable table{"points", "Points"};
  table.columns = {"value"};
  table.rows = {{"0.123456789"}, {"0.2"}, {"word"}};
  table.row_name = "point";
  table.first_row = 0;
  table.page_digits = 3;
  ReportSection section{"all", "All"};
  section.tables = {table};
  section.pictures = {{"sheet", "A & B", "Note."}};
  EXPECT_TRUE(write_page({"Page", "", {}, {section}}, folder.path).empty());
  const std::string html = test::read_file(folder.path / "index.html");
  EXPECT_NE(html.find("<img alt=\"A &amp; B\" src=\"data:image/png;base64,Zm9vYmFy\">"), std::string::npos);
  EXPECT_NE(html.find("<a href=\"#sheet\">A &amp; B</a>"), std::string::npos);
  EXPECT_NE(html.find("<th class=\"row\" scope=\"col\">point</th>"), std::string::npos);
  EXPECT_NE(html.find("<td class=\"row\">0</td><td class=\"number\">0.123</td>"), std::string::npos);
  EXPECT_NE(html.find("<td class=\"row\">1</td><td class=\"number\">0.2</td>"), std::string::npos);
  EXPECT_EQ(test::read_file(folder.path / "points.csv"), "point,value\n0,0.123456789\n1,0.2\n2,word\n");
  EXPECT_NE(test::read_file(folder.path / "points.json").find("\"point\": 0,\n  \"value\": 0.123456789"),
            std::string::npos);
}

TEST(ReportPage, WithoutGnuplotSaysSoInThePicturesPlace) {
  const test::TemporaryFolder folder;
  const OtherPath path((folder.path / "nothing").string());
  EXPECT_EQ(write_page(page_of(), folder.path).size(), 2u);
  const std::string html = test::read_file(folder.path / "index.html");
  EXPECT_NE(html.find("<p class=\"missing\">no picture of figure1: gnuplot is not installed (Debian: gnuplot-nox); its "
                      "numbers are in figure1.csv</p>"),
            std::string::npos);
  EXPECT_EQ(html.find("figure1.svg"), std::string::npos);
  EXPECT_NE(html.find("href=\"figure1.csv\""), std::string::npos);
}

TEST(ReportPage, ASeriesLooksAlikeInAllPlots) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const test::TemporaryFolder folder;
  ReportPage page = page_of();
  page.sections[1].plots[1].series = {page.sections[1].plots[0].series[2], page.sections[1].plots[0].series[1]};
  write_page(page, folder.path);
  // The method is the second of the thin ones in the first plot, and the first in the other.
  const auto color = [&](const std::string& plot) {
    const std::string svg = test::read_file(folder.path / (plot + ".svg"));
    const std::size_t line = svg.find("<path stroke='rgb(", svg.find("<title>method 2</title>"));
    return svg.substr(line, svg.find(')', line) - line);
  };
  EXPECT_EQ(color("figure1"), color("figure2"));
  EXPECT_NE(color("figure1").find("rgb( 89, 161,  79"), std::string::npos) << color("figure1");
}

TEST(ReportPage, RefusesNamesThatWouldShareAFile) {
  const test::TemporaryFolder folder;
  ReportPage page = page_of();
  page.sections[1].plots[1].name = "table1";
  EXPECT_THROW(write_page(page, folder.path), std::logic_error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path));
}

}  // namespace report_test
}  // namespace supple
