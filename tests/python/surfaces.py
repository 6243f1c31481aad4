# SPDX-License-Identifier: BSD-3-Clause
"""Small surfaces for tests, poses around them, the steps of the command for these, and an instrument."""

import csv
import os
import subprocess
from pathlib import Path

import numpy as np

import keepout
from keepout import TableRow


def sphere(n=24, radius=10.0):
    """Returns vertices and triangles of a watertight sphere with n meridians and n / 2 bands."""
    bands = n // 2
    theta = np.pi * np.arange(1, bands) / bands
    phi = 2 * np.pi * np.arange(n) / n
    ring = np.stack(
        [
            np.outer(np.sin(theta), np.cos(phi)),
            np.outer(np.sin(theta), np.sin(phi)),
            np.outer(np.cos(theta), np.ones(n)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    vertices = radius * np.vstack([ring, [[0, 0, 1], [0, 0, -1]]])
    top, bottom = len(ring), len(ring) + 1
    triangles = []
    for j in range(n):
        k = (j + 1) % n
        triangles.append((top, j, k))
        triangles.append((bottom, (bands - 2) * n + k, (bands - 2) * n + j))
        for i in range(bands - 2):
            a, b, c, d = i * n + j, i * n + k, (i + 1) * n + j, (i + 1) * n + k
            triangles += [(a, c, b), (b, c, d)]
    return vertices, np.array(triangles)


def box(low, high):
    """Returns vertices and triangles of a closed box with outward normals."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    return low + corners * np.subtract(high, low), np.array(triangles)


def write_stl(path, vertices, triangles):
    """Writes a binary STL file, in the single precision of the format."""
    records = np.zeros(
        len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")]
    )
    records["corners"] = vertices[triangles]
    Path(path).write_bytes(bytes(80) + np.uint32(len(triangles)).tobytes() + records.tobytes())


def poses(vertices, count, seed=1, spread=1.0, step=0.3):
    """Returns tips around the vertices, inside and outside, with increments in any direction: (count, 6)."""
    random = np.random.default_rng(seed)
    tips = vertices[random.integers(0, len(vertices), count)]
    tips = tips + spread * random.normal(size=(count, 3))
    return np.hstack([tips, step * random.normal(size=(count, 3))])


def run(*command, **options):
    """Returns the output of a program. Fails if the program fails."""
    ended = subprocess.run(command, capture_output=True, text=True, **options)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return ended.stdout


def command_replay(path, lines, folder, *options):
    """Returns the motions (count, 3), status names and plane counts of `keepout replay`."""
    np.savetxt(folder / "poses.txt", lines, fmt="%.17g")
    files = ["--poses", folder / "poses.txt", "--out", folder / "steps.csv"]
    run(os.environ["KEEPOUT_COMMAND"], "replay", path, *files, *options)
    with open(folder / "steps.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    motion = np.array([[float(row[axis]) for axis in ("ux", "uy", "uz")] for row in rows])
    return motion, [row["status"] for row in rows], [int(row["planes"]) for row in rows]


def skull():
    """Returns the file of the CT skull that fixtures/prepare makes, or None."""
    root = Path(__file__).resolve().parents[2]
    path = Path(os.environ.get("KEEPOUT_CACHE", root / ".cache")) / "fixtures" / "skull.stl"
    return path if path.exists() else None


def at(x, y, z):
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def psm(base=None, flange=((0, -1, 0, 0), (0, 0, 1, 10.2), (-1, 0, 0, 0), (0, 0, 0, 1))):
    """Returns the chain of the da Vinci research kit's PSM, as in fixtures/robots/psm.urdf."""
    right = np.pi / 2
    rows = [
        TableRow("yaw", alpha=right, theta=right, lower=-1.588, upper=1.588, velocity=1),
        TableRow("pitch", alpha=-right, theta=-right, lower=-0.925025, upper=0.925025, velocity=1),
        TableRow("insertion", kind="prismatic", alpha=right, d=-431.8, lower=0, upper=240, velocity=200),
        TableRow("roll", d=416.2, lower=-4.53786, upper=4.53786, velocity=8),
        TableRow("wrist_pitch", alpha=-right, theta=-right, lower=-1.39626, upper=1.39626, velocity=8),
        TableRow("wrist_yaw", a=9.1, alpha=-right, theta=-right, lower=-1.39626, upper=1.39626, velocity=8),
    ]
    return keepout.chain_of_table(rows, base=base, flange=flange)
