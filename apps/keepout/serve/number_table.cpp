// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "serve/number_table.h"

#include <utility>

namespace keepout::app {

NumberTable::NumberTable(std::string_view name, const TableShape& shape, std::string description)
    : name_(name), shape_(shape), description_(std::move(description)) {
  numbers_.reserve(shape.most_rows * shape.most_columns);
}

void NumberTable::clear() noexcept {
  numbers_.clear();
  rows_ = columns_ = row_begin_ = 0;
  depth_ = 0;
  is_given_ = false;
}

bool NumberTable::open() noexcept {
  if (is_given_ || depth_ == shape_.rank) return false;
  ++depth_;
  return true;
}

bool NumberTable::add(double number) noexcept {
  if (is_given_ || depth_ != shape_.rank) return false;
  if (rows_ == shape_.most_rows || numbers_.size() - row_begin_ == shape_.most_columns) {
    return false;
  }
  numbers_.push_back(number);
  return shape_.rank > 0 || (end_row() && finish());
}

bool NumberTable::close() noexcept {
  if (depth_ == shape_.rank && !end_row()) return false;
  --depth_;
  return depth_ > 0 || finish();
}

bool NumberTable::end_row() noexcept {
  const std::size_t length = numbers_.size() - row_begin_;
  if (rows_ == shape_.most_rows || length < shape_.fewest_columns) return false;
  if (rows_ == 0) columns_ = length;
  row_begin_ = numbers_.size();
  ++rows_;
  return length == columns_;
}

bool NumberTable::finish() noexcept {
  is_given_ = rows_ >= shape_.fewest_rows;
  return is_given_;
}

}  // namespace keepout::app
