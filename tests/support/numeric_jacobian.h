#pragma once

#include <Eigen/Core>

namespace waymark::test {

/// d f / d x at x = 0 by central differences of fourth order: f(±h), f(±2h). With h = 1e-3 its own
/// error is about 1e-12 of f's fifth derivative, and rounding 1e-13 of f's value over h.
template <int Rows, int Columns, typename Function>
Eigen::Matrix<double, Rows, Columns> numeric_jacobian(const Function& f, double h = 1e-3) {
  Eigen::Matrix<double, Rows, Columns> j;
  for (int column = 0; column < Columns; ++column) {
    const auto at = [&](double steps) -> Eigen::Matrix<double, Rows, 1> {
      Eigen::Matrix<double, Columns, 1> x = Eigen::Matrix<double, Columns, 1>::Zero();
      x[column] = steps * h;
      return f(x);
    };
    j.col(column) = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h);
  }
  return j;
}

}  // namespace waymark::test
