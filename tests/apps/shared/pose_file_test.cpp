// SPDX-License-Identifier: BSD-3-Clause
#include "shared/pose_file.h"

#include <utility>
#include <vector>

#include "temporary_folder.h"

namespace keepout::app {
namespace {

class PoseFile : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) { return folder_.write("poses.txt", text); }

  void expect_error(const std::string& text, const std::string& place, const std::string& what) {
    const std::string message = error_of([&] { read_poses(write(text)); });
    EXPECT_CONTAINS(message, "poses.txt" + place);
    EXPECT_CONTAINS(message, what);
  }

  TemporaryFolder folder_;
};

TEST_F(PoseFile, ReadsSixNumbersALine) {
  const auto poses = read_poses(write("1 2 3 4 5 6\n-1e-3\t+2.5 0,7, 8 ,9\r\n"));
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0].first, Vec3(1, 2, 3));
  EXPECT_EQ(poses[0].second, Vec3(4, 5, 6));
  EXPECT_EQ(poses[1].first, Vec3(-1e-3, 2.5, 0));
  EXPECT_EQ(poses[1].second, Vec3(7, 8, 9));
}

TEST_F(PoseFile, PassesOverBlankLinesAndComments) {
  const auto poses = read_poses(write("# tip, increment\n\n   \n1 2 3 4 5 6\n  # end"));
  EXPECT_EQ(poses.size(), 1u);
}

TEST_F(PoseFile, NamesFileLineAndRemedy) {
  expect_error("1 2 3 4 5 6\n1 2 3 4 5\n", ":2:", "fewer than six");
  expect_error("# c\n\n1 2 3 4 5 6 7\n", ":3:", "'7' is too many");
  expect_error("1 2 x 4 5 6\n", ":1:", "'x' is not a number");
  expect_error("1 2 3.0.0 4 5 6\n", ":1:", "'3.0.0' is not a number");
  expect_error("1 2 nan 4 5 6\n", ":1:", "not finite");
  expect_error("1 2 3 4 5 -inf\n", ":1:", "not finite");
  expect_error("1 2 3 4 5 1e999\n", ":1:", "beyond the range of a double");
  expect_error("1 2 3 4 5 -1e-999\n", ":1:", "beyond the range of a double");
  expect_error("1 2 3 4 5 1e999x\n", ":1:", "'1e999x' is not a number");
  for (const char* word : {"+-.1", "-+.1", "++1", "--1", "+"}) {
    expect_error("1 2 3 4 5 " + std::string(word), ":1:", "'" + std::string(word) + "' is not");
  }
  expect_error("\n# nothing\n", "", "no pose");
}

TEST_F(PoseFile, AnEmptyColumnIsAnErrorAndACommaAtTheEndIsNot) {
  for (const char* line : {"1,,2,3,4,5,6", "1, ,2,3,4,5,6", ",1,2,3,4,5,6", "1,2,3,4,5,6,,", ","}) {
    expect_error(line, ":1:", "empty column");
  }
  expect_error("1,2,3,4,5,", ":1:", "fewer than six");
  const auto poses = read_poses(write("1,2,3,4,5,6,\n1 ,2 , 3,4 5\t6\n"));
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[1].second, Vec3(4, 5, 6));
}

TEST_F(PoseFile, AByteOrderMarkAtTheStartIsPassedOver) {
  for (const char* text : {"\xEF\xBB\xBF"
                           "1 2 3 4 5 6\n",
                           "\xEF\xBB\xBF# tips\n1 2 3 4 5 6\n"}) {
    const auto poses = read_poses(write(text));
    ASSERT_EQ(poses.size(), 1u);
    EXPECT_EQ(poses[0].first, Vec3(1, 2, 3));
  }
  expect_error(
      "1 2 3 4 5 6\n\xEF\xBB\xBF"
      "1 2 3 4 5 6\n",
      ":2:", "is not a number");
}

TEST_F(PoseFile, WhatAFileSaysIsQuotedShortAndWithoutControlCharacters) {
  expect_error("1 2 \x1b[2J 4 5 6\n", ":1:", "'?[2J' is not a number");
  expect_error("1 2 3 4 5 6 \x07\n", ":1:", "'?' is too many");
  expect_error("1 2 " + std::string(300, 'x') + " 4 5 6\n",
               ":1:", "'" + std::string(200, 'x') + "...'");
}

TEST_F(PoseFile, ALineThatDoesNotEndIsReadNoFurtherThanLinesGo) {
  const std::filesystem::path file = write("1 2 3 4 5 6\n#");
  std::filesystem::resize_file(file, std::uintmax_t{1} << 28);  // a hole: no disk space
  EXPECT_CONTAINS(error_of([&] { read_poses(file); }), "poses.txt:2: is longer");
}

TEST_F(PoseFile, ALineMayBeAsLongAsItsCommentIs) {
  const auto poses = read_poses(write("#" + std::string(60'000, 'x') + "\n1 2 3 4 5 6"));
  EXPECT_EQ(poses.size(), 1u);
}

TEST_F(PoseFile, FiducialsHaveAHeaderOrNoneAndWeightsOnEachLineOrNone) {
  const FiducialPairs plain = read_fiducials(write("+1,+2,+3,+4,+5,+6\n\n7 8 9 10 11 12\n"));
  EXPECT_EQ(plain.measured[1], Vec3(7, 8, 9));
  EXPECT_EQ(plain.model[0], Vec3(4, 5, 6));
  EXPECT_TRUE(plain.weights.empty());
  EXPECT_EQ(plain.lines, (std::vector<std::size_t>{1, 3}));
  const FiducialPairs weighted = read_fiducials(write("# c\nx,y,z,X,Y,Z,w\n1,2,3,4,5,6,0.5\n"));
  EXPECT_EQ(weighted.weights, std::vector<double>{0.5});
  EXPECT_EQ(weighted.lines, std::vector<std::size_t>{3});
}

TEST_F(PoseFile, WhatIsWrongWithFiducialsIsToldByLine) {
  for (const auto& [text, told] : std::vector<std::pair<std::string, std::string>>{
           {"x,y,z\nx,y,z\n", ":2: 'x' is not a number"},
           {"nan,nan,nan,1,2,3\n", ":1: 'nan' is not finite"},
           {"1;2;3;4;5;6\n", ":1: '1;2;3;4;5;6' is not a number"},
           {"1,2,3,4,5\n", ":1: has fewer than six numbers"},
           {"1,2,3,4,5,6,7,8\n", ":1: has more than seven numbers: '8'"},
           {"1,2,3,4,5,6,0\n", ":1: has a weight that is not above 0"},
           {"1,2,3,4,5,6\n1,2,3,4,5,6,1\n", ":2: has a weight, and lines before it have none"},
           {"1,2,3,4,5,6,1\n1,2,3,4,5,6\n", ":2: has no weight, and lines before it have one"},
           {"x,y,z\n", ": holds no fiducials"}}) {
    EXPECT_CONTAINS(error_of([&] { read_fiducials(write(text)); }), "poses.txt" + told);
  }
}

TEST_F(PoseFile, AMissingFileAndAFolderAreErrors) {
  EXPECT_THROW(read_poses(folder_.path() / "none.txt"), Error);
  EXPECT_THROW(read_poses(folder_.path()), Error);
}

}  // namespace
}  // namespace keepout::app
