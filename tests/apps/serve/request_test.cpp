// SPDX-License-Identifier: BSD-3-Clause
#include "serve/request.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "messages.h"
#include "serve/answer.h"
#include "serve/service.h"

namespace keepout::app {
namespace {

class RequestLine : public testing::Test {
 protected:
  /// The id, the kind of error and its message.
  std::string outcome(std::string_view line) {
    try {
      read_request(line, request_);
    } catch (const Refusal& refusal) {
      return request_.id + " " + std::string(refusal.kind) + ": " + refusal.message;
    }
    return request_.id + " none";
  }
  bool is_read(std::string_view line) { return outcome(line).ends_with(" none"); }
  const Request& request() const { return request_; }

  Request request_{{.joints = 4, .rows = 2, .motions = 3}};
};

TEST_F(RequestLine, AStepHasATipAndADesiredIncrement) {
  ASSERT_TRUE(is_read(R"( { "desired" : [4,5.5,-6e0] , "do":"step", "tip":[1,2,3], "id":9 } )"));
  EXPECT_EQ(request().verb, Verb::step);
  EXPECT_EQ(request().id, "9");
  EXPECT_EQ(request().table("tip").numbers, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(request().table("desired").numbers, (std::vector<double>{4, 5.5, -6}));
  EXPECT_FALSE(request().table("jacobian").is_given);
  EXPECT_FALSE(request().table("rows").is_given);
}

TEST_F(RequestLine, NothingIsLeftOfTheRequestBefore) {
  ASSERT_TRUE(
      is_read(R"({"id":1,"do":"step","tip":[1,2,3],"desired":[0,0,0],"jacobian":[[1],[2],[3]]})"));
  EXPECT_TRUE(request().table("jacobian").is_given);
  ASSERT_TRUE(is_read(R"({"do":"step","tip":[1,2,3],"desired":[0,0,0]})"));
  EXPECT_FALSE(request().table("jacobian").is_given);
  EXPECT_EQ(request().table("jacobian").columns, 0u);
  EXPECT_EQ(request().id, "null");
  EXPECT_FALSE(is_read(R"({"do":"step","desired":[0,0,0]})"));
  EXPECT_FALSE(is_read(R"({"tip":[1,2,3],"desired":[0,0,0]})"));
}

TEST_F(RequestLine, RowsAndBoundsFitTheJacobianOrTheTip) {
  const std::string step = R"({"do":"step","tip":[1,2,3],"desired":[0,0,0],)";
  const std::string joints = R"("jacobian":[[1,2,3,4],[5,6,7,8],[9,10,11,12]])";
  ASSERT_TRUE(is_read(step + joints + R"(,"rows":[[1,2,3,4],[5,6,7,8]],"bounds":[-1,-2]})"));
  EXPECT_EQ(request().table("jacobian").columns, 4u);
  EXPECT_EQ(request().table("rows").rows, 2u);
  EXPECT_EQ(request().table("bounds").numbers, (std::vector<double>{-1, -2}));
  EXPECT_TRUE(is_read(step + R"("rows":[[1,2,3]],"bounds":[0]})"));
  EXPECT_TRUE(is_read(step + R"("rows":[],"bounds":[]})"));
  for (const char* wrong : {R"("rows":[[1,2,3]]})",
                            R"("bounds":[1]})",
                            R"("rows":[[1,2,3]],"bounds":[]})",
                            R"("rows":[[1,2,3]],"bounds":[1,2]})",
                            R"("rows":[[1,2,3,4]],"bounds":[1]})",
                            R"("rows":[[1,2]],"bounds":[1]})",
                            R"("rows":[1,2,3],"bounds":[1]})",
                            R"("rows":[[]],"bounds":[1]})",
                            R"("rows":[[1,2,3],[1,2]],"bounds":[1,2]})",
                            R"("rows":[[1,2,3],[1,2,3],[1,2,3]],"bounds":[1,2,3]})",
                            R"("jacobian":[[1],[2],[3]],"rows":[[1,2,3]],"bounds":[1]})",
                            R"("jacobian":[]})",
                            R"("jacobian":[[1,2],[3,4]]})",
                            R"("jacobian":[[],[],[]]})",
                            R"("jacobian":[[1,2,3,4,5],[1,2,3,4,5],[1,2,3,4,5]]})",
                            R"("jacobian":[[1],[2],[3],[4]]})",
                            R"("jacobian":[[1],[2],3]})",
                            R"("jacobian":[[1],[2],[[3]]]})",
                            R"("jacobian":{}})",
                            R"("jacobian":[[1],[2],[3]],"radius":1})",
                            R"("radius":1})"}) {
    EXPECT_FALSE(is_read(step + wrong)) << wrong;
  }
}

TEST_F(RequestLine, AnInstrumentHasAFileAndCapsulesAndItsStepOneKindOfMotion) {
  const std::string file = R"({"do":"instrument","urdf":"a.urdf","capsules":)";
  ASSERT_TRUE(is_read(file + R"([[0,1,2,3,4,5,6,7,8]],"tip_link":"t","margin":0.5})"));
  EXPECT_EQ(request().text("urdf").text, "a.urdf");
  EXPECT_EQ(request().text("tip_link").text, "t");
  EXPECT_FALSE(request().text("base_link").is_given);
  EXPECT_EQ(request().table("capsules").columns, 9u);
  EXPECT_TRUE(is_read(R"({"do":"joint_step","q":[1,2],"linear":[0,0,1],"angular":[0,0,1]})"));
  EXPECT_EQ(request().text("urdf").text, "") << "of the request before";
  EXPECT_TRUE(is_read(R"({"do":"joint_step","q":[1],"increment":[1],"weights":[1]})"));
  for (const std::string& wrong :
       {file + "[]}", file + "[[0,1,2,3,4,5,6,7]]}", file + "[[0,1,2,3,4,5,6,7,8]],\"tip\":\"t\"}",
        file + "[[0,1,2,3,4,5,6,7,8]],\"base_link\":7}",
        file + "[[0,1,2,3,4,5,6,7,8]],\"frame\":[[1,0,0,0],[0,1,0,0],[0,0,1,0]]}",
        std::string(R"({"do":"instrument","capsules":[[0,1,2,3,4,5,6,7,8]]})"),
        std::string(R"({"do":"ping","urdf":"a.urdf"})"),
        std::string(R"({"do":"joint_step","q":[1]})"),
        std::string(R"({"do":"joint_step","q":[],"increment":[1]})"),
        std::string(R"({"do":"joint_step","q":[1,2,3,4,5,6,7,8,9],"increment":[1]})"),
        std::string(R"({"do":"joint_step","q":[1],"increment":[1],"linear":[0,0,1]})"),
        std::string(R"({"do":"joint_step","q":[1],"linear":[0,0,1],"weights":[1]})")}) {
    EXPECT_FALSE(is_read(wrong)) << wrong;
  }
}

TEST_F(RequestLine, AMessageNamesWhatIsWrong) {
  const std::vector<std::pair<std::string_view, std::string_view>> table{
      {R"({"id":1,"do":"step","tip":[1,2]})", "'tip' must be an array of three numbers"},
      {R"({"id":1,"do":"step","tip":[1,2,3,4]})", "'tip' must be an array of three numbers"},
      {R"({"id":1,"do":"step","tip":[1,[2],3]})", "'tip' must be"},
      {R"({"id":1,"do":"step","tip":[1,"2",3]})", "'tip' must be"},
      {R"({"id":1,"do":"step","tip":[1,null,3]})", "'tip' must be"},
      {R"({"id":1,"do":"step","tip":[1,true,3]})", "'tip' must be"},
      {R"({"id":1,"do":"step","tip":null})", "'tip' must be"},
      {R"({"id":1,"do":"step","tip":{"x":1}})", "'tip' must be"},
      {R"({"id":1,"do":"step","tip":1})", "'tip' must be"},
      {R"({"id":1,"do":"polytope","tip":[1,2,3],"radius":[1]})", "'radius' must be a number"},
      {R"({"id":1,"do":"polytope","tip":[1,2,3]})", "'radius' is missing"},
      {R"({"id":1,"do":"step","tip":[1,2,3]})", "'desired' is missing"},
      {R"({"id":1,"do":"steps"})", "'motions' is missing"},
      {R"({"id":1,"do":"steps","motions":[[1,2,3,4,5]]})", "arrays of six numbers"},
      {R"({"id":1,"do":"steps","motions":[[1,2,3,4,5,6],[1,2,3,4,5,6],[1,2,3,4,5,6],[1,2,3,4,5,6]]})",
       "at most 3 of them"},
      {R"({"id":1})", "'do' is missing"},
      {R"({"id":1,"do":7})", "'do' must be one of 'step'"},
      {R"({"id":1,"do":["step"]})", "'do' must be one of"},
      {R"({"id":1,"do":"Step"})", "'Step'"},
      {R"({"id":1,"do":"ping","Tip":[1]})", "no key 'Tip'"},
      {R"({"id":1,"do":"ping","\u0007\u00e9":1})", "no key '?"},
      {R"({"id":1,"do":"ping","tip":[1,2,3]})", "'tip' is nothing that 'ping' takes"},
      {R"({"id":1,"do":"ping","do":"ping"})", "'do' is given twice"},
      {R"({"id":1,"id":1,"do":"ping"})", "'id' is given twice"},
      {R"({"id":1,"do":"step","tip":[1,2,3],"tip":[1,2,3]})", "'tip' is given twice"},
  };
  for (const auto& [line, message] : table) {
    const std::string told = outcome(line);
    EXPECT_TRUE(told.starts_with("1 not_a_request: ")) << line << '\n' << told;
    EXPECT_CONTAINS(told, message) << line;
  }
}

TEST_F(RequestLine, WhatIsNotJsonIsTold) {
  for (const char* line : {"{",
                           "}",
                           "{}}",
                           "x",
                           "{\"id\":1,}",
                           "{\"do\":ping}",
                           "{'do':'ping'}",
                           "{\"do\":\"ping\"} {}",
                           "{\"tip\":[1,2,NaN]}",
                           "{\"tip\":[1,2,Infinity]}",
                           "{\"tip\":[1,2,-Infinity]}",
                           "{\"tip\":[1,2,1e999]}",
                           "{\"tip\":[1,2,0x10]}",
                           "{\"tip\":[1,2,01]}",
                           "{\"tip\":[1,2,+1]}",
                           "{\"tip\":[1,2,.5]}",
                           "{\"tip\":[1,2,5.]}",
                           "{\"tip\":[1,,2]}",
                           "{\"tip\":[1,2,3}",
                           "// comment",
                           "{\"do\":\"\xff\"}",
                           "{\"do\":\"\xc0\x80\"}",
                           "{\"do\":\"\xed\xa0\x80\"}",
                           "{\"do\":\"\\ud800\"}",
                           "{\"do\":\"a\tb\"}",
                           "\xff\xfe{\"do\":\"ping\"}"}) {
    const std::string told = outcome(line);
    EXPECT_CONTAINS(told, "not_json: the line is not JSON: ") << line;
    for (const char c : told) EXPECT_TRUE(c >= ' ' && c <= '~') << line;
  }
  for (const std::string_view nul :
       {std::string_view("{\"do\":\"ping\"}\0", 14), std::string_view("{\"do\":\0\"ping\"}", 14)}) {
    EXPECT_TRUE(outcome(nul).starts_with("null not_json: ")) << outcome(nul);
  }
}

TEST_F(RequestLine, OtherJsonThanAnObjectIsTold) {
  for (const char* line : {"[]", "7", "null", "true", "\"step\"", "1.5", "-3", "[[1,2],{\"id\":3}]",
                           "[{\"id\":3,\"do\":\"ping\"}]"}) {
    EXPECT_TRUE(outcome(line).starts_with("null not_a_request: a request is one object")) << line;
  }
}

TEST_F(RequestLine, DeepNestingEndsTheReading) {
  for (const char* open : {"[", "{\"tip\":", "{\"x\":[", "{\"id\":["}) {
    std::string line;
    for (int i = 0; i < 100'000; ++i) line += open;
    EXPECT_FALSE(is_read(line));
  }
}

TEST_F(RequestLine, AnIdIsEchoedAsTheSameValueOrRefused) {
  const std::vector<std::pair<std::string, std::string>> table{
      {"0", "0"},
      {"-7", "-7"},
      {"18446744073709551615", "18446744073709551615"},
      {"-9223372036854775808", "-9223372036854775808"},
      {"null", "null"},
      {R"("")", R"("")"},
      {R"("a\"\\\/\n\u0000\u00e9")", "\"a\\\"\\\\/\\u000a\\u0000\u00e9\""},
      {'"' + std::string(128, 'x') + '"', '"' + std::string(128, 'x') + '"'}};
  for (const auto& [id, echo] : table) {
    EXPECT_EQ(outcome("{\"id\":" + id + ",\"do\":\"ping\"}"), echo + " none");
    EXPECT_TRUE(
        outcome("{\"do\":\"fly\",\"tip\":7,\"id\":" + id + "}").starts_with(echo + " not_a"));
    EXPECT_TRUE(outcome("{\"id\":" + id + ",\"tip\":[").starts_with(echo + " not_json"));
  }
  for (const std::string& id : {std::string("1.5"), std::string("18446744073709551616"),
                                std::string("true"), std::string("[1]"), std::string("{\"id\":1}"),
                                std::string("1e2"), '"' + std::string(129, 'x') + '"'}) {
    EXPECT_TRUE(
        outcome("{\"id\":" + id + ",\"do\":\"ping\"}").starts_with("null not_a_request: 'id' must"))
        << id << outcome("{\"id\":" + id + ",\"do\":\"ping\"}");
  }
}

TEST_F(RequestLine, NumbersAreTheNearestDoubles) {
  const std::vector<std::pair<std::string, double>> table{
      {"0.1", 0.1},
      {"1e-320", 1e-320},
      {"1e-999", 0.0},
      {"-0", -0.0},
      {"-0.0", -0.0},
      {"9007199254740993", 9007199254740992.0},
      {"18446744073709551617", 18446744073709551616.0},
      {"123456789012345678901234567890", 123456789012345678901234567890.0},
      {"1.7976931348623157e308", 1.7976931348623157e308},
      {"2.2250738585072011e-308", 2.2250738585072011e-308}};
  for (const auto& [text, value] : table) {
    ASSERT_TRUE(is_read("{\"do\":\"polytope\",\"tip\":[0,0,0],\"radius\":" + text + "}")) << text;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(request().table("radius").numbers[0]),
              std::bit_cast<std::uint64_t>(value))
        << text;
  }
}

TEST_F(RequestLine, NumbersWrittenReadBackBitForBit) {
  std::uint64_t bits = 0x9E3779B97F4A7C15u;
  for (int i = 0; i < 20'000; ++i) {
    bits = bits * 6364136223846793005u + 1442695040888963407u;
    const auto value = i == 0 ? -0.0 : std::bit_cast<double>(bits);
    if (!std::isfinite(value)) continue;
    std::string line = "{\"do\":\"polytope\",\"tip\":[0,0,0],\"radius\":";
    append_number(line, value);
    ASSERT_TRUE(is_read(line + "}")) << line;
    ASSERT_EQ(std::bit_cast<std::uint64_t>(request().table("radius").numbers[0]),
              std::bit_cast<std::uint64_t>(value));
  }
}

/// What a reader makes of bytes that come in pieces of one size; "!" for a line too long.
std::vector<std::string> lines(std::string_view bytes, std::size_t piece, std::size_t longest = 8) {
  LineReader reader(longest);
  std::vector<std::string> all;
  const auto take = [&] {
    while (const auto line = reader.next()) all.emplace_back(line->is_too_long ? "!" : line->text);
  };
  while (!bytes.empty()) {
    const std::span<char> room = reader.room();
    EXPECT_FALSE(room.empty());
    const std::size_t count = std::min({piece, room.size(), bytes.size()});
    std::copy_n(bytes.begin(), count, room.begin());
    bytes.remove_prefix(count);
    reader.added(count);
    take();
  }
  reader.ended();
  take();
  return all;
}

using Lines = std::vector<std::string>;

TEST(LineReader, LinesDoNotDependOnThePiecesTheyComeIn) {
  for (std::size_t piece = 1; piece < 64; ++piece) {
    EXPECT_EQ(lines("one\ntwo\r\n\n\r\n12345678\n12345678\r\n123456789\nafter\n", piece),
              (Lines{"one", "two", "", "", "12345678", "12345678", "!", "after"}))
        << piece;
  }
}

TEST(LineReader, ALineTooLongIsToldOfOnceHoweverLongItIs) {
  for (const std::size_t length : {9, 10, 11, 12, 20, 21, 1000}) {
    for (const char* end : {"\n", "\r\n"}) {
      const std::string text = std::string(length, 'x') + end + "ok\n";
      for (const std::size_t piece : {1, 2, 3, 7, 10, 64, 2000}) {
        EXPECT_EQ(lines(text, piece), (Lines{"!", "ok"})) << length << ' ' << piece;
      }
    }
  }
}

TEST(LineReader, WhatIsLeftAtTheEndIsALine) {
  for (std::size_t piece = 1; piece < 16; ++piece) {
    EXPECT_EQ(lines("a\nb", piece), (Lines{"a", "b"}));
    EXPECT_EQ(lines("a\nb\r", piece), (Lines{"a", "b"}));
    EXPECT_EQ(lines("a\n", piece), (Lines{"a"}));
    EXPECT_EQ(lines("", piece), Lines{});
    EXPECT_EQ(lines("12345678", piece), (Lines{"12345678"}));
    EXPECT_EQ(lines("1234567890123", piece), (Lines{"!"}));
    EXPECT_EQ(lines("1234567890", piece), (Lines{"!"}));
    EXPECT_EQ(lines("12345678901234567890", piece), (Lines{"!"}));
  }
}

TEST(LineReader, ACarriageReturnWithinALineAndANulAreOfTheLine) {
  EXPECT_EQ(lines("a\rb\n", 2), (Lines{"a\rb"}));
  EXPECT_EQ(lines("a\r\r\n", 2), (Lines{"a\r"}));
  EXPECT_EQ(lines(std::string_view("a\0b\n", 4), 2), (Lines{std::string("a\0b", 3)}));
}

}  // namespace
}  // namespace keepout::app
