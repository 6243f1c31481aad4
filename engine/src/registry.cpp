// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/registry.h"

#include <algorithm>
#include <string>
#include <vector>

namespace keepout {
namespace {

// A shorter piece is part of too many names.
constexpr std::size_t shortest_piece = 3;

/// Returns a word in lower case with '-' for '_', so that similar words compare as equal.
std::string folded(std::string_view word) {
  std::string text(word);
  for (char& letter : text) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
    if (letter == '_') letter = '-';
  }
  return text;
}

/// Returns the number of letters to insert, delete, replace or swap with a neighbor to turn one
/// word into the other (optimal string alignment).
std::size_t edit_distance(const std::string& a, const std::string& b) {
  // Rows of the table: from the first i letters of `a` to the first j letters of `b`.
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t exchanged = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, exchanged});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last.swap(last);
    last.swap(row);
  }
  return last.back();
}

}  // namespace

std::optional<std::string_view> nearest_name(std::string_view mistyped,
                                             std::span<const std::string_view> names) {
  std::optional<std::string_view> nearest;
  std::size_t fewest = 0;
  const std::string typed = folded(mistyped);
  for (const std::string_view name : names) {
    const std::size_t edits = edit_distance(typed, folded(name));
    if (edits > std::max(mistyped.size(), name.size()) / 3) continue;
    if (nearest && edits >= fewest) continue;
    nearest = name;
    fewest = edits;
  }
  if (nearest || mistyped.size() < shortest_piece) return nearest;
  const auto has_piece = [&](std::string_view name) {
    return folded(name).find(typed) != std::string::npos;
  };
  const auto found = std::find_if(names.begin(), names.end(), has_piece);
  return found == names.end() ? nearest : *found;
}

void refuse_name(std::string_view name, std::span<const std::string_view> known,
                 std::string_view what, std::span<const PeerPart> absent) {
  std::string list;
  for (const std::string_view one : known) list.append(list.empty() ? "" : ", ").append(one);
  const std::string named = std::string(what) + " '" + std::string(name) + "'";
  std::vector<std::string_view> names(known.begin(), known.end());
  for (const PeerPart& part : absent) {
    if (part.name == name) {
      throw Error(named + " is not here: it needs " + std::string(part.needs) +
                  "; if the module is elsewhere, name its folder in the environment variable "
                  "KEEPOUT_MODULES; there are: " +
                  list);
    }
    names.push_back(part.name);
  }
  const auto meant = nearest_name(name, names);
  const std::string hint = meant ? "; did you mean '" + std::string(*meant) + "'?" : ";";
  throw Error("there is no " + named + hint + " known: " + list);
}

}  // namespace keepout
