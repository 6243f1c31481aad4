# SPDX-License-Identifier: BSD-3-Clause
"""The picture of docs/joint-space-step-algorithm.md: an instrument of three joints that move in the plane. Its
steps are made by `keepout serve`."""

import math

from section import Picture, Section, add, prism, served, split, times, unit

PORT, WRIST, RADII, MARGIN = (0.0, 0.0), 14.0, (2.2, 1.6), 0.5

URDF = """<robot name="planar"><link name="base"/><link name="turned"/><link name="shaft"/><link name="tip"/>
<joint name="yaw" type="revolute"><parent link="base"/><child link="turned"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="50"/></joint>
<joint name="insertion" type="prismatic"><parent link="turned"/><child link="shaft"/><axis xyz="0 -1 0"/>
<limit lower="0" upper="90" effort="1" velocity="1000"/></joint>
<joint name="wrist" type="revolute"><parent link="shaft"/><child link="tip"/><axis xyz="0 0 1"/>
<limit lower="-1.6" upper="1.6" effort="1" velocity="50"/></joint></robot>"""


def places(q):
    """Of the port, the wrist and the tip."""
    along = lambda angle: (math.sin(angle), -math.cos(angle))
    wrist = add(PORT, times(q[1], along(q[0])))
    return PORT, wrist, add(wrist, times(WRIST, along(q[0] + q[2])))


def steps(triangles, q, target, cycles):
    """Where the joints are after each cycle, and the names of the statuses."""
    with served(triangles, "--margin", MARGIN) as (ask, folder):
        (folder / "planar.urdf").write_text(URDF)
        ask(id=0, do="instrument", urdf=str(folder / "planar.urdf"), scale=1.0, margin=MARGIN, band=0.01,
            capsules=[[0, 0, 0, 0, 2, 0, 0, 0, RADII[0]], [2, 0, 0, 0, 3, 0, -WRIST, 0, RADII[1]]])
        way = [(q, "start")]
        for _ in range(cycles):
            tip = places(q)[2]
            towards = (target[0] - tip[0], target[1] - tip[1])
            # The tip is to go to the target: three joints, of which the nearest increment is asked for.
            reach = min(1.0, 0.8 / (math.hypot(*towards) + 1e-9))
            wanted = times(reach, towards)
            jacobian = columns(q)
            gain = least_squares(jacobian, wanted)
            answer = ask(id=1, do="joint_step", q=q, increment=gain, weights=[900.0, 1.0, 60.0])
            q = [a + b for a, b in zip(q, answer["increment"])]
            way.append((q, answer["status"]))
    return way


def columns(q):
    """How the tip moves with each joint."""
    _, wrist, tip = places(q)
    turn = lambda about: (-(tip[1] - about[1]), tip[0] - about[0])
    return [turn(PORT), (math.sin(q[0]), -math.cos(q[0])), turn(wrist)]


def least_squares(jacobian, wanted):
    """The joint increment of least weighed length that moves the tip so."""
    inverse = [1 / 900.0, 1.0, 1 / 60.0]
    a = [[sum(w * c[i] * c[j] for w, c in zip(inverse, jacobian)) for j in (0, 1)] for i in (0, 1)]
    det = a[0][0] * a[1][1] - a[0][1] * a[1][0]
    x = ((wanted[0] * a[1][1] - wanted[1] * a[0][1]) / det,
         (a[0][0] * wanted[1] - a[1][0] * wanted[0]) / det)
    return [w * (c[0] * x[0] + c[1] * x[1]) for w, c in zip(inverse, jacobian)]


def outline(a, b, radius):
    """Points around a capsule in the plane."""
    along = unit((b[0] - a[0], b[1] - a[1]))
    start = math.atan2(along[1], along[0]) + math.pi / 2
    arc = lambda centre, begin: [add(centre, (radius * math.cos(begin + math.pi * i / 16),
                                              radius * math.sin(begin + math.pi * i / 16)))
                                 for i in range(17)]
    return arc(a, start) + arc(b, start + math.pi)


def instrument():
    profile = [(-70, -24), (-7, -24), (-5, -26), (-5, -42), (-7, -44), (-70, -44)]
    target = (-34.0, -62.0)
    way = steps(prism(split(profile, 1.0), 1.5, 12.0), [0.12, 46.0, 0.0], target, 150)
    limited = sum(status == "limited" for _, status in way)
    p = Picture(720, 520, "An instrument pushed round a corner",
                "The tip is asked to go to the left, behind a slab of bone. The shaft comes to the slab's "
                "corner first, stays off it by the margin, and the tip goes on by the wrist.")
    s = Section(p, (8, 8, 704, 470), (-14.0, -33.5), 6.1)
    slab = profile + [(-70, -44)]
    d = s.path(slab, "body", True)
    p.put(f'<path fill="url(#hatch)" d="{d}" clip-path="url(#{s.id})"/>')
    s.path(profile, "skin")
    s.offset(profile, MARGIN)
    for number, (q, _) in enumerate(way):
        if number % 10 and number != len(way) - 1:
            continue
        last = number == len(way) - 1
        port, wrist, tip = places(q)
        for a, b, radius in ((port, wrist, RADII[0]), (wrist, tip, RADII[1])):
            s.path(outline(a, b, radius), "line made" if last else "line trial thin", True)
    s.path([places(q)[2] for q, _ in way], "line asked")
    s.dot(target, "one-f", 5)
    s.dot(PORT, "tip", 5)
    s.label(PORT, 12, 5, "port", "bold")
    s.label(target, -12, 5, "asked for", "", "end")
    s.label((-40.0, -34.0), 0, 0, "bone", "muted", "middle")
    p.text(20, 502, f"{len(way) - 1} cycles, in {limited} of them a part of the instrument holds it back; "
                    "drawn: every tenth", "small muted")
    p.save("instrument.svg")
    print(f"draw: the tip ends {math.dist(places(way[-1][0])[2], target):.2f} mm from what was asked for")
