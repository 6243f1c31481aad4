// SPDX-License-Identifier: BSD-3-Clause
// keepout report, and commands with and without the front end of pages. Two small files stand for
// the front end.

#include <nlohmann/json.hpp>

#include "apps/command_process.h"
#include "apps/page/unpacked_page.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/binary_stl.h"

namespace keepout {
namespace {

using Json = nlohmann::ordered_json;
using Outcome = test::ProcessOutcome;

class Report : public testing::Test {
 protected:
  void SetUp() override {
    write_binary_stl(folder_.file("cube.stl"), make_cube(20.0));
    std::filesystem::create_directory(folder_.file("web"));
    for (const char* name : {"report", "report_with_anatomy"}) {
      folder_.write(std::string("web/") + name + ".html",
                    std::string("<p>") + name +
                        "</p>\n<!-- keepout report: the record goes here -->\n<p>after</p>\n");
    }
  }

  Outcome run(const std::string& arguments, const std::string& environment = "KEEPOUT_WEB=web ") {
    return folder_.run(arguments, "env " + environment);
  }
  /// Returns the record in a page.
  Json record_in(const std::string& page) const {
    const std::string text = folder_.contents(page);
    const std::string opening = "<script type=\"application/octet-stream\" id=\"record\">";
    const std::size_t begin = text.find(opening) + opening.size();
    const std::string base64 = text.substr(begin, text.find("</script>", begin) - begin);
    const auto bytes = test::gunzipped(test::from_base64(base64));
    return Json::parse(bytes.begin(), bytes.end());
  }
  void expect_refused(const std::string& arguments, const std::string& told,
                      const std::string& environment = "KEEPOUT_WEB=web ") {
    const Outcome outcome = run(arguments, environment);
    EXPECT_EQ(outcome.status, 1) << outcome.output;
    EXPECT_CONTAINS(outcome.output, told);
  }

  test::CommandFolder folder_;
};

constexpr const char* simulate =
    "simulate cube.stl --strokes 1 --cycles 20 --activation certified --out r.html ";
constexpr const char* without = "KEEPOUT_WEB=nowhere ";

TEST_F(Report, OfACommandIsThatOfTheRecordItKept) {
  ASSERT_EQ(run(std::string(simulate) + "--json r.json").status, 0);
  const Json record = Json::parse(folder_.contents("r.json"));
  EXPECT_EQ(record_in("r.html"), record);
  const std::string page = folder_.contents("r.html");
  EXPECT_TRUE(page.starts_with("<p>report_with_anatomy</p>\n")) << page.substr(0, 60);
  EXPECT_TRUE(page.ends_with("<p>after</p>\n"));
  EXPECT_FALSE(std::filesystem::exists(folder_.file("r.html.json")));

  const Outcome outcome = succeeded(run("report r.json --out again.html"));
  EXPECT_CONTAINS(outcome.output, record["headline"].get<std::string>());
  EXPECT_EQ(folder_.contents("again.html"), page);
}

TEST_F(Report, WithoutItsFrontEndIsPlainAndMadeWholeLater) {
  const Outcome outcome = succeeded(run(simulate, without));
  for (const char* told : {"plain page", "there is no nowhere/report_with_anatomy.html",
                           "'report r.html.json' makes the whole page"}) {
    EXPECT_CONTAINS(outcome.output, told);
  }
  EXPECT_CONTAINS(folder_.contents("r.html"), "<td>certified</td>");
  expect_refused("report r.html.json", "front end is missing", without);
  EXPECT_CONTAINS(folder_.contents("r.html"), "<td>certified</td>") << "nothing is lost";
  ASSERT_EQ(run("report r.html.json").status, 0);
  EXPECT_EQ(record_in("r.html"), Json::parse(folder_.contents("r.html.json")));
}

TEST_F(Report, WhereHalfOfItsFrontEndIsMissingNothingIsLost) {
  for (const bool is_stale : {false, true}) {
    std::filesystem::remove(folder_.file("web/report_with_anatomy.html"));
    if (is_stale) folder_.write("web/report_with_anatomy.html", "<p>of another version</p>");
    for (const char* kept : {"", "--json r.html.json "}) {
      const Outcome outcome = succeeded(run(std::string(simulate) + kept));
      EXPECT_CONTAINS(outcome.output, "'report r.html.json' makes");
      EXPECT_CONTAINS(folder_.contents("r.html"), "<td>certified</td>");
      EXPECT_FALSE(folder_.contents("r.html.json").empty());
      std::filesystem::remove(folder_.file("r.html.json"));
    }
  }
}

TEST_F(Report, OfAMeshIsNamedByWhatItShows) {
  Surface open = make_cube(20.0);
  open.triangles.pop_back();
  write_binary_stl(folder_.file("open.stl"), open);
  const auto said = [&](const std::string& mesh, const std::string& environment) {
    return succeeded(run("inspect " + mesh + " --out r.html", environment)).output;
  };
  EXPECT_CONTAINS(said("cube.stl", "KEEPOUT_WEB=web "), "\nPage: r.html\n");
  EXPECT_CONTAINS(said("open.stl", "KEEPOUT_WEB=web "), "\nPage with the faults marked: r.html\n");
  EXPECT_CONTAINS(said("open.stl", without), "\nPage, with tables, no pictures: r.html\n");
}

TEST_F(Report, IsRefusedOfWhatIsNoRecord) {
  folder_.write("none.json", "{\"rows\": []}");
  folder_.write("cut.json", "{\"keepout_record\": \"bench\", ");
  for (const char* file : {"none.json", "cut.json", "cube.stl"}) {
    expect_refused(std::string("report ") + file, std::string(file) + ": is no whole record");
  }
  expect_refused("report nowhere.json", "nowhere.json: cannot be read");
  folder_.write("deep.json", std::string(200'000, '['));
  expect_refused("report deep.json", "deep.json: is no whole record");
  folder_.write("web/report.html", "<p>of another version</p>");
  ASSERT_EQ(run("verify cube.stl --steps 500 --json v.json").status, 0);
  expect_refused("report v.json", "is not the front end of this keepout");
  folder_.write("v.html", folder_.contents("v.json"));
  expect_refused("report v.html --out v.html", "is the same file");
}

TEST_F(Report, OfExperimentsIsPlainAsLongAsItsFrontEndIsMissing) {
  Json head = {{"keepout_record", "experiments"}, {"format", 1}, {"complete", true}};
  for (const char* text : {"version", "date", "command", "subject", "headline"}) head[text] = "so";
  for (const char* list : {"account", "experiments"}) head[list] = Json::array();
  head["machine"] = nullptr;
  head["settings"] = Json::object();
  folder_.write("e.json", head.dump());
  const Outcome plain = succeeded(run("report e.json", without));
  EXPECT_CONTAINS(plain.output, "a plain page");
  EXPECT_CONTAINS(folder_.contents("e.html"), "<h1>so</h1>");
  Json damaged = head;
  damaged["experiments"] = {{{"title", "of pushes"}, {"headline", "so"}}};
  folder_.write("damaged.json", damaged.dump());
  expect_refused("report damaged.json", "damaged.json: is no whole record", without);
  ASSERT_EQ(run("report e.json").status, 0);
  EXPECT_EQ(record_in("e.html"), head);
  EXPECT_TRUE(folder_.contents("e.html").starts_with("<p>report</p>"));
}

TEST_F(Report, EveryCommandWritesOne) {
  for (const std::string command :
       {"verify cube.stl --steps 500", "compare cube.stl --poses 6 --problems 30 --pairs 10",
        "bench --mesh cube.stl --index pd_tree --solver active_set --activation paper --queries 20 "
        "--seconds 0.1"}) {
    const Outcome outcome = succeeded(run(command + " --json c.json --out c.html"));
    const Json record = Json::parse(folder_.contents("c.json"));
    EXPECT_EQ(record_in("c.html"), record) << command;
    EXPECT_TRUE(folder_.contents("c.html").starts_with("<p>report</p>"));
    EXPECT_EQ(record["command"], "keepout " + command + " --json c.json --out c.html");
    // The terminal breaks lines, but prints the same words.
    std::string printed = outcome.output, headline = record["headline"];
    for (std::string* text : {&printed, &headline}) {
      std::erase_if(*text, [](char c) { return c == ' ' || c == '\n'; });
    }
    EXPECT_CONTAINS(printed, headline) << headline << outcome.output;
  }
}

}  // namespace
}  // namespace keepout
