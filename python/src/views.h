// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <span>
#include <utility>
#include <vector>

namespace keepout::python {

namespace py = pybind11;

/// A read-only array over memory that `owner` keeps: no copy, and the owner lives as long as any
/// view does.
template <class T>
py::array view(const T* data, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
               py::handle owner) {
  py::array array(py::dtype::of<T>(), std::move(shape), std::move(strides), data, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// The same of a list of numbers.
template <class T>
py::array view(const std::vector<T>& values, py::handle owner) {
  return view(values.data(), {static_cast<py::ssize_t>(values.size())}, {sizeof(T)}, owner);
}

/// The same of `width` numbers of each item of a list, (n, width), or (n,) for a single one, which
/// `first_of` an item finds.
template <class Item, class FirstOf>
py::array view(std::span<const Item> items, py::ssize_t width, const FirstOf& first_of,
               py::handle owner) {
  static const Item none{};  // of an empty list no number is read, but an address is
  const auto* const first = first_of(items.empty() ? none : items.front());
  const auto size = static_cast<py::ssize_t>(items.size());
  if (width == 1) return view(first, {size}, {sizeof(Item)}, owner);
  return view(first, {size, width}, {sizeof(Item), sizeof(*first)}, owner);
}

/// Adds such a view of a list that a class of Python has.
template <class Class, class Holder, class Item, class FirstOf>
void add_view(Class& type, const char* name, std::vector<Item> Holder::*items, py::ssize_t width,
              const FirstOf& first_of, const char* doc) {
  type.def_property_readonly(
      name,
      [items, width, first_of](const py::object& self) {
        return view(std::span<const Item>(self.cast<const Holder&>().*items), width, first_of,
                    self);
      },
      doc);
}

}  // namespace keepout::python
