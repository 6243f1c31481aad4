// SPDX-License-Identifier: BSD-3-Clause
// The page that `keepout live` writes, its messages and its errors.

#include <Eigen/LU>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/command_process.h"
#include "apps/page/unpacked_page.h"
#include "keepout/geometry/pose.h"
#include "keepout/index/index_cache.h"
#include "keepout/mesh/binary_stl.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/oracle/instrument_oracle.h"
#include "keepout/version.h"
#include "live/browser.h"
#include "meshes.h"

namespace keepout::app {
namespace {

namespace fs = std::filesystem;
using Outcome = test::ProcessOutcome;

const std::string place = "<!-- keepout live: the anatomy goes here -->\n";

class Live : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(folder_.file("web"));
    folder_.write("web/live.html", "<p>before</p>\n" + place + "<p>after</p>\n");
  }
  Outcome run(const std::string& arguments, const std::string& environment = {}) const {
    return folder_.run("live " + arguments,
                       "env -u DISPLAY -u WAYLAND_DISPLAY KEEPOUT_WEB=web " + environment);
  }
  /// Returns the content of the element with this id, up to what a browser takes for its end.
  std::string element(const std::string& id, const std::string& page = "keepout-live.html") const {
    const std::string text = folder_.contents(page);
    const std::string start = "id=\"" + id + "\">";
    const std::size_t at = text.find(start);
    if (at == std::string::npos) return {};
    const std::size_t from = at + start.size();
    return text.substr(from, text.find("</script", from) - from);
  }
  nlohmann::json settings() const { return nlohmann::json::parse(element("settings")); }
  void expect_refused(const std::string& arguments, const std::string& told, int status = 1,
                      const std::string& environment = {}) const {
    const Outcome outcome = run(arguments, environment);
    EXPECT_EQ(outcome.status, status) << arguments << '\n' << outcome.output;
    EXPECT_CONTAINS(outcome.output, told) << arguments;
    EXPECT_FALSE(fs::exists(folder_.file("keepout-live.html"))) << arguments;
  }

  test::CommandFolder folder_;
};

TEST_F(Live, ThePageHasTheSettingsAndEveryBitOfTheMeshes) {
  write_binary_stl(folder_.file("heart of a pig.stl"), make_shape("sphere"));
  succeeded(
      run("cube 'heart of a pig.stl' --activation none --radius 4 --tool-radius 0.5 --margin 0.25 "
          "--max-step 0.125 --guide ball:0,0,0:9 --guide high=half_space:0,0,-9:0,0,1"));
  nlohmann::json told = settings();
  const nlohmann::json meshes = told.at("meshes");
  told.erase("meshes");
  EXPECT_EQ(told,
            nlohmann::json::parse(R"({"format": "keepout live", "version": 1, "activation": "none",
      "radius": 4.0, "tool_radius": 0.5, "margin": 0.25, "max_step": 0.125,
      "guides": ["ball:0,0,0:9", "high=half_space:0,0,-9:0,0,1"],
      "keepout": ")" KEEPOUT_VERSION R"("})"));
  ASSERT_EQ(meshes.size(), 2U);
  EXPECT_EQ(meshes[0].at("name"), "cube");
  EXPECT_EQ(meshes[0].at("command_name"), "cube");
  EXPECT_EQ(meshes[0].at("warnings"), nlohmann::json::array());
  EXPECT_EQ(meshes[1].at("name"), "heart of a pig.stl");
  EXPECT_EQ(meshes[1].at("command_name"), "'heart of a pig.stl'");
  const Mesh cube(make_shape("cube"));
  const auto sphere = load_mesh(folder_.file("heart of a pig.stl")).mesh;
  for (std::size_t i = 0; i < 2; ++i) {
    const Mesh& mesh = i == 0 ? cube : *sphere;
    const nlohmann::json& facts = meshes[i];
    EXPECT_EQ(facts.at("vertices"), mesh.vertex_count());
    EXPECT_EQ(facts.at("triangles"), mesh.triangle_count());
    const auto bytes = test::gunzipped(test::from_base64(element("mesh-" + std::to_string(i))));
    EXPECT_TRUE(test::same_bits(test::unpacked(facts.at("coordinates").get<std::string>(), bytes,
                                               mesh.vertex_count(), mesh.triangle_count()),
                                mesh))
        << facts;
  }
  const std::string page = folder_.contents("keepout-live.html");
  EXPECT_TRUE(page.starts_with("<p>before</p>\n<script")) << page.substr(0, 100);
  EXPECT_TRUE(page.ends_with("</script>\n<p>after</p>\n"));
}

TEST_F(Live, BeginsWithTheCertifiedRule) {
  ASSERT_EQ(run("cube").status, 0);
  const nlohmann::json told = settings();
  EXPECT_EQ(told.at("activation"), "certified");
  EXPECT_EQ(told.at("radius"), 5.0);
  EXPECT_EQ(told.at("tool_radius"), 3.0);
  EXPECT_EQ(told.at("margin"), 0.2);
  EXPECT_EQ(told.at("max_step"), 0.5);
}

TEST_F(Live, AnInstrumentBeginsWithAllBodiesClearAndItsPortBesideTheMesh) {
  const Outcome outcome = succeeded(run("cortex --robot psm --margin 0.5"));
  EXPECT_CONTAINS(outcome.output, "Drag the jaw");
  const nlohmann::json told = settings();
  EXPECT_EQ(told.at("robot"), "psm");
  EXPECT_EQ(told.at("margin"), 0.5);
  const nlohmann::json& facts = told.at("meshes").at(0);
  const auto mesh = mesh_of("cortex");
  EXPECT_EQ(facts.at("digest"), index_cache_file(*mesh, {}).stem().string());
  const auto numbers = facts.at("start").at("base").get<std::array<double, 12>>();
  Pose base{Vec3(numbers.data()), Mat3(Eigen::Map<const Mat3>(numbers.data() + 3).transpose())};
  EXPECT_TRUE((base.rotation * base.rotation.transpose()).isIdentity(1e-12));
  EXPECT_NEAR(base.rotation.determinant(), 1.0, 1e-12);
  EXPECT_GT(distance_to(mesh->bounds(), base.position), 0.0);
  oracle::InstrumentOracle judge(std::make_shared<const monitor::TriangleTree>(mesh),
                                 monitor::judged_psm(), base);
  judge.move_to(facts.at("start").at("positions").get<std::vector<double>>());
  EXPECT_GE(judge.clearance(0.5), 0.5);
  EXPECT_LT(judge.clearance(judge.bodies() - 1, 30.0), 25.0) << "the jaw is before the surface";
}

TEST_F(Live, WhatIsOfABallIsRefusedForAnInstrument) {
  expect_refused("cube --robot pms", "there is no 'pms'; did you mean 'psm'?", 2);
  expect_refused("cube --robot psm --activation paper", "--activation", 2);
  expect_refused("cube --robot psm --tool-radius 1", "--tool-radius", 2);
  expect_refused("cube --robot psm --radius 1", "--radius", 2);
  expect_refused("cube --robot psm --guide ball:0,0,0:9", "is for a tip, but", 2);
  expect_refused("cube --guide axis:6:0,0,1:0,0,1:1", "but this is a tip", 2);
  expect_refused("cube --robot psm --margin 25", "cube: there is no room for the instrument");
}

TEST_F(Live, AMeshThatWasTurnedIsNamedAsItWas) {
  write_binary_stl(folder_.file("ball.stl"), make_shape("sphere"));
  succeeded(run("ball.stl --untagged RAS --space LPS"));
  EXPECT_EQ(settings().at("meshes").at(0).at("command_name"),
            "ball.stl --space LPS --untagged RAS");
  succeeded(run("ball.stl --scale 0.5 --flip"));
  const nlohmann::json mesh = settings().at("meshes").at(0);
  EXPECT_EQ(mesh.at("command_name"), "ball.stl --scale 0.5 --flip");
  EXPECT_EQ(mesh.at("warnings").at(0), "ball.stl: scaled by 0.5");
}

TEST_F(Live, WarningsOfAMeshAreInThePageToo) {
  const Outcome outcome = succeeded(run("flat_plate"));
  const nlohmann::json warnings = settings().at("meshes").at(0).at("warnings");
  ASSERT_FALSE(warnings.empty());
  for (const nlohmann::json& warning : warnings) {
    EXPECT_CONTAINS(outcome.output, warning.get<std::string>());
  }
}

TEST_F(Live, NoNameOfAFileEndsAScriptOrIsLost) {
  // File names contain no slash, but paths do.
  for (const std::string name : {"<!--<script>.stl", "<", "a\"b\\c'.stl"}) {
    fs::create_directories(folder_.file(name + "<"));
    const std::string path = name + "</script><b>.stl";
    write_binary_stl(folder_.file(path), make_shape("cube"));
    const std::string quoted = [&] {
      std::string text;
      for (const char c : path) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
      return "'" + text + "'";
    }();
    ASSERT_EQ(run(quoted).status, 0) << path;
    EXPECT_EQ(settings().at("meshes").at(0).at("name"), "script><b>.stl");
    EXPECT_EQ(settings().at("meshes").at(0).at("command_name"), quoted);
    EXPECT_LACKS(element("settings"), '<');
  }
}

TEST_F(Live, ANameThatIsNotUtf8IsReplacedWhereJsonCannotHaveIt) {
  write_binary_stl(folder_.file("caf\xe9.stl"), make_shape("cube"));
  ASSERT_EQ(run("'caf\xe9.stl'").status, 0);
  EXPECT_EQ(settings().at("meshes").at(0).at("name"), "caf\xef\xbf\xbd.stl");
}

TEST_F(Live, SaysWhereThePageIsAndWhatToDoInIt) {
  const Outcome outcome = succeeded(run("cube --out 'my page.html'"));
  EXPECT_TRUE(outcome.output.starts_with("my page.html, 0.0 MB; open it in a browser:\n"))
      << outcome.output;
  EXPECT_CONTAINS(outcome.output, "\n  " + file_url(folder_.file("my page.html")) + '\n');
  EXPECT_CONTAINS(outcome.output, "Drag the red ring");
}

TEST_F(Live, WhatIsWrongIsToldAndNoPageIsWritten) {
  expect_refused("cube --activation certifed", "there is no 'certifed'; did you mean 'certified'?",
                 2);
  expect_refused("cube --tool-raduis 1", "did you mean '--tool-radius'?", 2);
  expect_refused("skul", "did you mean 'skull'?");
  expect_refused("cube no_such.stl", "no_such.stl: there is no such file");
  expect_refused("cube --max-step 5.5", "--max-step is longer than --radius");
  expect_refused("cube --radius 1e-200 --max-step 1e-200", "radius", 2);
  expect_refused("cube --radius 1e-200 --max-step 1e-200 --activation none", "radius", 2);
  expect_refused("cube --out no/such/folder.html", "cannot write here");
}

TEST_F(Live, NeitherAMeshNorThePagesOwnPartsAreOverwritten) {
  write_binary_stl(folder_.file("mesh.stl"), make_shape("cube"));
  for (const auto& [name, told, status] : {std::tuple("mesh.stl", "ends with .html", 2),
                                           std::tuple("web/live.html", "would overwrite it", 1)}) {
    const std::string before = folder_.contents(name);
    expect_refused(std::string("cube ./mesh.stl --out ") + name, told, status);
    EXPECT_EQ(folder_.contents(name), before) << name;
  }
}

TEST_F(Live, WithoutThePagesPartsItSaysWhatToDo) {
  expect_refused(
      "cube",
      "there is no elsewhere/live.html. In a checkout of keepout, with npm and a network, ./run "
      "makes the pages of reports and ./run live makes live.html",
      1, "KEEPOUT_WEB=elsewhere");
  for (const std::string& page : {std::string("<p>no place</p>\n"), place + place}) {
    folder_.write("web/live.html", page);
    expect_refused("cube", "is not the front end of this keepout");
  }
}

TEST_F(Live, TheDesktopIsAskedToOpenThePageWhereThereIsOne) {
  fs::create_directory(folder_.file("bin"));
  folder_.write("bin/xdg-open",
                "#!/bin/sh\nprintf '%s\\n' \"$*\" > asked.new\nmv asked.new asked\n");
  fs::permissions(folder_.file("bin/xdg-open"), fs::perms::owner_all);
  const std::string desktop = "PATH=\"$PWD/bin:$PATH\" WAYLAND_DISPLAY=wayland-7 ";
  EXPECT_EQ(run("cube --no-open", desktop).status, 0);
  EXPECT_EQ(run("cube", "PATH=\"$PWD/bin:$PATH\" ").status, 0);
  const Outcome outcome = succeeded(run("cube --out 'that one.html'", desktop));
  EXPECT_CONTAINS(outcome.output, "is being opened in a browser");
  for (int i = 0; i < 1000 && !fs::exists(folder_.file("asked")); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(folder_.contents("asked"), file_url(folder_.file("that one.html")) + '\n');
}

TEST_F(Live, WithoutAnOpenerThePageIsToBeOpenedByHand) {
  const Outcome outcome = succeeded(run("cube", "DISPLAY=:7 PATH=/nowhere "));
  EXPECT_CONTAINS(outcome.output, "; open it in a browser:");
}

TEST(FileUrl, IsAnAddressWhateverThePath) {
  EXPECT_EQ(file_url("/tmp/a.html"), "file:///tmp/a.html");
  EXPECT_EQ(file_url("/tmp/./b/../a-b_c.~1"), "file:///tmp/a-b_c.~1");
  EXPECT_EQ(file_url("/t p/50%#?&\"<\n"), "file:///t%20p/50%25%23%3F%26%22%3C%0A");
  EXPECT_EQ(file_url("/\xc3\xa9\xff"), "file:///%C3%A9%FF");
  EXPECT_EQ(file_url("page.html"), file_url(fs::current_path() / "page.html"));
}

}  // namespace
}  // namespace keepout::app
