// SPDX-License-Identifier: BSD-3-Clause
// Lines that are broken in every way at hand: each is answered once, by what it is, and moves
// nothing unless it is a request.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "apps/serve/judged_service.h"

namespace keepout::test {
namespace {

constexpr std::size_t longest_line = 600;

#if defined(__SANITIZE_ADDRESS__)
constexpr std::size_t enough = 10'000;  // lines
#else
constexpr std::size_t enough = 100'000;
#endif

class Garbler {
 public:
  explicit Garbler(std::mt19937_64& random) : random_(random) {}

  /// A request, or what is left of one.
  std::string line() {
    std::string text = request();
    const std::size_t changes = below(2) == 0 ? 0 : 1 + below(4);
    for (std::size_t i = 0; i < changes; ++i) change(text);
    return text;
  }

 private:
  std::size_t below(std::size_t end) { return random_() % end; }
  template <std::size_t n>
  std::string_view any(const std::array<std::string_view, n>& of) {
    return of[below(n)];
  }

  std::string number() {
    static constexpr std::array<std::string_view, 22> odd{
        "0",      "-0",      "-0.0",  "1e999",
        "-1e999", "1e-999",  "NaN",   "Infinity",
        "null",   "true",    "\"1\"", "[]",
        "{}",     "1e30",    "1e31",  "123456789012345678901234567890",
        "01",     "1.5e3",   "+1",    "1.",
        "-",      "4.9e-324"};
    if (below(100) == 0) return std::string(any(odd));
    std::array<char, 32> text;
    const double value = std::uniform_real_distribution<double>(-1.0, 1.0)(random_);
    std::snprintf(text.data(), text.size(), "%.17g", value * size_);
    return text.data();
  }

  /// In a wrong number now and then.
  std::string array(std::size_t count) {
    if (below(100) == 0) count = below(9);
    std::string text = "[";
    for (std::size_t i = 0; i < count; ++i) text += (i > 0 ? "," : "") + number();
    return text + "]";
  }
  std::string matrix(std::size_t rows, std::size_t columns) {
    std::string text = "[";
    for (std::size_t i = 0; i < rows; ++i) text += (i > 0 ? "," : "") + array(columns);
    return text + "]";
  }
  std::string tip() { return size_ = 6.0, array(3); }
  std::string increment() { return size_ = 1.2, array(3); }

  std::string request() {
    static constexpr std::array<std::string_view, 8> ids{
        "1", "\"a\"", "null", "-5", "1.5", "\"\\u0000\\\"\"", "[1]", "18446744073709551615"};
    std::string text = "{\"id\":" + std::string(any(ids));
    const std::size_t kind = below(14);
    if (kind < 4) {
      text += ",\"do\":\"step\",\"tip\":" + tip() + ",\"desired\":" + increment();
      const std::size_t joints = 1 + below(7);
      if (kind == 1) text += ",\"jacobian\":" + matrix(3, joints);
      if (kind < 3) {
        const std::size_t rows = below(4);
        text += ",\"rows\":" + matrix(rows, kind == 1 ? joints : 3) + ",\"bounds\":" + array(rows);
      }
    } else if (kind == 4) {
      text += ",\"do\":\"steps\",\"motions\":" + (size_ = 6.0, matrix(below(5), 6));
    } else if (kind < 7) {
      text += ",\"do\":\"polytope\",\"tip\":" + tip() + ",\"radius\":" + (size_ = 2.0, number());
    } else if (kind == 12 && below(3) == 0) {
      text += ",\"do\":\"instrument\",\"urdf\":\"" KEEPOUT_ROBOTS "/psm.urdf\",\"capsules\":" +
              std::string(below(2) == 0 ? "[[5,9.1,0,0,6,0,10.2,0,1]]" : matrix(below(3), 9));
    } else if (kind >= 12) {
      const bool has_twist = below(2) == 0;
      text += ",\"do\":\"joint_step\",\"q\":" + (size_ = 3.0, array(6));
      text += has_twist ? ",\"linear\":" + increment() : ",\"increment\":" + array(6);
    } else {
      static constexpr std::array<std::string_view, 4> others{"info", "ping", "ping", "fly"};
      text += ",\"do\":\"" + std::string(any(others)) + "\"";
    }
    return text + "}";
  }

  void change(std::string& text) {
    static constexpr std::array<std::string_view, 24> tokens{"{",
                                                             "}",
                                                             "[",
                                                             "]",
                                                             ",",
                                                             ":",
                                                             "\"",
                                                             "\\",
                                                             "\n",
                                                             "\r",
                                                             "\r\n",
                                                             "\xff",
                                                             "\xc3\xa9",
                                                             "\xef\xbb\xbf",
                                                             "\"tip\":",
                                                             "\"do\":",
                                                             "NaN",
                                                             "-0",
                                                             "\"id\":",
                                                             "\"x\":1,",
                                                             "\\ud800",
                                                             "[[[[[[[[[[[[",
                                                             "{\"a\":{\"b\":",
                                                             "1e400"};
    const std::size_t at = below(text.size() + 1);
    switch (below(8)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text.erase(at, 1 + below(6));
        break;
      case 2:
        text.insert(at, any(tokens));
        break;
      case 3:
        text.insert(at, text.substr(below(text.size() + 1), below(40)));
        break;
      case 4:
        text.resize(at);
        break;
      case 5:
        text.insert(at, 1, '\0');
        break;
      case 6:
        if (below(20) == 0) text.insert(at, std::string(below(3 * longest_line), ' '));
        break;
      default:
        for (std::size_t i = below(20); i > 0; --i) text += static_cast<char>(below(256));
    }
  }

  std::mt19937_64& random_;
  double size_ = 1.0;  // of the numbers to come
};

TEST(ServeFuzz, EveryGarbledLineIsAnsweredOnceAndMovesNothing) {
  std::mt19937_64 random(20260728);
  Garbler garbler(random);
  JudgedService service(longest_line);
  while (service.lines() < enough) {
    std::string bytes;
    for (std::size_t lines = 1 + random() % 60; lines > 0; --lines) {
      bytes += garbler.line() + (random() % 8 == 0 ? "\r\n" : "\n");
    }
    const std::string fault = service.converse(bytes, random);
    ASSERT_TRUE(fault.empty()) << fault;
  }
  // It is worth something only if both kinds of line are there.
  EXPECT_GT(service.refusals(), service.lines() / 4);
  EXPECT_LT(service.refusals(), 3 * service.lines() / 4);
#if KEEPOUT_HAS_URDF
  EXPECT_GT(service.joint_steps(), service.lines() / 500);
#endif
}

TEST(ServeFuzz, BytesThatAreNoTextAreAnsweredOnceALine) {
  std::mt19937_64 random(7);
  JudgedService service(longest_line);
  while (service.lines() < enough / 5) {
    std::string bytes(random() % 4000, '\0');
    for (char& c : bytes) c = random() % 40 == 0 ? '\n' : static_cast<char>(random() % 256);
    const std::string fault = service.converse(bytes, random);
    ASSERT_TRUE(fault.empty()) << fault;
  }
  EXPECT_EQ(service.refusals(), service.lines());
}

}  // namespace
}  // namespace keepout::test
