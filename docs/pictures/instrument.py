# SPDX-License-Identifier: BSD-3-Clause
"""The picture of docs/joint-space-step-algorithm.md: an instrument of three joints that move in the plane."""

import keepout
import numpy as np

from section import Picture, Section, prism, split, unit

PORT, WRIST, RADII, MARGIN = 0j, 14.0, (2.2, 1.6), 0.5
WEIGHTS = np.array([900.0, 1.0, 60.0])  # of the joints


def guarded(mesh):
    chain = keepout.Chain([
        keepout.Joint("yaw", axis=(0, 0, 1), lower=-1, upper=1, velocity=50),
        keepout.Joint("insertion", kind="prismatic", axis=(0, -1, 0), lower=0, upper=90, velocity=1000),
        keepout.Joint("wrist", axis=(0, 0, 1), lower=-1.6, upper=1.6, velocity=50)])
    bodies = [keepout.Body("shaft", [(0, (0, 0, 0)), (2, (0, 0, 0))], RADII[0]),
              keepout.Body("hand", [(2, (0, 0, 0)), (3, (0, -WRIST, 0))], RADII[1])]
    return keepout.InstrumentGuard(mesh, keepout.Instrument(chain, bodies), margin=MARGIN, band=0.01)


def places(q):
    """Returns the places of the port, the wrist and the tip."""
    wrist = PORT - 1j * q[1] * np.exp(1j * q[0])
    return PORT, wrist, wrist - 1j * WRIST * np.exp(1j * (q[0] + q[2]))


def steps(mesh, q, target, cycles):
    """Returns the joints after each cycle, and the status of each cycle."""
    guard = guarded(mesh)
    joints, statuses = [np.array(q)], []
    for _ in range(cycles):
        _, wrist, tip = places(joints[-1])
        towards = target - tip
        wanted = min(1.0, 0.8 / (abs(towards) + 1e-9)) * towards
        # The increment of least weighted length that moves the tip so.
        columns = np.array([1j * (tip - PORT), -1j * np.exp(1j * joints[-1][0]), 1j * (tip - wrist)])
        jacobian = np.stack([columns.real, columns.imag])
        forces = np.linalg.solve(jacobian / WEIGHTS @ jacobian.T, (wanted.real, wanted.imag))
        step = guard.step(joints[-1], increment=forces @ jacobian / WEIGHTS, weights=WEIGHTS)
        joints.append(joints[-1] + step.increment)
        statuses.append(step.status)
    return joints, statuses


def outline(a, b, radius):
    """Returns points around a capsule in the plane."""
    half = 1j * radius * unit(b - a) * np.exp(1j * np.linspace(0, np.pi, 17))
    return [*(a + half), *(b - half)]


def instrument():
    profile = [-70 - 24j, -7 - 24j, -5 - 26j, -5 - 42j, -7 - 44j, -70 - 44j]
    target = -34.0 - 62.0j
    way, statuses = steps(prism(split(profile, 1.0), 1.5, 12.0), [0.12, 46.0, 0.0], target, 150)
    limited = statuses.count(keepout.Status.limited)
    p = Picture(720, 520, "An instrument pushed round a corner",
                "The tip is asked to go to the left, behind a slab of bone. The shaft comes to the slab's "
                "corner first, stays off it by the margin, and the tip goes on by the wrist.")
    s = Section(p, (8, 8, 704, 470), -14.0 - 33.5j, 6.1)
    s.hatched([*profile, profile[-1]])
    s.path(profile, "skin")
    s.offset(profile, MARGIN)
    for number, q in enumerate(way):
        if number % 10 and number != len(way) - 1:
            continue
        last = number == len(way) - 1
        port, wrist, tip = places(q)
        for a, b, radius in ((port, wrist, RADII[0]), (wrist, tip, RADII[1])):
            s.path(outline(a, b, radius), "line made" if last else "line trial thin", True)
    s.path([places(q)[2] for q in way], "line asked")
    s.dot(target, "one-f", 5)
    s.dot(PORT, "tip", 5)
    s.label(PORT, 12, 5, "port", "bold")
    s.label(target, -12, 5, "asked for", "", "end")
    s.label(-40.0 - 34.0j, 0, 0, "bone", "muted", "middle")
    p.text(20, 502, f"{len(way) - 1} cycles, in {limited} of them a part of the instrument holds it back; "
                    "drawn: every tenth", "small muted")
    p.save("instrument.svg")
    print(f"draw: the tip ends {abs(places(way[-1])[2] - target):.2f} mm from what was asked for")
