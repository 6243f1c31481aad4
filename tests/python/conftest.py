# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from surfaces import skull, sphere, write_stl

import keepout


@pytest.fixture(scope="session")
def mesh():
    return keepout.Mesh(*sphere())


@pytest.fixture
def guard(mesh):
    return keepout.MotionConstraint(mesh, tool_radius=0.3, margin=0.2)


@pytest.fixture(scope="session")
def sphere_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("sphere") / "sphere.stl"
    write_stl(path, *sphere(48))
    return path


@pytest.fixture(scope="session")
def skull_file():
    path = skull()
    if path is None:
        pytest.skip("the skull is not prepared: fixtures/prepare skull")
    return path


@pytest.fixture
def outside():
    """Returns tips outside of the sphere and increments, each (n, 3)."""
    random = np.random.default_rng(7)
    directions = random.normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return 10.7 * directions, -0.4 * directions + 0.2 * random.normal(size=(500, 3))
