// SPDX-License-Identifier: BSD-3-Clause
// What a plot draws, as numbers: which points and which ticks. How it draws them is in plot.cpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "report/plot.h"

namespace keepout::app {

std::vector<PlotPoint> thin_out(std::span<const PlotPoint> points, double low, double high,
                                std::size_t columns) {
  const auto column = [&](const PlotPoint& p) {
    const double part = std::clamp((p.x - low) / (high - low), 0.0, 1.0);
    return static_cast<std::size_t>(part * static_cast<double>(columns));
  };
  std::vector<PlotPoint> result;
  for (std::size_t begin = 0; begin < points.size();) {
    std::size_t end = begin, lowest = begin, highest = begin;
    for (; end < points.size() && column(points[end]) == column(points[begin]); ++end) {
      if (points[end].y < points[lowest].y) lowest = end;
      if (points[end].y > points[highest].y) highest = end;
    }
    std::array kept = {begin, std::min(lowest, highest), std::max(lowest, highest), end - 1};
    const auto last = std::unique(kept.begin(), kept.end());
    for (auto i = kept.begin(); i != last; ++i) result.push_back(points[*i]);
    begin = end;
  }
  return result;
}

std::vector<double> linear_ticks(double low, double high, int wanted) {
  if (!(high > low)) return {low};
  const double rough = (high - low) / static_cast<double>(wanted);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * power;
  for (const double round : {5.0, 2.0, 1.0}) {
    if (round * power >= rough) step = round * power;
  }
  std::vector<double> ticks;
  const double slack = 1e-9 * step;  // a tick at the very end must not fall to rounding
  for (double k = std::ceil((low - slack) / step); k * step <= high + slack; k += 1.0) {
    ticks.push_back(k * step);
  }
  return ticks;
}

std::vector<double> logarithmic_ticks(double low, double high) {
  std::vector<double> ticks;
  const int first = static_cast<int>(std::floor(std::log10(low)));
  const int last = static_cast<int>(std::ceil(std::log10(high)));
  const bool dense = high / low < 100.0;
  constexpr int most = 8;  // numbers that fit below an axis
  const int every = std::max(1, (last - first + most - 1) / most);
  for (int power = first; power <= last; ++power) {
    if (power % every != 0) continue;
    for (const double times : {1.0, 2.0, 5.0}) {
      if (times > 1.0 && !dense) continue;
      const double tick = times * std::pow(10.0, power);
      if (tick >= low * (1.0 - 1e-9) && tick <= high * (1.0 + 1e-9)) ticks.push_back(tick);
    }
  }
  return ticks;
}

std::string tick_text(double value) {
  char text[32];
  const double size = std::abs(value);
  if (size >= 1e4) {
    std::snprintf(text, sizeof text, size >= 1e6 ? "%.6gM" : "%.6gk",
                  value / (size >= 1e6 ? 1e6 : 1e3));
    return text;
  }
  if (size < 0.9e-4 && size > 1e-300) {
    const int power = static_cast<int>(std::floor(std::log10(size) + 1e-9));
    const double times = value / std::pow(10.0, power);
    std::snprintf(text, sizeof text, "%.3g·", times);
    std::string result = times > 0.999999 && times < 1.000001 ? "10⁻" : std::string(text) + "10⁻";
    for (const char digit : std::to_string(-power)) {
      static constexpr std::array<const char*, 10> raised = {"⁰", "¹", "²", "³", "⁴",
                                                             "⁵", "⁶", "⁷", "⁸", "⁹"};
      result += raised[static_cast<std::size_t>(digit - '0')];
    }
    return result;
  }
  std::snprintf(text, sizeof text, "%.6g", size == 0.0 ? 0.0 : value);
  return text;
}

}  // namespace keepout::app
