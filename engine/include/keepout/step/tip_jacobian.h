// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <concepts>
#include <type_traits>

namespace keepout {

/// A matrix or an expression of Eigen.
template <class Type>
concept EigenExpression = std::derived_from<Type, Eigen::MatrixBase<Type>>;

/// A view of the tip's Jacobian J, dx = J dq: 3 x n, a column for each joint. [length / unit of the
/// joint]
class TipJacobian {
 public:
  /// A matrix of 3 rows, with a column for each joint.
  using Matrix = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  /// A view with any strides.
  using View =
      Eigen::Map<const Matrix, Eigen::Unaligned, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>;

  /// Views any 3 x n matrix of Eigen, fixed or dynamic, by rows or by columns. Also views a block,
  /// a transpose or a map. For a 6 x n Jacobian J, give J.topRows<3>(). The viewed matrix must
  /// outlive the step. The compiler rejects temporaries, expressions that must be computed, and
  /// types with another number of rows. A dynamic matrix with another number of rows makes the step
  /// invalid_input.
  template <class Expression>
  requires EigenExpression<std::remove_cvref_t<Expression>> TipJacobian(Expression&& matrix)
  noexcept : joints_(matrix.rows() == 3 ? matrix.cols() : 0) {
    using Type = std::remove_cvref_t<Expression>;
    constexpr bool may_have_3_rows =
        Type::RowsAtCompileTime == 3 || Type::RowsAtCompileTime == Eigen::Dynamic;
    constexpr bool is_of_doubles = std::same_as<typename Type::Scalar, double>;
    constexpr bool is_there =
        has_memory<Type> && (std::is_lvalue_reference_v<Expression> || !is_matrix<Type>);
    static_assert(
        may_have_3_rows,
        "a tip's Jacobian has 3 rows: of a 6 x n Jacobian give J.topRows<3>(), or the rows "
        "that move the tip");
    static_assert(is_of_doubles,
                  "a tip's Jacobian is of doubles: give the result of J.cast<double>()");
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

  /// Views 3 x `joints` numbers, column by column, which must outlive the step.
  TipJacobian(const double* data, Eigen::Index joints) noexcept : data_(data), joints_(joints) {}

  /// Returns the number of columns; 0 unless there are three rows.
  Eigen::Index joints() const noexcept { return joints_; }
  /// Returns the first number.
  const double* data() const noexcept { return data_; }
  /// Returns true if the numbers are contiguous, column by column.
  bool is_packed() const noexcept {
    return from_row_to_row_ == 1 && (from_column_to_column_ == 3 || joints_ == 1);
  }
  /// Returns J (3, n) as a view.
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
