# SPDX-License-Identifier: BSD-3-Clause
"""Replaces pybind11's list of signatures by one sentence: which argument of a call does not fit."""

from __future__ import annotations

import ast
import difflib
import os
import re
from typing import Any

_HEAD = re.compile(r"(\w+)\(\): incompatible (function|constructor) arguments\.")
_SIGNATURE = re.compile(r"^ {4}\d+\. (?:[\w.]+)?(\(.*\))(?: -> .*)?$", re.M)
_CLASS = re.compile(r"^ {4}1\. keepout\.(?:_core\.)?(\w+)\(", re.M)
_ITEMS = {"str": "strings", "float": "numbers", "int": "whole numbers"}
_WORDS = {
    "bool": "True or False",
    "float": "a number",
    "int": "a whole number",
    "os.PathLike": "the path of a file",
    "str": "a string",
}
_LISTS = ("iterable", "list", "sequence")


def in_our_words(message: str, args: tuple[Any, ...], kwargs: dict[str, Any]) -> str | None:
    """Returns one sentence on why a call does not fit the signatures in pybind11's message. Returns None for any other
    message."""
    head = _HEAD.match(message)
    if not head:
        return None
    name = head[1]
    if head[2] == "constructor":
        name = _CLASS.search(message)[1]  # type: ignore[index]
        args = args[1:]  # without the object under construction
    calls = [_Call(name, text) for text in _SIGNATURE.findall(message.partition("\nInvoked with: ")[0])]
    fitting = [call for call in calls if not call.misfit_of_names(args, kwargs)]
    if len(calls) > 1 and len(fitting) != 1:
        got = ", ".join([*map(_got, args), *(f"{key}={_got(value)}" for key, value in kwargs.items())])
        return f"{name}: expected {' or '.join(map(str, calls))}, got {name}({got})"
    call = fitting[0] if fitting else calls[0]
    return call.misfit_of_names(args, kwargs) or call.misfit_of_values(args, kwargs)


class _Call:
    """A signature of a function."""

    def __init__(self, name: str, signature: str):
        self.name = name
        arguments = ast.parse(f"def f{signature}: ...").body[0].args  # type: ignore[attr-defined]
        positional = arguments.posonlyargs + arguments.args
        self.positional = [argument.arg for argument in positional]
        self.types = {argument.arg: argument.annotation for argument in positional + arguments.kwonlyargs}
        self.takes_any_name = arguments.kwarg is not None
        defaults = [None] * (len(positional) - len(arguments.defaults)) + arguments.defaults + arguments.kw_defaults
        self.defaults = {name: default for name, default in zip(self.types, defaults) if default is not None}

    def __str__(self) -> str:
        words = []
        for name in self.types:
            if name == "self":
                continue
            if name not in self.positional and "*" not in words:
                words.append("*")
            words.append(f"{name}={ast.unparse(self.defaults[name])}" if name in self.defaults else name)
        if self.takes_any_name:
            words.append("**options")
        return f"{self.name}({', '.join(words)})"

    def misfit_of_names(self, args: tuple[Any, ...], kwargs: dict[str, Any]) -> str | None:
        """Returns what is wrong with the number of arguments or with a name; None if nothing is."""
        methods = self.positional[:1] == ["self"]
        if len(args) > len(self.positional):
            count = len(self.positional) - methods
            most = {0: "no argument", 1: "one argument"}.get(count, f"{count} arguments")
            return f"{self.name} takes {most} by position, got {len(args) - methods}: call {self}"
        given = self.positional[: len(args)]
        for name in kwargs:
            if name in given:
                return f"{self.name} got its argument '{name}' twice, by position and by name"
            if name not in self.types and not self.takes_any_name:
                known = [known for known in self.types if known != "self"]
                meant = difflib.get_close_matches(name, known, 1)
                hint = f"; did you mean '{meant[0]}'?" if meant else ";"
                return f"{self.name} has no argument '{name}'{hint} known: {', '.join(known) or 'none'}"
        for name in self.types:
            if name not in given and name not in kwargs and name not in self.defaults:
                return f"{self.name} lacks its argument '{name}': call {self}"
        return None

    def misfit_of_values(self, args: tuple[Any, ...], kwargs: dict[str, Any]) -> str:
        """Returns which value is of the wrong type. Precondition: misfit_of_names() found nothing."""
        values = dict(zip(self.positional, args)) | {k: v for k, v in kwargs.items() if k in self.types}
        for name, value in values.items():
            if misfit := _misfit(self.types[name], value, name):
                return f"{self.name}: {misfit}"
        for name, value in values.items():
            if ast.unparse(self.types[name]) == "int" and not 0 <= value < 2**31:
                return f"{self.name}: {name}: {value} is out of range"
        return f"{self.name}: expected {self}, got arguments of other types"


def _parts(type_: ast.expr) -> tuple[str, list[ast.expr]]:
    """Returns the name of a type in lower case, and the types in its brackets."""
    if not isinstance(type_, ast.Subscript):
        return ast.unparse(type_).lower().rpartition(".")[2], []
    inner = type_.slice.elts if isinstance(type_.slice, ast.Tuple) else [type_.slice]
    return ast.unparse(type_.value).lower().rpartition(".")[2], inner


def _ours(text: str) -> Any:
    """Returns the class of keepout that a type names, or None."""
    from . import _core

    match = re.fullmatch(r"keepout\.(?:_core\.)?(\w+)", text)
    return getattr(_core, match[1], None) if match else None


def _expected(type_: ast.expr) -> str:
    outer, inner = _parts(type_)
    if outer == "optional":
        return f"{_expected(inner[0])} or None"
    if outer == "union":
        return " or ".join(map(_expected, inner))
    if outer == "tuple":
        return f"a tuple of {len(inner)}"
    if outer in _LISTS:
        item = ast.unparse(inner[0]) if inner else ""
        return "a list" + (f" of {_ITEMS.get(item, _plain(item))}" if item else "")
    text = ast.unparse(type_)
    return _WORDS.get(text) or (f"a {_plain(text)}" if _ours(text) else _plain(text))


def _plain(text: str) -> str:
    return text.replace("keepout._core.", "keepout.")


def _got(value: Any) -> str:
    """Returns a value if it is short, or else its type."""
    if value is None or isinstance(value, (bool, int, float)):
        return repr(value)
    if isinstance(value, str):
        return repr(value if len(value) < 60 else value[:57] + "...")
    kind = type(value)
    return kind.__name__ if kind.__module__ == "builtins" else f"{kind.__module__}.{kind.__qualname__}"


def _is_list(value: Any) -> bool:
    return not isinstance(value, (str, bytes, dict)) and hasattr(value, "__len__") and hasattr(value, "__getitem__")


def _may_be_number(value: Any) -> bool:
    """Returns False for booleans, and for arrays of booleans or text: float() takes these, too."""
    kind = getattr(getattr(value, "dtype", None), "kind", None)
    return not isinstance(value, bool) and (not isinstance(kind, str) or kind in "fiu")


def _fits(type_: ast.expr, value: Any) -> bool:
    """Returns False only for a value that pybind11 does not take for the type."""
    outer, inner = _parts(type_)
    if outer == "optional":
        return value is None or _fits(inner[0], value)
    if outer == "union":
        return any(_fits(one, value) for one in inner)
    if outer == "tuple":
        return _is_list(value) and len(value) == len(inner) and all(map(_fits, inner, value))
    if outer == "iterable":
        return hasattr(value, "__iter__")
    if outer in _LISTS:
        return _is_list(value) and all(_fits(inner[0], item) for item in value)
    text = ast.unparse(type_)
    if text == "float":
        has_value = hasattr(value, "__float__") or hasattr(value, "__index__")
        return has_value and not isinstance(value, (str, bytes)) and _may_be_number(value)
    if text == "int":
        return hasattr(value, "__index__") and _may_be_number(value)
    if text == "str":
        return isinstance(value, (str, bytes))
    if text == "bool":
        return value is None or hasattr(value, "__bool__")
    if text == "os.PathLike":
        return isinstance(value, (str, bytes, os.PathLike))
    ours = _ours(text)
    return ours is None or isinstance(value, ours)


def _misfit(type_: ast.expr, value: Any, name: str) -> str | None:
    """Returns what is wrong with a value, or with an item of it; None if it fits."""
    if _fits(type_, value):
        return None
    outer, inner = _parts(type_)
    if outer in ("list", "sequence") and _is_list(value):
        for number, item in enumerate(value):
            if misfit := _misfit(inner[0], item, f"{name}[{number}]"):
                return misfit
    if outer == "tuple" and _is_list(value) and len(value) == len(inner):
        for number, (one, item) in enumerate(zip(inner, value)):
            if misfit := _misfit(one, item, f"{name}[{number}]"):
                return misfit
    return f"{name}: expected {_expected(type_)}, got {_got(value)}"
