// SPDX-License-Identifier: BSD-3-Clause
// Meshes as a user names them: files, and sample meshes that are prepared or generated.

#include <utility>

#include "apps/command_process.h"
#include "keepout/mesh/binary_stl.h"
#include "meshes.h"

namespace keepout {
namespace {

using Outcome = test::ProcessOutcome;

class NamedMesh : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder.file("cache/fixtures"));
    folder.write("poses.txt", "0 0 60 1 2 -3\n");
  }

  Outcome run(const std::string& arguments, const std::string& more = {}) const {
    return folder.run(arguments, "KEEPOUT_CACHE=cache KEEPOUT_PREPARE= " + more);
  }

  /// Writes the cube under the name of a sample mesh, or into any other file.
  void write_cube(const std::string& name, double factor = 1.0) const {
    Surface cube = make_cube(25.0);
    for (Vec3& vertex : cube.vertices) vertex *= factor;
    write_binary_stl(folder.file(name), cube);
  }

  test::CommandFolder folder;
};

/// Every command that takes a mesh, on MESH, with as little work as possible.
const std::vector<std::string> commands{
    "replay MESH --poses poses.txt --out s.csv",
    "simulate MESH --out r.html --strokes 1 --cycles 10 --activation certified",
    "verify MESH --steps 500",
    "serve MESH < /dev/null",
    "compare MESH --poses 6 --problems 10 --pairs 10",
    "bench --mesh MESH --index wide_bvh --radius 1 --queries 5 --seconds 0.01 --out b.html",
};

std::string with_mesh(std::string command, const std::string& mesh) {
  return command.replace(command.find("MESH"), 4, mesh);
}

TEST_F(NamedMesh, EveryCommandTakesGeneratedShapesByName) {
  for (const std::string& command : commands) {
    const Outcome outcome = run(with_mesh(command, "gear"));
    EXPECT_EQ(outcome.status, 0) << command << '\n' << outcome.output;
  }
  EXPECT_CONTAINS(run("inspect gear").output, "watertight");
}

TEST_F(NamedMesh, SampleMeshesAreInMillimetersAndWoundOutward) {
  write_cube("cache/fixtures/femur.stl");
  for (const std::string sample : {"sphere", "femur"}) {
    for (const std::string option : {" --unit m", " --scale 2", " --flip"}) {
      const Outcome refused = run("inspect " + sample + option);
      EXPECT_EQ(refused.status, 1);
      EXPECT_CONTAINS(refused.output, sample + ": is a sample mesh, in mm");
    }
  }
  EXPECT_CONTAINS(run("inspect cache/fixtures/femur.stl --flip").output, "flipped, as asked");
}

TEST_F(NamedMesh, EveryCommandTakesPreparedMeshesByName) {
  write_cube("cache/fixtures/femur.stl");
  for (const std::string& command : commands) {
    const Outcome outcome = run(with_mesh(command, "femur"));
    EXPECT_EQ(outcome.status, 0) << command << '\n' << outcome.output;
  }
  EXPECT_CONTAINS(run("inspect femur").output, "size          100 x 100 x 100 mm");
}

TEST_F(NamedMesh, AFileOfThatNameWinsAndAFolderDoesNot) {
  folder.write("sphere", "no mesh");
  EXPECT_CONTAINS(run("inspect sphere").output, "its extension is none of");
  std::filesystem::create_directory(folder.file("cube"));
  EXPECT_CONTAINS(run("inspect cube").output, "size          100 x 100 x 100 mm");
}

TEST_F(NamedMesh, ANameThatIsNeitherListsThoseThatAreNear) {
  write_cube("scan_of_hip.stl");
  const std::vector<std::pair<std::string, std::string>> mistakes{
      {"skul", "did you mean 'skull'?"},
      {"skull.stl", "did you mean 'skull'?"},
      {"cubes", "did you mean 'cube'?"},
      {"scan_of_hips.stl", "did you mean 'scan_of_hip.stl'?"},
      {"./scan_of_hpi.stl", "did you mean './scan_of_hip.stl'?"},
      {"kidney", "sample meshes are skull, skull_1m, "},
  };
  for (const auto& [name, told] : mistakes) {
    const Outcome outcome = run("inspect " + name);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(outcome.output.starts_with("keepout: " + name + ": there is no such file"))
        << outcome.output;
    EXPECT_CONTAINS(outcome.output, told);
  }
}

TEST_F(NamedMesh, WhatIsMissingIsPreparedByTheProgramThatRunNames) {
  write_cube("cube.stl");
  folder.write("prepare", "#!/bin/sh\necho \"making $1\"; cp cube.stl \"cache/fixtures/$1.stl\"\n");
  std::filesystem::permissions(folder.file("prepare"), std::filesystem::perms::owner_all);
  const Outcome missing = run("inspect liver");
  EXPECT_EQ(missing.status, 1);
  EXPECT_CONTAINS(missing.output, "`fixtures/prepare liver`");
  const Outcome prepared = succeeded(run("inspect liver", "KEEPOUT_PREPARE=./prepare"));
  EXPECT_CONTAINS(prepared.output, "making liver");
  EXPECT_LACKS(run("inspect liver", "KEEPOUT_PREPARE=./prepare").output, "making");
  const Outcome failed = run("inspect brain", "KEEPOUT_PREPARE=false");
  EXPECT_EQ(failed.status, 1);
  EXPECT_CONTAINS(failed.output, "the fixture 'brain' is not prepared");
}

std::size_t occurrences(const std::string& text, std::string_view part) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++count;
  return count;
}

TEST_F(NamedMesh, EveryCommandTellsOfMetresHolesAndWindingOnceOnStderr) {
  write_cube("meters.stl", 0.001);
  Surface bad = opened(make_cube(25.0));
  std::swap(bad.triangles[0][0], bad.triangles[0][1]);
  write_binary_stl(folder.file("bad.stl"), bad);
  for (const std::string& command : commands) {
    const auto told = [&](const std::string& mesh) {
      return run(with_mesh(command, mesh) + " >/dev/null 2>told.txt; cat told.txt").output;
    };
    // The warning is printed even if the command rejects the mesh.
    const std::string metres = told("meters.stl");
    EXPECT_EQ(occurrences(metres, "keepout: meters.stl: the mesh is 0.1 mm across"), 1u)
        << command << '\n'
        << metres;
    const std::string open = told("bad.stl");
    EXPECT_EQ(occurrences(open, "keepout: bad.stl: the surface is open"), 1u) << command << '\n'
                                                                              << open;
    EXPECT_EQ(occurrences(open, "keepout: bad.stl: the surface is wound inconsistently"), 1u)
        << command << '\n'
        << open;
  }
  // inspect prints findings instead of warnings.
  const std::string findings = run("inspect bad.stl").output;
  EXPECT_CONTAINS(findings, "3 inconsistently wound edges");
  EXPECT_LACKS(findings, "keepout:");
}

}  // namespace
}  // namespace keepout
