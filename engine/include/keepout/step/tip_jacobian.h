// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <concepts>
#include <type_traits>

namespace keepout {

/// A matrix or an expression of Eigen's.
template <class Type>
concept EigenExpression = std::derived_from<Type, Eigen::MatrixBase<Type>>;

/// A view of the tip's Jacobian J, dx = J dq: 3 x n, a column for each joint. [length / unit of the
/// joint]
class TipJacobian {
 public:
  /// 3 rows, a column for each joint.
  using Matrix = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  /// Of numbers that may be any strides apart.
  using View =
      Eigen::Map<const Matrix, Eigen::Unaligned, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>;

  /// Of any 3 x n matrix of Eigen's, fixed or dynamic, row by row or column by column, and of a
  /// block, a transpose or a map of one: of a 6 x n Jacobian, its topRows<3>(). What is viewed must
  /// outlive the step; a matrix that has no name, or is yet to be computed, is refused by the
  /// compiler, and so is one of another number of rows where the type tells. A dynamic one of other
  /// than 3 rows makes the step invalid_input.
  template <class Expression>
  requires EigenExpression<std::remove_cvref_t<Expression>> TipJacobian(Expression&& matrix)
  noexcept : joints_(matrix.rows() == 3 ? matrix.cols() : 0) {
    using Type = std::remove_cvref_t<Expression>;
    constexpr bool may_have_3_rows =
        Type::RowsAtCompileTime == 3 || Type::RowsAtCompileTime == Eigen::Dynamic;
    constexpr bool is_of_doubles = std::same_as<typename Type::Scalar, double>;
    constexpr bool is_there =
        has_memory<Type> && (std::is_lvalue_reference_v<Expression> || !is_matrix<Type>);
    static_assert(may_have_3_rows,
                  "a tip's Jacobian has 3 rows: of a 6 x n one give J.topRows<3>(), or whichever "
                  "rows move the tip");
    static_assert(is_of_doubles,
                  "a tip's Jacobian is of doubles: give a matrix made by J.cast<double>()");
    static_assert(
        is_there,
        "a tip's Jacobian is viewed, not copied: give the result a name that outlives the "
        "step, as in const Eigen::Matrix<double, 3, 7> jacobian = ...");
    if constexpr (may_have_3_rows && is_of_doubles && is_there) {
      data_ = matrix.data();
      from_row_to_row_ = matrix.rowStride();
      from_column_to_column_ = matrix.colStride();
    }
  }

  /// `data`: 3 `joints` numbers, column by column, which must outlive the step.
  TipJacobian(const double* data, Eigen::Index joints) noexcept : data_(data), joints_(joints) {}

  /// How many columns there are; 0 where there are not three rows.
  Eigen::Index joints() const noexcept { return joints_; }
  /// The first of its numbers.
  const double* data() const noexcept { return data_; }
  /// Whether its numbers follow one another, column by column.
  bool is_packed() const noexcept {
    return from_row_to_row_ == 1 && (from_column_to_column_ == 3 || joints_ == 1);
  }
  /// J (3, n), as a view.
  View matrix() const noexcept {
    return {data_, 3, joints_, {from_column_to_column_, from_row_to_row_}};
  }

 private:
  template <class Type>
  static constexpr bool has_memory = (int{Eigen::internal::traits<Type>::Flags} &
                                      Eigen::DirectAccessBit) != 0;
  template <class Type>
  static constexpr bool is_matrix = std::derived_from<Type, Eigen::PlainObjectBase<Type>>;

  const double* data_ = nullptr;
  Eigen::Index from_row_to_row_ = 1;
  Eigen::Index from_column_to_column_ = 3;
  Eigen::Index joints_;
};

}  // namespace keepout
