# SPDX-License-Identifier: BSD-3-Clause
"""An arm of seven joints that moves the tip: keepout returns the increments of the joints.
With more than three joints, many increments move the tip in the same way; damping above 0 selects
the smallest.

python3 examples/python/joints.py MESH
"""

import sys

import numpy as np

import keepout


def turn(axis, angle):
    """Returns the rotation about x (0) or y (1) by an angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]] if axis == 0 else [[c, 0, s], [0, 1, 0], [-s, 0, c]])


def arm(q):
    """Returns the tip's position from the arm's base, and its Jacobian (3, 7).

    The joints turn about x and y alternately, 60 mm apart.
    """
    turned, at, joints, axes = np.eye(3), np.zeros(3), [], []
    for i, angle in enumerate(q):
        joints.append(at)
        axes.append(turned[:, i % 2])
        turned = turned @ turn(i % 2, angle)
        at = at + turned @ [0, 0, -60.0]
    return at, np.cross(axes, at - joints).T


if len(sys.argv) != 2:
    sys.exit(f"usage: python3 {sys.argv[0]} MESH")
try:
    mesh = keepout.load_mesh(sys.argv[1])
except keepout.Error as error:
    sys.exit(str(error))
# The damping is for columns of 60 mm/rad and more.
guard = keepout.MotionConstraint(
    mesh, tool_radius=0.3, margin=0.2, damping=1e-2, distances="always"
)

# The tip starts 5 mm above the mesh; the commanded motion goes straight through the mesh.
low, high = mesh.bounds
start = np.array([*(0.5 * (low + high))[:2], high[2] + 5.0])
goal = np.array([start[0], start[1], low[2]])
q = np.array([0.5, 0.3, -0.8, 0.4, 0.9, -0.3, 0.2])
from_base, jacobian = arm(q)
base = start - from_base
tip, nearest, held = start, 5.0, 0
for cycle in range(2000):
    desired = 0.2 * (goal - tip) / np.linalg.norm(goal - tip)
    step = guard.step(tip, desired, jacobian=jacobian)
    if not step.ok:
        print(f"cycle {cycle}: {step.reason}")
    else:
        q += step.increment
    held += step.status is not keepout.Status.free
    nearest = min(nearest, step.distance)
    from_base, jacobian = arm(q)
    tip = base + from_base
print(
    f"held back in {held} of 2000 cycles, nearest {nearest:.4f} mm, "
    f"ends at {tip[0]:.6f} {tip[1]:.6f} {tip[2]:.6f}"
)
