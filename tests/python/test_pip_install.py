# SPDX-License-Identifier: BSD-3-Clause
"""`pip install .` works without a network, and the installed package needs nothing else."""

import os
import re
import shutil
import sys
import zipfile
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


@pytest.mark.skipif(not build or not shutil.which("patchelf"), reason="no build directory, or no patchelf")
def test_a_portable_wheel_contains_all_libraries_but_glibc(tmp_path):
    settings = [f"--config-settings=build-dir={build}", "--config-settings=portable=yes"]
    run(sys.executable, "-m", "pip", "wheel", ".", "--no-deps", "--wheel-dir", str(tmp_path), *settings)
    (wheel,) = tmp_path.glob("keepout-*-manylinux_2_*.whl")
    with zipfile.ZipFile(wheel) as packed:
        packed.extractall(tmp_path / "package")
    module = next((tmp_path / "package" / "keepout").glob("_core*.so"))
    libraries = dict(re.findall(r"(\S+) => (\S+)", run("ldd", str(module))))
    outside = [name for name, path in libraries.items() if not Path(path).resolve().is_relative_to(tmp_path.resolve())]
    assert set(outside) <= {"libc.so.6", "libm.so.6"}
    assert len(libraries) > len(outside)
    for name in set(libraries) - set(outside):
        assert (tmp_path / "package" / "keepout.libs" / f"{name}.copyright").stat().st_size > 100
    script = f"import sys; sys.path.insert(0, {str(tmp_path / 'package')!r}); sys.prefix = {str(tmp_path)!r}\n" + use
    assert run(sys.executable, "-c", script).split()[1] == "limited"


def test_a_build_directory_that_is_none_is_refused(tmp_path):
    sys.path.insert(0, str(root / "python" / "build_backend"))
    import keepout_build

    with pytest.raises(SystemExit, match="holds no build"):
        keepout_build.build_wheel(str(tmp_path), {"build-dir": str(tmp_path)})
