# SPDX-License-Identifier: BSD-3-Clause
"""Writes the stubs of the built module, with its docstrings: write_stubs.py OUT,
with PYTHONPATH at the module."""

import ast
import inspect
import re
import sys
from pathlib import Path

import keepout
from keepout import _results

HEADER = """\
# SPDX-License-Identifier: BSD-3-Clause
# Written by python/stubs/write_stubs.py from the built module.
{}
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
    "CrtkSession.guard": "MotionConstraint | InstrumentGuard",
    "CrtkSession.mesh_unit": 'Literal["m", "mm"]',
    "CrtkSession.robot_unit": 'Literal["m", "mm"]',
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
    "CrtkSession.status": "str",
    "CrtkSession.step_status": "Status",
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


def body(text):
    """Returns what follows the colon of a stub: its docstring, or dots."""
    return "\n" + text if text else " ...\n"


def docstring(text, indent):
    """Returns a docstring as a stub has it; empty if there is no text."""
    lines = inspect.cleandoc(text or "").replace("\\", r"\\").replace('"""', r"\"\"\"").splitlines()
    if not lines:
        return ""
    if lines[-1].endswith('"'):  # it would join the quotes that end the docstring
        lines[-1] = lines[-1][:-1] + r"\""
    quoted = f'"""{lines[0]}"""' if len(lines) == 1 else "\n".join([f'"""{lines[0]}', *lines[1:], '"""'])
    return "".join((indent + line).rstrip() + "\n" for line in quoted.splitlines())


def function(line, description, owner, indent, decorators):
    """Returns the stub of a function from its line in a docstring and the description below it. `owner`: its class, or
    "keepout"."""
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
    signature = f"{indent}def {made.name}({ast.unparse(arguments)}) -> {result}:"
    return "".join(f"{indent}@{name}\n" for name in decorators) + signature + \
        body(docstring(description, indent + "    "))


def functions(doc, owner, indent="    ", decorators=()):
    """Returns the stub of a function, or several if it is overloaded."""
    first, _, text = doc.partition("\n")
    # After "Overloaded function.": pairs of a line such as "1. step(...)" and the text of this overload.
    _, *overloads = re.split(r"^\d+\. (?=\w+\()(.*)$", text, flags=re.MULTILINE)
    if overloads:
        return "".join(function(line, text, owner, indent, ("overload", *decorators))
                       for line, text in zip(overloads[::2], overloads[1::2]))
    return function(first, text, owner, indent, decorators)


def prop(owner, name, type_, options):
    """Returns the stub of a property. Its type comes from its getter, an option, or "float64" in its docstring. A
    former name has the type of its present name."""
    doc = vars(type_)[name].__doc__ or ""
    former = re.match(r"Deprecated: use (\w+)\.", doc)
    typed = former[1] if former else name
    member = vars(type_)[typed]
    signature = re.search(r"-> (.*)", member.fget.__doc__ or "")
    text = signature[1] if signature else options[typed]
    if text == "numpy.ndarray":
        text = f"NDArray[np.{re.search(r'float64|uint32', member.__doc__)[0]}]"
    # The docstring of an option begins with its name, for help().
    doc = docstring(doc.removeprefix(f"{name}: "), "        ")
    return f"    @property\n    def {name}(self) -> {type_of(text, RESULTS, owner, typed)}:" + body(doc)


def class_of(owner, type_, options):
    """Returns the stub of a class, with its base class if that is part of keepout."""
    base = type_.__mro__[1]
    lines = ""
    for name, member in vars(type_).items():
        if isinstance(member, property):
            lines += prop(owner, name, type_, options)
        elif name in ("__init__", "__len__") or not name.startswith("_"):
            doc = getattr(type_, name).__doc__
            if doc.startswith(f"{name}("):
                static = ("staticmethod",) if isinstance(member, staticmethod) else ()
                lines += functions(doc, owner, decorators=static)
    bases = f"({base.__name__})" if base.__name__ in keepout.__all__ or base is ValueError else ""
    return f"class {owner}{bases}:" + body(docstring(vars(type_).get("__doc__"), "    ") + lines)


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
    Path(out).write_text(HEADER.format(docstring(keepout.__doc__, "")) + imported + text, encoding="utf-8")


main(*sys.argv[1:])
