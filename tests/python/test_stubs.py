# SPDX-License-Identifier: BSD-3-Clause
"""Tests that the stubs describe the module."""

import ast
import inspect
import os
import sys
from pathlib import Path

import pytest
from surfaces import run

import keepout

package = Path(keepout.__file__).parent


def run_mypy(folder, *arguments):
    pytest.importorskip("mypy")
    run(sys.executable, "-m", *arguments, cwd=folder, env={**os.environ, "MYPYPATH": str(package.parent)})


def test_stubtest(tmp_path):
    made_by_others = (
        "ConvexTool Guide GuideState Hits Inspection InstrumentStep MotionProof Planes Polytope Region "
        "RigidFit Step"
    )
    allowed = [
        # pybind11 adds its own metaclass, and an __init__ to classes without a constructor.
        r"keepout\.(Body|Chain|CrtkSession|Index|Instrument|InstrumentGuard|Joint|Mesh|MotionConstraint|TableRow|"
        + made_by_others.replace(" ", "|") + ")",
        r"keepout\.(" + made_by_others.replace(" ", "|") + r")\.__init__",
        r"keepout\._results\.NamedTuple",  # a function in Python 3.11, which mypy 1.0 does not know
    ]
    (tmp_path / "allowed").write_text("\n".join(allowed))
    run_mypy(tmp_path, "mypy.stubtest", "keepout", "--allowlist", "allowed")


use = """
from typing import Any

import numpy as np
import keepout

mesh = keepout.Mesh(np.zeros((3, 3)), [[0, 1, 2]])
guard = keepout.MotionConstraint(mesh, index=keepout.Index(mesh), margin=0.2, query="sphere", tool=None)
guard.set_guides(["ball:0,0,0:1", keepout.Guide.point("a", keepout.Region.ball((0, 0, 0), 1))])
step = guard.step((0, 0, 1), np.zeros(3), rows=([[1, 0, 0]], [0]))
status: keepout.Status = step.status
distance: float | None = step.distance
kept: float = guard.tool_radius + guard.margin
length = float(np.linalg.norm(step.motion)) + step.planes.offsets.sum()
steps = guard.steps(np.zeros((4, 3)), np.zeros((4, 3)), threads=2, out=keepout.Steps.empty(4))
chain = keepout.Chain([keepout.Joint("turn", axis=(0, 1, 0))], base=np.eye(4))
instrument = keepout.Instrument(chain, [keepout.Body("tip", [(1, (0, 0, 1))], 0.5)])
tool: keepout.ConvexTool = keepout.ConvexTool.capsule((0, 0, 0), (0, 0, 9), 1.5).rotated(np.eye(3))
whole = keepout.InstrumentGuard(mesh, instrument, index=guard.index, margin=0.5)
q: np.ndarray[Any, np.dtype[np.float64]] = whole.step([0.0], linear=(0, 0, 1)).increment
share: float = whole.prove(q, increment=[0.1]).fraction
clear = whole.proofs(np.zeros((4, 1)), threads=2).is_clear.all()
session = keepout.CrtkSession(guard, np.eye(4), robot_unit="m", period=0.001)
cause: str = session.tick(0.0)
loaded = keepout.load_mesh("mesh.vtp", space="RAS", unit="m", flip=True)
notices: list[str] = loaded.notices
names: list[str] = [part.name for part in keepout.indices()]
"""


# Each line is wrong. Otherwise mypy would report an unused comment.
misuse = """
guard.steps(np.zeros((1, 3)), np.zeros((1, 3)), thread=3)  # type: ignore[call-arg]
number: int = step.status.name  # type: ignore[assignment]
whole.step([0.0], turn=(0, 0, 1))  # type: ignore[call-arg]
keepout.MotionConstraint(mesh, query="far")  # type: ignore[arg-type]
"""


def test_mypy_accepts_right_use_and_no_other(tmp_path):
    (tmp_path / "use.py").write_text(use + misuse)
    # The cache saves the time for numpy's stubs, which take mypy the longest.
    run_mypy(tmp_path, "mypy", "--strict", "--cache-dir", str(package.parent / "mypy_cache"), "use.py")


def test_all_that_is_public_is_in_the_stubs():
    stubs = (package / "__init__.pyi").read_text()
    assert all(f'"{name}"' in stubs for name in keepout.__all__)
    assert (package / "py.typed").exists()
    assert inspect.ismodule(keepout)


def test_the_stubs_have_the_docstrings_of_the_module():
    """Each docstring of the module must be in the stubs, without the signatures that pybind11 writes above it."""
    stubs = ast.parse((package / "__init__.pyi").read_text())
    assert ast.get_docstring(stubs) == inspect.getdoc(keepout)
    compared = 0
    for node in stubs.body:
        if not isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            continue
        of = getattr(keepout, node.name)
        members = [(node, of)] + [(member, getattr(of, member.name)) for member in getattr(node, "body", [])
                                  if isinstance(node, ast.ClassDef) and isinstance(member, ast.FunctionDef)]
        for stub, member in members:
            told = ast.get_docstring(stub) or ""
            full = inspect.getdoc(member) or ""
            assert told in full, (node.name, stub.name)
            if "\n\n" in full or isinstance(member, (type, property)):
                assert told or stub.name == "__init__", (node.name, stub.name)
            compared += bool(told)
    assert compared > 150
