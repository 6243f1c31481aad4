// SPDX-License-Identifier: BSD-3-Clause
//
// pybind11 answers a call that fits no signature with a list of all signatures and all arguments.
// explained() wraps each function of the module and replaces that message.
#include <pybind11/pybind11.h>

#include "bindings.h"

namespace keepout::python {
namespace {

PyCFunctionWithKeywords pybind_call = nullptr;  // of all functions of pybind11

/// Replaces the message of the current TypeError if it is pybind11's: see _call_errors.py.
void explain(PyObject* args, PyObject* kwargs) {
  py::error_already_set error;  // fetches it
  try {
    const py::module_ words = py::module_::import("keepout._call_errors");
    const py::object text = words.attr("in_our_words")(
        py::str(error.value()), py::reinterpret_borrow<py::tuple>(args),
        kwargs != nullptr ? py::reinterpret_borrow<py::dict>(kwargs) : py::dict());
    if (!text.is_none()) {
      PyErr_SetObject(PyExc_TypeError, text.ptr());
      return;
    }
  } catch (const py::error_already_set&) {
    // Keep the message of pybind11.
  }
  error.restore();
}

/// Returns true if an object of the module has no value, because no constructor was called.
/// pybind11 would create one from uninitialized memory.
bool lacks_its_value(PyObject* object) {
  auto* const base = reinterpret_cast<PyTypeObject*>(py::detail::get_internals().instance_base);
  if (!PyObject_TypeCheck(object, base)) return false;
  const auto* const instance = reinterpret_cast<py::detail::instance*>(object);
  return instance->simple_layout && instance->simple_value_holder[0] == nullptr;
}

bool is_constructor(PyObject* capsule) {
  const void* const record = PyCapsule_GetPointer(capsule, PyCapsule_GetName(capsule));
  return static_cast<const py::detail::function_record*>(record)->is_constructor;
}

PyObject* explained(PyObject* self, PyObject* args, PyObject* kwargs) {
  PyObject* const object = PyTuple_GET_SIZE(args) > 0 ? PyTuple_GET_ITEM(args, 0) : nullptr;
  if (object != nullptr && lacks_its_value(object) && !is_constructor(self)) {
    PyErr_Format(PyExc_TypeError, "%s: call __init__ first; in a subclass, super().__init__(...)",
                 Py_TYPE(object)->tp_name);
    return nullptr;
  }
  PyObject* const result = pybind_call(self, args, kwargs);
  if (result == nullptr && PyErr_ExceptionMatches(PyExc_TypeError)) explain(args, kwargs);
  return result;
}

/// Wraps a function of pybind11, or the functions of a property, with explained().
void explain_errors_of(py::handle member) {
  if (PyObject_TypeCheck(member.ptr(), &PyProperty_Type)) {
    for (const char* const part : {"fget", "fset"}) explain_errors_of(member.attr(part));
    return;
  }
  PyObject* function = member.ptr();
  py::object of_static;
  if (PyInstanceMethod_Check(function)) {
    function = PyInstanceMethod_GET_FUNCTION(function);
  } else if (Py_TYPE(function) == &PyStaticMethod_Type) {
    of_static = member.attr("__func__");
    function = of_static.ptr();
  }
  if (!PyCFunction_Check(function) || !PyCapsule_CheckExact(PyCFunction_GET_SELF(function))) return;
  PyMethodDef& method = *reinterpret_cast<PyCFunctionObject*>(function)->m_ml;
  const auto call =
      reinterpret_cast<PyCFunctionWithKeywords>(reinterpret_cast<void (*)()>(method.ml_meth));
  if (call == explained) return;
  pybind_call = call;
  method.ml_meth = reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(explained));
}

}  // namespace

void explain_call_errors(py::module_& module) {
  for (const auto& [name, member] : module.attr("__dict__").cast<py::dict>()) {
    if (!PyType_Check(member.ptr())) {
      explain_errors_of(member);
      continue;
    }
    for (const py::handle item : member.attr("__dict__").attr("values")()) explain_errors_of(item);
  }
}

}  // namespace keepout::python
