// SPDX-License-Identifier: GPL-3.0-or-later
// Programs of the core, solved by a function of Python.
#pragma once

#include "arrays.hpp"
#include "remanifold/execution.hpp"
#include "remanifold/minimum_chain.hpp"

#include <type_traits>
#include <vector>

namespace remanifold::python {

/// A Python function of the program's arrays and a function that says whether to stop;
/// returns x, or an empty array.
inline ProgramSolver program_solver(const py::object& function,
                                    const Execution& execution) {
  if (function.is_none()) {
    return {};
  }
  return [function = function.ptr(), &execution](const LinearProgram& program) {
    const auto copy = [](const auto& values) {
      using T = typename std::decay_t<decltype(values)>::value_type;
      return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
    };
    std::vector<double> x;
    {
      const py::gil_scoped_acquire acquire;
      const py::cpp_function cancelled([&execution] {
        return execution.progress != nullptr && execution.progress->cancel.load();
      });
      const py::object result = py::handle(function)(
          copy(program.costs), copy(program.upper), copy(program.integral),
          copy(program.row_lower), copy(program.row_upper), copy(program.offsets),
          copy(program.columns), copy(program.values), cancelled);
      x = to_vector(py::cast<InputArray<double>>(result));
    }
    execution.poll();
    return x;
  };
}

}  // namespace remanifold::python
