#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the time of a step from Python with that from C++, and measures the gain of two threads.

After ./test, or ninja -C build/release keepout_python keepout_cpp_loop:

    PYTHONPATH=build/release/python python3 benchmarks/python/overhead.py MESH

All variants get the same poses. The answers must be bitwise those of C++ before the script prints a time. Times are
processor times, except for two threads, which are wall-clock times. Each is the least of several passes, which
alternate. `--build` names another build directory.
"""

import argparse
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

import keepout

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("mesh")
parser.add_argument("--build", default="build/release", help="build directory")
parser.add_argument("--poses", type=int, default=50000)
parser.add_argument("--passes", type=int, default=5)
options = parser.parse_args()

mesh = keepout.load_mesh(options.mesh)
watching = keepout.MotionConstraint(mesh, tool_radius=0.3, margin=0.2)
as_is = keepout.MotionConstraint(
    mesh, index=watching.index, tool_radius=0.3, margin=0.2, inside="taken_as_is"
)
random = np.random.default_rng(1)


def poses_outside(spread):
    """Returns tips up to `spread` from the surface, on its free side, and motions of about 0.2 in any direction."""
    at = random.integers(0, len(mesh), options.poses)
    tips = mesh.vertices[mesh.triangles[at, 0]]
    tips = tips + mesh.normals[at] * random.uniform(0.55, spread, (options.poses, 1))
    return tips, 0.2 * random.normal(size=tips.shape)


def taken_by(function):
    """Returns the seconds of wall clock and of all processors together."""
    wall, cpu = time.perf_counter(), time.process_time()
    function()
    return time.perf_counter() - wall, time.process_time() - cpu


def path():
    """Returns poses of moving tips: each pose is where the step before ended, as in a control loop."""
    tips, _ = poses_outside(2.0)
    starts = tips[:: max(1, options.poses // 50)][:50]
    cycles = options.poses // len(starts)
    aims = starts[:, None] + np.cumsum(0.2 * random.normal(size=(len(starts), cycles, 3)), axis=1)
    ran = watching.simulate(starts, aims, max_step=0.2)
    tips = ran.tips[:, :-1].reshape(-1, 3)
    desired = aims.reshape(-1, 3) - tips
    length = np.linalg.norm(desired, axis=1, keepdims=True)
    return tips, desired * np.minimum(1.0, 0.2 / np.maximum(length, 1e-300))


def measure(title, tips, desired, memory):
    count = len(tips)
    lines = np.ascontiguousarray(np.hstack([tips, desired]))
    out, two = keepout.Steps.empty(count), keepout.Steps.empty(count)
    guard = as_is if memory == "as_is" else watching
    independent = memory != "remembering"

    def batch():
        if independent:
            guard.steps(tips, desired, threads=1, out=out)
        else:
            guard.replay(lines, out=out)

    def single():
        step = guard.step
        for tip, aim in zip(tips, desired):
            step(tip, aim).motion

    passes = []
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / name for name in ("poses", "answers")]
        lines.tofile(files[0])
        program = Path(options.build) / "python" / "keepout_cpp_loop"
        for _ in range(options.passes):
            ended = subprocess.run(
                [program, options.mesh, *files, memory, "2"], check=True, capture_output=True
            )
            cpp_ns, build = ended.stdout.decode().strip().split(" ", 1)
            times = [float(cpp_ns), taken_by(batch)[1], taken_by(batch)[0], taken_by(single)[1]]
            if independent:
                wall, cpu = taken_by(lambda: guard.steps(tips, desired, threads=2, out=two))
                times += [wall, -cpu / wall]  # the most processors in use
            passes.append(times)
        answers = np.fromfile(files[1]).reshape(-1, 5)
    assert np.array_equal(out.motion.view(np.int64), answers[:, :3].copy().view(np.int64))
    assert np.array_equal(out.status, answers[:, 3])

    cpp, batch_s, batch_wall, single_s, *of_two = np.min(passes, axis=0)
    cells = [f"{1e-3 * cpp:.2f} µs"]
    from_python = (1e9 * batch_s / count, 1e9 * single_s / count)
    cells += [f"{1e-3 * ns:.2f} µs, {1e-3 * (ns - cpp):+.2f}" for ns in from_python]
    if independent:
        assert np.array_equal(out.motion, two.motion)
        cells += [f"{batch_wall / of_two[0]:.2f}", f"{-of_two[1]:.2f}"]
    else:
        cells += ["-", "-"]
    print(f"| {title} | {' | '.join(cells)} |", flush=True)
    return build


def processor():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    return f"{names[0]}, {len(names)} cores"


print("| | C++ loop | Python, a batch | Python, step by step | two threads, times as fast | processors busy |")
print("|---|--:|--:|--:|--:|--:|")
near = poses_outside(2.0)
measure("paths along the bone, step after step", *path(), "remembering")
measure("poses by themselves, sides taken as they are", *near, "as_is")
build = measure("poses by themselves, each placed anew", *near, "anew")
print(f"machine: {processor()}, {build}")
print(f"{mesh}, {watching.index.name}; least of {options.passes} passes of {options.poses} poses")
