# SPDX-License-Identifier: BSD-3-Clause
"""A tip that is pushed into a mesh, and kept out of it.

python3 examples/python/first_steps.py MESH
"""

import sys

import numpy as np

import keepout

if len(sys.argv) != 2:
    sys.exit(f"usage: python3 {sys.argv[0]} MESH")
try:
    mesh = keepout.load_mesh(sys.argv[1])
except keepout.Error as error:
    sys.exit(str(error))
guard = keepout.MotionConstraint(mesh, tool_radius=0.3, margin=0.2)

# The commanded motion starts above the mesh and goes straight down through it.
low, high = mesh.bounds
tip = np.array([*(0.5 * (low + high))[:2], high[2] + 5.0])
goal = np.array([tip[0], tip[1], low[2]])
held = 0
for cycle in range(2000):
    step = guard.step(tip, 0.2 * (goal - tip) / np.linalg.norm(goal - tip))
    if not step.ok:
        print(f"cycle {cycle}: {step.reason}")
    held += step.status is not keepout.Status.free
    tip += step.motion  # zero unless ok
print(f"held back in {held} of 2000 cycles, ends at {tip[0]:.6f} {tip[1]:.6f} {tip[2]:.6f}")
