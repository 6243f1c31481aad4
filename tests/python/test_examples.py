# SPDX-License-Identifier: BSD-3-Clause
"""Tests that the examples run and print the expected results."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from surfaces import run

import keepout

examples = Path(__file__).resolve().parents[2] / "examples" / "python"


def test_first_steps(sphere_file):
    words = run(sys.executable, examples / "first_steps.py", sphere_file).split()
    assert int(words[words.index("in") + 1]) > 100
    tip = np.array([float(word) for word in words[-3:]])
    assert keepout.Index(keepout.load_mesh(sphere_file)).distances([tip])[0] >= 0.5 - 1e-9


def test_joints(sphere_file):
    words = run(sys.executable, examples / "joints.py", sphere_file).replace(",", "").split()
    assert int(words[words.index("in") + 1]) > 100
    # The arm moves along arcs of 60 mm radius, but its Jacobian gives tangents. Steps are up to 0.2 mm.
    assert 0.499 < float(words[words.index("nearest") + 1]) < 0.51


@pytest.mark.parametrize("example", ["first_steps.py", "joints.py"])
def test_a_mesh_that_is_missing_is_told(example):
    for arguments, says in [([], "usage: "), (["none.stl"], "none.stl")]:
        ended = subprocess.run(
            [sys.executable, examples / example, *arguments], capture_output=True, text=True
        )
        assert ended.returncode == 1 and says in ended.stderr and "Traceback" not in ended.stderr


def test_the_path_over_the_skull(request, tmp_path):
    matplotlib = pytest.importorskip("matplotlib.image")
    # Uses the sphere if the skull is not prepared.
    try:
        path = request.getfixturevalue("skull_file")
    except pytest.skip.Exception:
        path = request.getfixturevalue("sphere_file")
    said = run(sys.executable, examples / "path_over_the_skull.py", path, "--out", tmp_path / "p.png",
               "--cycles", "300", "--size", "300")  # fmt: skip
    assert "limited" in said and "picture" in said
    closest = float(said.split("closest to the bone: ")[1].split()[0])
    assert closest >= 0.5
    picture = matplotlib.imread(tmp_path / "p.png")
    assert picture.shape[0] > 100 and len(np.unique(picture)) > 50
