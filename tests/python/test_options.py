# SPDX-License-Identifier: BSD-3-Clause
"""Every option of the tables is in every interface, by the same name."""

import ast
import json
import os
import sys
from pathlib import Path

import pytest
from surfaces import run

import keepout

command = os.environ.get("KEEPOUT_COMMAND")
needs_command = pytest.mark.skipif(not command, reason="the command was not built")
stubs = ast.parse((Path(keepout.__file__).parent / "__init__.pyi").read_text())
tables = keepout.options()
of_all = [pytest.param(name, option, id=f"{name}.{option.name}") for name in tables for option in tables[name]]
of_command = [o for o in tables["MotionConstraint"] if o.command and not o.type == "str"]
of_requests = [o for o in tables["InstrumentGuard"] if o.is_changeable]


def other_value(option):
    """Returns a valid value of an option that is not its default."""
    if option.choices:
        return next(name for name in option.choices if name != option.default)
    if option.type == "bool":
        return not option.default
    return option.default + 1 if option.type == "int" else 1.25 * option.default + 0.001


def made(mesh, name, **options):
    if name == "MotionConstraint":
        return keepout.MotionConstraint(mesh, **options)
    return keepout.InstrumentGuard(mesh, keepout.free_ball(1.0), **options)


def test_there_are_options():
    assert len(tables["MotionConstraint"]) >= 19 and len(tables["InstrumentGuard"]) >= 15


@pytest.mark.parametrize("name, option", of_all)
def test_python_takes_it_and_has_it(mesh, name, option):
    assert getattr(made(mesh, name), option.name) == option.default
    assert f"{option.name}: {option.description}" in getattr(keepout, name).__doc__
    if option.type == "str":
        return  # a name of a part, which not every other part allows
    value = other_value(option)
    assert getattr(made(mesh, name, **{option.name: value}), option.name) == value
    with pytest.raises(keepout.Error, match=f"{option.name}: expected {option.range}, got"):
        made(mesh, name, **{option.name: -1})
    if option.is_changeable:
        room = {"nodes": 1} if option.name == "nodes" else {}
        guard = made(mesh, name, **room)
        guard.set_options(**{option.name: value})
        assert getattr(guard, option.name) == value


@pytest.mark.parametrize("name, option", of_all)
def test_the_stubs_have_it(name, option):
    members = {m.name: m for c in stubs.body if getattr(c, "name", "") == name for m in c.body if hasattr(m, "name")}
    keywords = {a.arg: d for a, d in zip(members["__init__"].args.kwonlyargs, members["__init__"].args.kw_defaults)}
    assert ast.literal_eval(keywords[option.name]) == option.default
    changes = [a.arg for a in members["set_options"].args.kwonlyargs]
    assert (option.name in changes) == option.is_changeable
    assert ast.unparse(members[option.name].returns).replace('"', "'") == option.type


def test_the_page_of_options_has_them():
    page = Path(__file__).parents[2] / "docs" / "options.py"
    run(sys.executable, page, "--check")


@needs_command
def test_the_help_of_the_command_has_them():
    for name in ("replay", "simulate", "serve"):
        words = run(command, name, "--help").split()
        assert [o.name for o in of_command if f"--{o.command}" not in words] == []
        text = " ".join(words)
        assert [o.name for o in of_command if " ".join(o.description.split()) not in text] == []
    words = [word.rstrip(".,") for word in run(command, "serve", "--help").split()]
    assert [o.name for o in of_requests if o.name not in words] == []


@needs_command
@pytest.mark.parametrize("option", of_command, ids=lambda o: o.name)
def test_the_command_and_serve_take_those_of_a_tip(option):
    value = other_value(option)
    answer = run(command, "serve", "cube", f"--{option.command}", json.dumps(value).strip('"'), input='{"do":"info"}\n')
    assert json.loads(answer)["settings"][option.name] == value


@needs_command
@pytest.mark.parametrize("option", of_requests, ids=lambda o: o.name)
def test_serve_takes_those_of_an_instrument(option):
    request = {"do": "instrument", "urdf": "none", "capsules": [[0] * 9], option.name: other_value(option)}
    wrong = request | {option.name: []}
    answers = run(command, "serve", "cube", input=json.dumps(request) + "\n" + json.dumps(wrong) + "\n").splitlines()
    assert json.loads(answers[0])["error"]["kind"] == "no_instrument"
    assert json.loads(answers[1])["error"]["message"] == f"'{option.name}' must be {option.range}"


@needs_command
def test_info_of_serve_has_those_of_a_tip():
    settings = json.loads(run(command, "serve", "cube", input='{"do":"info"}\n'))["settings"]
    assert [o.name for o in tables["MotionConstraint"] if o.name not in settings] == []
