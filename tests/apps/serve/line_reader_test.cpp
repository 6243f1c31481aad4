// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "serve/service.h"

namespace keepout::app {
namespace {

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
