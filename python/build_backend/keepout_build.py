# SPDX-License-Identifier: BSD-3-Clause
"""The build backend that pip calls (PEP 517): builds the module with CMake and zips it into a wheel.
Needs no package from PyPI.

The build directory is build/python, or an existing one of the same Python that already holds most
objects:

    pip install . --config-settings build-dir=build/release
    KEEPOUT_BUILD_DIR=build/release pip install .

A portable wheel contains all libraries but glibc, and no modules of other libraries. It runs on machines
with the same Python and with a glibc that is not older. Needs patchelf, and a Debian system:

    pip wheel . --no-deps --wheel-dir dist --config-settings portable=yes
"""

import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile
from pathlib import Path

root = Path(__file__).resolve().parents[2]


def version():
    text = (root / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"project\(keepout VERSION ([0-9.]+)", text).group(1)


def metadata():
    return (
        "Metadata-Version: 2.1\n"
        "Name: keepout\n"
        f"Version: {version()}\n"
        "Summary: Keeps a robot's tool out of a triangle mesh of anatomy\n"
        "License: BSD-3-Clause\n"
        "Requires-Python: >=3.9\n"
        "Requires-Dist: numpy>=1.20\n"
    )


def tag(glibc=None):
    """Returns the tag of the Python and the machine that the extension is built for. `glibc`: the
    oldest version, such as "2.36", that a portable wheel runs with."""
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    if glibc:
        platform = platform.replace("linux", f"manylinux_{glibc.replace('.', '_')}")
    return f"{python}-{python}-{platform}"


def run(*command):
    try:
        subprocess.run([str(word) for word in command], cwd=root, check=True)
    except FileNotFoundError:
        sys.exit(f"keepout: {command[0]} was not found; install what cmake/debian_packages.txt lists")
    except subprocess.CalledProcessError as error:
        sys.exit(
            f"keepout: {command[0]} failed with status {error.returncode}: see above. What the build "
            "needs is listed in cmake/debian_packages.txt: apt install what is missing"
        )


def configure(build):
    # Prefer Ninja, which is faster.
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    parts = ["APPS", "EXAMPLES", "TESTS", "BENCHMARKS"]
    run(
        "cmake", "-S", root, "-B", build, *generator,
        "-DCMAKE_BUILD_TYPE=Release",
        "-DBUILD_SHARED_LIBS=OFF",
        "-DKEEPOUT_BUILD_PYTHON=ON",
        *(f"-DKEEPOUT_BUILD_{part}=OFF" for part in parts),
        f"-DPython3_EXECUTABLE={sys.executable}",
    )  # fmt: skip


def build_package(settings, staging):
    """Builds the module and installs the complete package below `staging`."""
    given = (settings or {}).get("build-dir") or os.environ.get("KEEPOUT_BUILD_DIR")
    build = (root / given) if given else root / "build" / "python"
    if given and not (build / "CMakeCache.txt").exists():
        sys.exit(f"keepout: build-dir {build} holds no build; configure it first, or leave it out")
    if not given:
        configure(build)
    run("cmake", "--build", build, "--target", "keepout_stubs", "keepout_modules")
    run("cmake", "--install", build, "--component", "python", "--prefix", staging)
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    if not (staging / "keepout" / f"_core{suffix}").exists():
        sys.exit(f"keepout: {build} was configured for another Python than {sys.executable}")


def output_of(*command):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout


def copyright_of(library):
    """Returns the file with the license of a library of Debian."""
    # Packages may list files below /lib, which is a link to /usr/lib.
    found = subprocess.run(["dpkg", "-S", library, library.removeprefix("/usr")], capture_output=True, text=True)
    return f"/usr/share/doc/{found.stdout.split(':')[0]}/copyright"


def bundle(staging):
    """Puts the libraries that the module needs, and their licenses, beside it. Returns the oldest
    version of glibc that has all needed symbols."""
    (module,) = staging.glob("keepout/_core*.so")
    shutil.rmtree(staging / "keepout" / "keepout-modules", ignore_errors=True)
    folder = staging / "keepout.libs"
    folder.mkdir()
    of_glibc = re.compile(r"(libc|libm|libdl|librt|libpthread|ld-linux.*)\.so")
    binaries = [module]
    for name, path in re.findall(r"(\S+) => (/\S+)", output_of("ldd", module)):
        if of_glibc.match(name):
            continue
        shutil.copy(os.path.realpath(path), folder / name)
        binaries.append(folder / name)
        shutil.copy(copyright_of(os.path.realpath(path)), folder / f"{name}.copyright")
    run("patchelf", "--set-rpath", "$ORIGIN/../keepout.libs", module)
    for binary in binaries[1:]:
        run("patchelf", "--set-rpath", "$ORIGIN", binary)
    symbols = "".join(output_of("objdump", "-T", binary) for binary in binaries)
    versions = set(re.findall(r"GLIBC_(\d+\.\d+)", symbols))
    return max(versions, key=lambda version: [int(part) for part in version.split(".")])


def digest(data):
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    info = Path(metadata_directory) / f"keepout-{version()}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(metadata(), encoding="utf-8")
    return info.name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    info = f"keepout-{version()}.dist-info"
    with tempfile.TemporaryDirectory() as folder:
        staging = Path(folder)
        build_package(config_settings, staging)
        is_portable = (config_settings or {}).get("portable") == "yes"
        tags = tag(bundle(staging) if is_portable else None)
        contents = {
            path.relative_to(staging).as_posix(): path.read_bytes()
            for path in sorted(staging.rglob("*"))
            if path.is_file()
        }
    contents[f"{info}/METADATA"] = metadata().encode()
    contents[f"{info}/WHEEL"] = (
        f"Wheel-Version: 1.0\nGenerator: keepout\nRoot-Is-Purelib: false\nTag: {tags}\n".encode()
    )
    contents[f"{info}/LICENSE"] = (root / "LICENSE").read_bytes()
    record = f"{info}/RECORD"
    lines = [f"{name},sha256={digest(data)},{len(data)}\n" for name, data in contents.items()]
    contents[record] = ("".join(lines) + f"{record},,\n").encode()

    name = f"keepout-{version()}-{tags}.whl"
    with zipfile.ZipFile(Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for file, data in contents.items():
            entry = zipfile.ZipInfo(file)  # dated 1980: the same source gives the same wheel
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if ".so" in file else 0o644) << 16
            wheel.writestr(entry, data)
    return name


def build_sdist(sdist_directory, config_settings=None):
    base = f"keepout-{version()}"
    left_out = {"build", ".cache", "out", ".git", "__pycache__"}

    def kept(entry):
        return None if left_out & set(Path(entry.name).parts) else entry

    with tempfile.TemporaryDirectory() as folder:
        info = Path(folder) / "PKG-INFO"
        info.write_text(metadata(), encoding="utf-8")
        name = f"{base}.tar.gz"
        with tarfile.open(Path(sdist_directory) / name, "w:gz") as archive:
            for path in sorted(root.iterdir()):
                if path.name not in left_out:
                    archive.add(path, f"{base}/{path.name}", filter=kept)
            archive.add(info, f"{base}/PKG-INFO")
    return name
