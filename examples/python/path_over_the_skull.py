# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # A path over the skull
#
# A commanded motion that ignores the bone draws a tip across a CT skull and presses down all the time.
# The tip slides over the bone at 0.5 mm, and never enters it. The picture shows its path.
#
#     python3 examples/python/path_over_the_skull.py .cache/fixtures/skull.stl --out path.png
#
# The cells (`# %%`) run one by one in VS Code, Spyder or Jupytext.

# %% The mesh and the number of cycles
import argparse

import matplotlib

matplotlib.use("Agg")  # a file, no window; leave this out in a notebook
import matplotlib.pyplot as plt
import numpy as np

import keepout

parser = argparse.ArgumentParser(description="A path over the skull")
parser.add_argument("mesh", help="a closed surface, z up [mm]")
parser.add_argument("--out", default="path_over_the_skull.png", help="the picture to write")
parser.add_argument("--cycles", type=int, default=4000, help="control cycles of each path")
parser.add_argument("--size", type=int, default=1600, help="of the picture [pixels]")
options = parser.parse_args()

mesh = keepout.load_mesh(options.mesh)
guard = keepout.MotionConstraint(mesh, tool_radius=0.3, margin=0.2)
low, high = mesh.bounds
centre, size = 0.5 * (low + high), high - low
print(mesh, "-", mesh.inspect())

# %% Two hands: from side to side, and from front to back
#
# Each swings over an arc with a small wave, deep in the head: halfway from its center to the
# bone. Its tip starts outside, above the hand.
turn = np.linspace(0.0, 1.0, options.cycles)


def hand(across, along, reach):
    """Returns the position of a hand in each cycle, (cycles, 3): an arc in the plane of `across` and up."""
    angle = np.radians(-65.0 + 130.0 * turn)[:, None]
    up = np.array([0.0, 0.0, 1.0])
    wave = 0.07 * np.sin(2 * np.pi * 5 * turn)[:, None]
    return centre + reach * (np.sin(angle) * across + np.cos(angle) * up + wave * along) * size


x, y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
hands = np.stack([hand(x, y, 0.3), hand(y, x, 0.3)])
starts = centre + 2.2 * (hands[:, 0] - centre)
# Moves the starts away from the head until they are certainly outside.
while not np.all(guard.index.distances(starts) > 2.0):
    starts = centre + 1.1 * (starts - centre)

# %% Both paths at once, one on each processor
ran = guard.simulate(starts, hands, max_step=0.5)
counts = {status.name: count for status, count in ran.counts().items()}
distances = guard.index.distances(ran.tips.reshape(-1, 3)).reshape(ran.tips.shape[:2])
print(ran)
print(f"closest to the bone: {distances.min():.4f} mm, to keep: {guard.distance_kept} mm")
print(f"hand inside, tip outside: {np.linalg.norm(hands - ran.tips[:, 1:], axis=2).max():.1f} mm apart")


# %% A shaded picture of the surface
#
# matplotlib has no depth buffer, and would take minutes for half a million triangles. This is a
# simple depth buffer: it draws each triangle as points half a pixel apart, and keeps the nearest.
def camera(azimuth, elevation):
    """Returns the rows right, up and towards the viewer, for an eye that looks at the center."""
    a, e = np.radians([azimuth, elevation])
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    return np.stack([right, np.cross(towards, right), towards])


def pixels(points, view, scale, width):
    """Returns column, row and depth of points in the picture, without perspective."""
    seen = (points - centre) @ view.T
    return (
        np.round(width / 2 + scale * seen[:, 0]).astype(int),
        np.round(width / 2 - scale * seen[:, 1]).astype(int),
        seen[:, 2],
    )


def samples(scale):
    """Returns points on the triangles, at most half a pixel apart, and the triangle of each point."""
    corners = mesh.vertices[mesh.triangles]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    parts = np.maximum(1, np.ceil(2.0 * scale * longest)).astype(int)
    parts = np.minimum(parts, 400)
    for n in np.unique(parts):
        of = np.flatnonzero(parts == n)
        i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1))
        weights = np.stack([i, j, n - i - j], axis=-1)[i + j <= n] / n
        for some in np.array_split(of, 1 + len(of) * len(weights) // 2_000_000):
            points = np.einsum("wk,tkc->twc", weights, corners[some]).reshape(-1, 3)
            yield points, np.repeat(some, len(weights))


def render(view, scale, width):
    """Returns depth and shade of the nearest points, (width, width) each; -inf and nan for empty pixels."""
    depth = np.full(width * width, -np.inf)
    front = np.full(width * width, -1)
    for points, triangles in samples(scale):
        column, row, z = pixels(points, view, scale, width)
        inside = (column >= 0) & (column < width) & (row >= 0) & (row < width)
        at, z, triangles = (row * width + column)[inside], z[inside], triangles[inside]
        order = np.argsort(z)  # the last point written on a pixel is the nearest
        at, z, triangles = at[order], z[order], triangles[order]
        nearer = z > depth[at]
        depth[at[nearer]], front[at[nearer]] = z[nearer], triangles[nearer]
    normals = mesh.normals[front] @ view.T
    normals *= np.where(normals[:, 2:] < 0, -1.0, 1.0)
    key = normals @ (np.array([-0.45, 0.6, 0.66]) / np.linalg.norm([-0.45, 0.6, 0.66]))
    shade = 0.22 + 0.68 * np.clip(key, 0, 1) + 0.10 * normals[:, 2]
    image = np.where(np.isfinite(depth), depth, np.nan).reshape(width, width)
    shade = np.where(front >= 0, shade, np.nan).reshape(width, width)
    return image, shade


# %% The picture: bone, paths in front of it, and below, the distance of the tips from the bone
width = options.size // 2
scale = 0.90 * width / np.linalg.norm(size) * 1.15
bone = np.array([0.96, 0.92, 0.84])
colours = ["#d1495b", "#00798c"]
figure = plt.figure(figsize=(options.size / 100, 0.68 * options.size / 100), dpi=100)
grid = figure.add_gridspec(2, 2, height_ratios=[4, 1], hspace=0.12, wspace=0.03)
for place, (title, azimuth, elevation) in enumerate(
    [("from the front", 128.0, 36.0), ("from behind", -62.0, 34.0)]
):
    axes = figure.add_subplot(grid[0, place])
    view = camera(azimuth, elevation)
    depth, shade = render(view, scale, width)
    picture = np.ones((width, width, 3))
    seen = np.isfinite(depth)
    picture[seen] = np.clip(bone * shade[seen][:, None], 0, 1)
    axes.imshow(picture, interpolation="bilinear")
    # Draws the lines, except the parts behind the bone.
    for loop, colour in enumerate(colours):
        column, row, z = pixels(ran.tips[loop], view, scale, width)
        within = (column >= 0) & (column < width) & (row >= 0) & (row < width)
        behind = np.ones(len(z), bool)
        # In front of the bone, with a tolerance for the slope within a pixel.
        known = depth[row[within], column[within]]
        behind[within] = z[within] < np.nan_to_num(known, nan=-np.inf) - 1.0
        line = np.stack([column, row], axis=1).astype(float)
        axes.plot(*np.where(behind[:, None], np.nan, line).T, color="white", lw=4.5)
        axes.plot(*np.where(behind[:, None], np.nan, line).T, color=colour, lw=2.4)
        if not behind[0]:
            axes.plot(*line[0], "o", color=colour, ms=7, mec="white")
    rows, columns = np.nonzero(seen)
    axes.set_xlim(columns.min() - 20, columns.max() + 20)
    axes.set_ylim(rows.max() + 20, rows.min() - 30)
    axes.set_title(title, fontsize=11, color="0.35")
    axes.axis("off")

axes = figure.add_subplot(grid[1, :])
kept = guard.distance_kept
for loop, (colour, name) in enumerate(zip(colours, ["side to side", "front to back"])):
    axes.plot(distances[loop], color=colour, lw=1.3, label=name)
axes.axhspan(0, kept, color="0.92", lw=0)
axes.text(0.01 * options.cycles, 0.5 * kept, "distance to keep", color="0.4", va="center")
axes.set(xlabel="cycle", ylabel="tip to bone [mm]", xlim=(0, options.cycles), ylim=(0, 3 * kept))
axes.spines[["top", "right"]].set_visible(False)
axes.legend(frameon=False, ncol=2, loc="upper right")
figure.suptitle("Two hands press into the skull; their tips glide over it", fontsize=15, y=0.95)
figure.savefig(options.out, bbox_inches="tight", facecolor="white")
print("picture:", options.out)
