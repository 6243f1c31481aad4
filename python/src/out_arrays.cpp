// SPDX-License-Identifier: BSD-3-Clause
#include "out_arrays.h"

#include <algorithm>
#include <functional>

#include "arguments.h"

namespace keepout::python {
namespace {

bool share_memory(const py::array& a, const py::array& b) {
  // Without gaps both are, so that the ranges tell.
  const auto* const a_begin = static_cast<const char*>(a.data());
  const auto* const b_begin = static_cast<const char*>(b.data());
  const std::less<const char*> before;
  return before(a_begin, b_begin + b.nbytes()) && before(b_begin, a_begin + a.nbytes());
}

/// The arrays of one `out`, checked one after another.
class Checked {
 public:
  Checked(const py::object& out, const std::vector<py::array>& inputs)
      : out_(out), taken_(inputs) {}

  template <class T>
  T* take(const char* name, const std::vector<py::ssize_t>& shape) {
    const std::string argument = std::string("out.") + name;
    const py::object value = py::getattr(out_, name, py::none());
    std::string extents;
    for (const py::ssize_t extent : shape) {
      extents += (extents.empty() ? "" : ", ") + std::to_string(extent);
    }
    const std::string dtype = py::str(py::dtype::of<T>()).template cast<std::string>();
    const std::string wanted = dtype + " of shape (" + extents + (shape.size() == 1 ? ",)" : ")");
    if (!py::isinstance<py::array_t<T>>(value)) {
      const bool is_array = py::isinstance<py::array>(value);
      refuse(argument, "an array of " + wanted,
             is_array ? "dtype " + py::str(value.attr("dtype")).template cast<std::string>()
                      : std::string(Py_TYPE(value.ptr())->tp_name));
    }
    auto array = py::reinterpret_borrow<py::array>(value);
    const bool fits = static_cast<std::size_t>(array.ndim()) == shape.size() &&
                      std::equal(shape.begin(), shape.end(), array.shape());
    if (!fits) refuse(argument, "an array of " + wanted, "shape " + shape_text(array));
    constexpr int needed = int{py::array::c_style} | int{py::detail::npy_api::NPY_ARRAY_ALIGNED_};
    if ((array.flags() & needed) != needed) {
      refuse(argument, "an array without gaps, row by row (C-contiguous)", "one with strides");
    }
    if (!array.writeable()) refuse(argument, "an array to write to", "a read-only one");
    for (const py::array& other : taken_) {
      if (share_memory(array, other)) {
        refuse(argument, "memory of its own", "an array that shares it with another or an input");
      }
    }
    taken_.push_back(array);
    return static_cast<T*>(array.mutable_data());
  }

 private:
  const py::object& out_;
  std::vector<py::array> taken_;
};

/// A new result of a class of keepout._results.
template <class... Sizes>
py::object empty(const char* type, Sizes... sizes) {
  return py::module_::import("keepout._results").attr(type).attr("empty")(sizes...);
}

}  // namespace

StepColumns steps_columns(const py::object& out, py::ssize_t poses,
                          const std::vector<py::array>& inputs) {
  const py::object result = out.is_none() ? empty("Steps", poses) : out;
  Checked arrays(result, inputs);
  return {result, arrays.take<double>("motion", {poses, 3}),
          arrays.take<std::uint8_t>("status", {poses}),
          arrays.take<std::uint32_t>("planes", {poses})};
}

StepColumns simulation_columns(const py::object& out, py::ssize_t loops, py::ssize_t cycles,
                               const std::vector<py::array>& inputs) {
  const py::object result = out.is_none() ? empty("Simulation", loops, cycles) : out;
  Checked arrays(result, inputs);
  return {result, arrays.take<double>("tips", {loops, cycles + 1, 3}),
          arrays.take<std::uint8_t>("status", {loops, cycles}),
          arrays.take<std::uint32_t>("planes", {loops, cycles})};
}

}  // namespace keepout::python
