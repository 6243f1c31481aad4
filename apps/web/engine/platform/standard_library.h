// SPDX-License-Identifier: BSD-3-Clause
//
// The parts of C++20 that keepout uses and emscripten's libc++ 13 lacks. The compiler includes this
// header before each source, so that the sources need not depend on it. Nothing here is more than
// keepout asks for.
#pragma once

#include <version>

#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 14000

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <type_traits>

namespace std {

template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  static_assert(sizeof(To) == sizeof(From));
  return __builtin_bit_cast(To, from);
}

template <class T>
requires is_unbounded_array_v<T> unique_ptr<T> make_unique_for_overwrite(size_t count) {
  return unique_ptr<T>(new remove_extent_t<T>[count]);
}

/// There is one thread, so each access is atomic.
template <class T>
class atomic_ref {
 public:
  explicit atomic_ref(T& value) noexcept : value_(value) {}
  template <class Order>
  T fetch_add(T more, Order) const noexcept {
    const T before = value_;
    value_ = before + more;
    return before;
  }
  template <class Order>
  void store(T value, Order) const noexcept {
    value_ = value;
  }

 private:
  T& value_;
};

/// A thread that is waited for.
class jthread : public thread {
 public:
  using thread::thread;
  jthread(jthread&&) noexcept = default;
  ~jthread() {
    if (joinable()) join();
  }
};

/// The number nearest to a numeral, as strtod finds it, which takes more for a numeral than this
/// may.
template <class Number>
requires is_floating_point_v<Number> from_chars_result from_chars(const char* first,
                                                                  const char* last, Number& value) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const string_view text(first, static_cast<size_t>(last - first));
  const size_t sign = text.starts_with('-') ? 1 : 0;
  size_t end = sign;
  size_t digits = 0;
  for (bool has_point = false; end < text.size(); ++end) {
    if (is_digit(text[end])) {
      ++digits;
    } else if (text[end] == '.' && !has_point) {
      has_point = true;
    } else {
      break;
    }
  }
  if (digits == 0) {
    // Accepts infinity and NaN, in upper or lower case.
    end = text.size();
    if (sign == end || (text[sign] | 0x20) < 'i' || (text[sign] | 0x20) > 'n') {
      return {first, errc::invalid_argument};
    }
  } else if (end < text.size() && (text[end] | 0x20) == 'e') {
    size_t exponent = end + 1;
    if (exponent < text.size() && (text[exponent] == '-' || text[exponent] == '+')) ++exponent;
    if (exponent < text.size() && is_digit(text[exponent])) {
      end = std::find_if_not(text.begin() + exponent, text.end(), is_digit) - text.begin();
    }
  }
  const string numeral(text.substr(0, end));
  char* behind = nullptr;
  errno = 0;
  Number read;
  if constexpr (is_same_v<Number, float>) {
    read = strtof(numeral.c_str(), &behind);
  } else {
    read = strtod(numeral.c_str(), &behind);
  }
  const size_t length = static_cast<size_t>(behind - numeral.c_str());
  if (length == 0) return {first, errc::invalid_argument};
  // A subnormal result is not an error, but underflow to zero is.
  const bool is_lost = errno == ERANGE && (isinf(read) || read == Number(0));
  if (is_lost) return {first + length, errc::result_out_of_range};
  value = read;
  return {first + length, errc{}};
}

/// The shortest text that reads back as the number.
inline to_chars_result to_chars(char* first, char* last, double value) {
  string shortest(32, ' ');
  for (int digits = 1; digits <= 17; ++digits) {
    string text(32, ' ');
    text.resize(static_cast<size_t>(snprintf(text.data(), 32, "%.*g", digits, value)));
    if (strtod(text.c_str(), nullptr) == value && text.size() <= shortest.size()) shortest = text;
  }
  if (static_cast<ptrdiff_t>(shortest.size()) > last - first) return {last, errc::value_too_large};
  return {std::copy(shortest.begin(), shortest.end(), first), errc{}};
}

namespace ranges {

template <class Range, class Predicate>
constexpr bool all_of(Range&& range, Predicate holds) {
  return std::all_of(std::begin(range), std::end(range), holds);
}

template <class One, class Other, class Same = std::equal_to<>>
constexpr bool equal(One&& one, Other&& other, Same same = {}) {
  return std::equal(std::begin(one), std::end(one), std::begin(other), std::end(other), same);
}

template <class Range, class Value>
constexpr auto find(Range&& range, const Value& value) {
  return std::find(std::begin(range), std::end(range), value);
}

template <class Range, class Value, class Of>
constexpr auto find(Range&& range, const Value& value, Of of) {
  return std::find_if(std::begin(range), std::end(range),
                      [&](const auto& item) { return std::invoke(of, item) == value; });
}

}  // namespace ranges
}  // namespace std

#endif
