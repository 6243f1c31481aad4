// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace keepout::app {

/// How many rows of how many numbers a value may have.
struct TableShape {
  int rank;  // of the value: 0 a number, 1 an array, 2 an array of arrays
  std::size_t fewest_rows;
  std::size_t most_rows;
  std::size_t fewest_columns;
  std::size_t most_columns;
};

/// The numbers of one value of a request, row by row, in memory that is made once. A number is a
/// table of one row and one column, an array one of one row.
class NumberTable {
 public:
  /// `description`: what the value must be, for messages.
  NumberTable(std::string_view name, const TableShape& shape, std::string description);

  std::string_view name() const noexcept { return name_; }
  const std::string& description() const noexcept { return description_; }

  /// Whether there is a value, whole.
  bool is_given() const noexcept { return is_given_; }
  std::size_t rows() const noexcept { return rows_; }
  std::size_t columns() const noexcept { return columns_; }
  std::span<const double> numbers() const noexcept { return numbers_; }

  // A value as it is read, from its beginning to its end. False: it has not the shape.
  void clear() noexcept;
  bool open() noexcept;   // an array begins
  bool close() noexcept;  // an array ends
  bool add(double number) noexcept;

 private:
  bool end_row() noexcept;
  bool finish() noexcept;

  std::string_view name_;
  TableShape shape_;
  std::string description_;
  std::vector<double> numbers_;
  std::size_t rows_ = 0;
  std::size_t columns_ = 0;  // of the first row
  std::size_t row_begin_ = 0;
  int depth_ = 0;
  bool is_given_ = false;
};

}  // namespace keepout::app
