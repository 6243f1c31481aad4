#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A tip that presses towards the middle of a mesh and stays outside, with 'keepout serve'.

Usage: serve_client.py KEEPOUT MESH        (the command, and a mesh file in mm)
Needs nothing but Python 3 itself.
"""
import json
import subprocess
import sys


class Guard:
    """The keepout command as a child process: one answer for each request."""

    def __init__(self, keepout, mesh, *options):
        self.process = subprocess.Popen([keepout, "serve", mesh, *options], text=True, bufsize=1,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def ask(self, **request):
        self.process.stdin.write(json.dumps(request) + "\n")
        answer = json.loads(self.process.stdout.readline())
        if "error" in answer:
            raise ValueError(answer["error"]["message"])
        return answer


if len(sys.argv) != 3:
    print(__doc__, file=sys.stderr)
    sys.exit(2)
guard = Guard(sys.argv[1], sys.argv[2], "--margin", "0.5")
box = guard.ask(do="info")["mesh"]
goal = [(low + high) / 2 for low, high in zip(box["low"], box["high"])]
tip = [goal[0], goal[1], box["high"][2] + 3]
for cycle in range(100):
    desired = [0.1 * (g - t) for g, t in zip(goal, tip)]
    length = sum(d * d for d in desired) ** 0.5
    desired = [d * min(1, 0.5 / length) for d in desired]  # [mm], at most 0.5
    step = guard.ask(id=cycle, do="step", tip=tip, desired=desired)
    if not step["ok"]:
        sys.exit(step["reason"])
    tip = [t + m for t, m in zip(tip, step["motion"])]
print(f"{step['status']} at {tip[0]:.3f} {tip[1]:.3f} {tip[2]:.3f}")
