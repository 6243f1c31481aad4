# SPDX-License-Identifier: BSD-3-Clause
"""Writes the stubs of the built module from the signatures that pybind11 puts into docstrings: write_stubs.py OUT,
with PYTHONPATH at the module."""

import ast
import re
import sys
from pathlib import Path

import keepout
from keepout import _results

HEADER = """\
# SPDX-License-Identifier: BSD-3-Clause
# Shapes, units and failures are in the docstrings of the module: help(keepout.MotionConstraint).
from collections.abc import Sequence
from os import PathLike
from typing import Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

"""

# The types that C++ takes as objects, lists, tuples or names and checks itself. ARGUMENTS: by function and argument,
# else by argument. RESULTS: by class and member, else by member. Any other object is an array.
JOINT_KIND = 'Literal["revolute", "prismatic"]'
SPACE = 'Literal["RAS", "LPS"] | None'
ARGUMENTS = {
    "convention": 'Literal["modified", "standard"]',
    "kind": JOINT_KIND,
    "mesh": "Mesh",
    "place.pose": "ArrayLike | None",
    "Body.points": "Sequence[tuple[int, ArrayLike]]",
    "remote_center.from_": "tuple[int, ArrayLike]",
    "remote_center.to": "tuple[int, ArrayLike]",
    "set_guides.guides": "Sequence[Guide | str]",
    "step.rows": "tuple[ArrayLike, ArrayLike] | None",
    "simulate.out": "Simulation | None",
    "out": "Steps | None",
    "space": SPACE,
    "unit": 'Literal["m", "cm", "mm", "um", "in"] | None',
    "untagged": SPACE,
}
RESULTS = {
    "Body.points": "list[tuple[int, tuple[float, float, float]]]",
    "Inspection.places": "dict[str, NDArray[np.float64]]",
    "Guide.kind": 'Literal["point", "axis", "shaft"]',
    "InstrumentStep.degraded": "tuple[tuple[int, int, float | None], ...]",
    "activations": "list[Part]",
    "high": "tuple[float, float, float]",
    "indices": "list[Part]",
    "kind": JOINT_KIND,
    "limits": "tuple[str, ...]",
    "low": "tuple[float, float, float]",
    "mesh": "Mesh",
    "narrow_phases": "list[Part]",
    "options": "dict[str, list[Option]]",
    "proofs": "Proofs",
    "relaxation": 'Literal["none", "guides", "recovery"]',
    "replay": "Steps",
    "simulate": "Simulation",
    "solvers": "list[Part]",
    "space": SPACE,
    "status": "Status",
    "steps": "Steps",
}


def type_of(text, known, owner, name, sequence="list"):
    """Returns a pybind11 type as the stubs name it. Raises SystemExit for a type without information."""
    if text not in ("bool", "float", "int") and (found := known.get(f"{owner}.{name}", known.get(name))):
        return found
    text = re.sub(r"keepout\.(_core\.)?", "", text)
    text = re.sub(r"Optional\[(.*)\]", r"\1 | None", text)
    text = text.replace("List[", f"{sequence}[").replace("Tuple[", "tuple[").replace("numpy.ndarray[numpy.", "NDArray[np.")
    text = re.sub(r"os\.PathLike\b(?!\[)", "str | PathLike[str]", text).replace("os.", "")
    if known is ARGUMENTS:
        text = re.sub(r"\bobject\b", "ArrayLike", text)
    if re.search(r"\b(object|list|tuple|dict|Iterable|ndarray)\b(?!\[)", text):
        sys.exit(f"write_stubs: unknown type {text} of {owner}.{name}; add it to ARGUMENTS or RESULTS")
    return text


def function(line, owner, indent, decorators):
    """Returns the stub of a function from its line of a docstring. `owner`: its class, or "keepout"."""
    made = ast.parse(f"def {line}: ...").body[0]
    arguments = made.args
    scope = owner if made.name == "__init__" else made.name
    for argument in [*arguments.args, *arguments.kwonlyargs]:
        if argument.arg == "self":
            argument.annotation = None
            continue
        text = type_of(ast.unparse(argument.annotation), ARGUMENTS, scope, argument.arg, "Sequence")
        argument.annotation = ast.Name(text)
    for group, defaults in ((arguments.args, arguments.defaults), (arguments.kwonlyargs, arguments.kw_defaults)):
        for argument, default in zip(reversed(group), reversed(defaults)):
            if isinstance(default, ast.Constant) and default.value is None and "None" not in argument.annotation.id:
                argument.annotation.id += " | None"
    result = type_of(ast.unparse(made.returns), RESULTS, owner, made.name)
    return "".join(f"{indent}@{name}\n" for name in decorators) + \
        f"{indent}def {made.name}({ast.unparse(arguments)}) -> {result}: ...\n"


def functions(doc, owner, indent="    ", decorators=()):
    """Returns the stub of a function, or several if it is overloaded."""
    first, *rest = doc.splitlines()
    overloads = [line.split(" ", 1)[1] for line in rest if re.match(r"\d+\. \w+\(", line)]
    if overloads:
        return "".join(function(line, owner, indent, ("overload", *decorators)) for line in overloads)
    return function(first, owner, indent, decorators)


def prop(owner, name, member, options):
    """Returns the stub of a property. Its type comes from its getter, an option, or "float64" in its docstring."""
    signature = re.search(r"-> (.*)", member.fget.__doc__ or "")
    text = signature[1] if signature else options[name]
    if text == "numpy.ndarray":
        text = f"NDArray[np.{re.search(r'float64|uint32', member.__doc__)[0]}]"
    return f"    @property\n    def {name}(self) -> {type_of(text, RESULTS, owner, name)}: ...\n"


def class_of(owner, type_, options):
    """Returns the stub of a class, with its base class if that is part of keepout."""
    base = type_.__mro__[1]
    lines = ""
    for name, member in vars(type_).items():
        if isinstance(member, property):
            former = re.match(r"Deprecated: use (\w+)\.", member.__doc__ or "")
            present = former[1] if former else name
            lines += prop(owner, present, vars(type_)[present], options).replace(f"def {present}(", f"def {name}(")
        elif name in ("__init__", "__len__") or not name.startswith("_"):
            doc = getattr(type_, name).__doc__
            if doc.startswith(f"{name}("):
                static = ("staticmethod",) if isinstance(member, staticmethod) else ()
                lines += functions(doc, owner, decorators=static)
    bases = f"({base.__name__})" if base.__name__ in keepout.__all__ or base is ValueError else ""
    return f"class {owner}{bases}:\n{lines or '    ...' + chr(10)}"


def main(out):
    options = {owner: {o.name: o.type for o in of} for owner, of in keepout.options().items()}
    names = ", ".join(f'"{name}"' for name in keepout.__all__)
    imported, text = "", f"\n__all__ = [{names}]\n\n__version__: str\n"
    for name in keepout.__all__:
        member = getattr(keepout, name)
        if hasattr(_results, name):
            imported += f"from ._results import {name} as {name}\n"
        elif isinstance(member, type):
            text += "\n" + class_of(name, member, options.get(name, {}))
        elif callable(member):
            text += "\n" + functions(member.__doc__, "keepout", "")
    Path(out).write_text(HEADER + imported + text, encoding="utf-8")


main(*sys.argv[1:])
