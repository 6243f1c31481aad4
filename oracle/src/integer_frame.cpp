// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "integer_frame.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace keepout::oracle {
namespace {

/// value = digits * 2^exponent, the digits odd.
struct Binary {
  std::int64_t digits;
  int exponent;
};

Binary binary(double value) {
  int exponent = 0;
  const auto digits = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), 53));
  const int zeros = std::countr_zero(static_cast<std::uint64_t>(digits));
  return {digits / (std::int64_t{1} << zeros), exponent - 53 + zeros};
}

}  // namespace

void IntegerFrame::include(double value) {
  if (value != 0.0) exponent_ = std::min(exponent_, binary(value).exponent);
}

Integer IntegerFrame::integer(double value) const {
  if (value == 0.0) return 0;
  const Binary b = binary(value);
  return Integer(static_cast<long>(b.digits)) << static_cast<unsigned long>(b.exponent - exponent_);
}

}  // namespace keepout::oracle
