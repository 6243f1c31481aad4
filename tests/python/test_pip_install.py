# SPDX-License-Identifier: BSD-3-Clause
"""`pip install .` works without a network, and the installed package needs nothing else."""

import os
import sys
from pathlib import Path

import pytest
import surfaces

root = Path(__file__).resolve().parents[2]
build = os.environ.get("KEEPOUT_BUILD_DIR")

use = """
import numpy, sys, keepout
assert keepout.__file__.startswith(sys.prefix), keepout.__file__
mesh = keepout.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]], [[0, 1, 2]])
print(keepout.__version__, keepout.MotionConstraint(mesh).step((0.2, 0.2, 0.5), (0, 0, -1.0)).status.name)
"""


def run(*command):
    # Uses nothing of the build tree, and no package index.
    clean = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    return surfaces.run(*command, cwd=root, env={**clean, "PIP_NO_INDEX": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1"})


@pytest.mark.skipif(not build, reason="KEEPOUT_BUILD_DIR names no build directory")
def test_into_a_fresh_environment(tmp_path):
    venv = tmp_path / "venv"
    run(sys.executable, "-m", "venv", "--system-site-packages", str(venv))
    python = venv / "bin" / "python"
    said = run(python, "-m", "pip", "install", ".", "--config-settings", f"build-dir={build}")
    assert "Successfully installed keepout-" in said
    assert run(python, "-c", use).split()[1] == "limited"
    installed = next((venv / "lib").glob("python3*/site-packages"))
    linked = run("ldd", str(next((installed / "keepout").glob("_core*.so"))))
    for library in ("libkeepout", "not found", "fcl", "Bullet", "embree", "nlopt"):
        assert library not in linked
    listed = run(python, "-c", "import keepout; print([part.name for part in keepout.indices()])")
    for module in (installed / "keepout" / "keepout-modules").glob("*.so"):
        assert module.stem in listed or module.stem in ("ccd", "nlopt")
    assert (installed / "keepout" / "py.typed").exists()
    run(python, "-m", "pip", "uninstall", "--yes", "keepout")
    assert not (installed / "keepout").exists()


def test_a_build_directory_that_is_none_is_refused(tmp_path):
    sys.path.insert(0, str(root / "python" / "build_backend"))
    import keepout_build

    with pytest.raises(SystemExit, match="holds no build"):
        keepout_build.build_wheel(str(tmp_path), {"build-dir": str(tmp_path)})
