# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of docs/concepts.md and docs/README.md; see `draw`, which draws them."""

import sys

import keepout
import numpy as np

from section import HEIGHT, Picture, Section, closed_loop, dot, math_of, prism, solved, split, unit, xy


def tissue(x):
    """A hill and a fold."""
    return (0.95 * np.exp(-((x + 1.6) / 1.0) ** 2) - 1.15 * np.exp(-((x - 1.55) / 0.62) ** 2) +
            0.12 * np.sin(1.7 * x))


def profile_of(height, low, high, piece):
    x = np.linspace(low, high, round((high - low) / piece) + 1)
    return x + 1j * height(x)


def nearest_of(p, profile):
    """Returns the point nearest to p on each segment of a profile."""
    starts, along = np.array(profile[:-1]), np.diff(profile)
    return starts + np.clip(dot(p - starts, along) / abs(along) ** 2, 0, 1) * along


def nearest(p, profile):
    return min(nearest_of(p, profile), key=lambda q: abs(q - p))


def fixture():
    profile = profile_of(tissue, -5.5, 5.5, 0.22)
    radius, margin = 0.22, 0.1
    m = radius + margin
    x = np.linspace(-4.3, 4.3, 121)
    sunk = np.clip(np.minimum(x + 3.4, 3.6 - x) / 0.7, 0, 1)
    hand = x + 1j * (tissue(x) - 0.55 * sunk + 0.75 * (1 - sunk))
    tips = closed_loop(prism(profile, 0.22), hand[0] + 0.05j, hand, 0.4, tool_radius=radius, margin=margin)[1:]

    p = Picture(720, 372, "A forbidden-region fixture",
                "A section through tissue. The hand's way goes under the surface; the tool's way stays "
                "the tool radius and the margin off it. Thin lines join the two.")
    s = Section(p, (8, 8, 704, 356), 0.05j, 78)
    s.body(profile)
    s.offset(profile, m)
    for i in range(8, 116, 6):
        if abs(hand[i] - tips[i]) > 0.12:
            s.path([hand[i], tips[i]], "asked thin")
    s.path(hand, "line asked firm dashed")
    s.path(tips, "line made strong")
    for i in (22, 60, 86):
        s.circle(tips[i], radius, "tool firm")
        s.dot(tips[i], "tip", 4.2)
        s.dot(hand[i], "asked-f", 4.2)
    s.label(tips[22], -14, -25, "tool", "bold made-t", "end")
    s.label(hand[22], 4, 24, "hand", "bold asked-t")
    s.label(-4.25 + 1.55j, 0, 0, "free", "muted small")
    s.label(0.55 + 1.75j, 0, 0, "the tool's way: as near to the hand's", "made-t")
    s.label(0.55 + 1.75j, 0, 18, "as the surface allows", "made-t")
    s.label(2.9 - 1.3j, 0, 0, "the hand's way", "asked-t", "middle")
    p.text(22, 350, "anatomy, cut: the forbidden region", "small muted halo")
    s.ruler(0.5, "0.5 mm", 600, 346)
    p.save("fixture.svg")


def candidates():
    profile = profile_of(tissue, -5.0, 5.0, 0.23)
    tip, reach = 0.35 + 0.78j, 0.95
    p = Picture(720, 398, "Motion sphere, candidates, hits",
                "A section through tissue with a ball around the tip. Boxes around four triangles each; "
                "those that touch the ball give candidates; triangles in the ball are hits, each with its "
                "closest point.")
    s = Section(p, (8, 8, 704, 318), 0.2 + 0.32j, 104)
    s.body(profile)
    s.circle(tip, reach, "ball")
    hits = candidates_ = 0
    for first in range(0, len(profile) - 1, 4):
        group = profile[first:first + 5]
        left, right, low, high = group.real.min(), group.real.max(), group.imag.min(), group.imag.max()
        touched = abs(complex(np.clip(tip.real, left, right), np.clip(tip.imag, low, high)) - tip) <= reach
        s.path([complex(left, low), complex(right, low), complex(right, high), complex(left, high)],
               "line trial thin" if touched else "leader", True)
        for a, b, q in zip(group, group[1:], nearest_of(tip, group)) if touched else ():
            hit = abs(q - tip) <= reach
            hits, candidates_ = hits + hit, candidates_ + 1
            s.path([a, b], f"line {'made' if hit else 'trial'}", False)
            p.parts[-1] = p.parts[-1].replace('class="', 'stroke-width="5" class="')
            if hit:
                s.path([tip, q], "made thin faint line")
                s.dot(q, "made-f", 3.2)
    for q in profile:
        s.dot(q, "knot", 2.2)
    s.dot(tip, "tip", 5)
    s.label(tip, -10, -10, "tip", "bold", "end")
    s.label(tip + complex(reach, 0.35), 8, 0, "motion sphere: as far", "small")
    s.label(tip + complex(reach, 0.35), 8, 17, "as the tip may go in a cycle", "small")
    for row, color, words in (
            (347, "leader", "box of the index that is clear of the ball: never opened"),
            (368, "trial", f"box that touches it: {candidates_} candidates, each asked about by the exact "
                           "kernel"),
            (389, "made", f"{hits} hits: triangles in the ball, with their closest points")):
        style = "leader" if color == "leader" else f"line {color}"
        p.put(f'<path class="{style}" stroke-width="4" d="M24 {row - 8}h26"/>')
        p.text(62, row - 3, words, "small")
    p.save("candidates.svg")


def rules():
    profile = [-3.5 - 0.62j, -1.0 - 0.2j, 0j, 0.62 - 1.1j, 0.85 - 3.5j]
    tip, y, m = -0.75 + 0.42j, 1.95 - 1.35j, 0.2
    mesh = prism(profile, 18.0)  # one strip, so that all closest points are in the section
    p = Picture(720, 360, "Three rules over a ridge",
                "The same motion asked for over a ridge under three rules: all_faces and paper stop high "
                "above it, certified passes close by.")
    for i, (rule, color, words) in enumerate((
            ("all_faces", "two", ("every face in reach,", "also where it leads away")),
            ("paper", "trial", ("planes of the nearest points", "of both: no better here")),
            ("certified", "made", ("only what is in the way,", "turned to where it ends")))):
        status, u, planes = solved(mesh, tip, y, activation=rule, margin=m, radius=3)
        s = Section(p, (8 + 236 * i, 8, 232, 276), 0.28 - 0.42j, 78)
        s.body(profile)
        s.offset(profile, m)
        shown = []
        for n, b in planes:
            if abs(n) >= 0.999 and all(abs(n - m) + abs(b - c) > 1e-6 for m, c in shown):
                shown.append((n, b))
                s.plane(tip, (n, b), (-2.0, 3.2), "one firm")
        end = lambda v: tip + v
        s.path([end(u), end(y)], "tool firm")
        s.arrow(tip, end(y), "asked", 2.6)
        s.arrow(tip, end(u), color, 4)
        s.dot(tip, "tip", 4.5)
        s.label(end(y), 4, 18, "asked for", "asked-t small", "middle")
        p.text(22 + 236 * i, 32, rule, f"code bold halo {color}-t")
        p.text(22 + 236 * i, 308, f"{abs(u - y):.2f} mm off", "small bold")
        for line, text in enumerate(words):
            p.text(22 + 236 * i, 328 + 18 * line, text, "small muted")
        print(f"draw: {rule}: {status}, {len(planes)} planes")
    for x in (242, 478):
        p.rule(x + 20j, x + 346j)
    p.save("rules.svg")


def rim():
    sheet = [-3.5 + 0j, 0j]
    tip, y, m = 0.3 + 0.55j, -1.5 - 1.2j, 0.2
    mesh = prism(split(sheet, 0.5), 18.0)
    p = Picture(720, 322, "At the rim of an open sheet",
                "A tip beside the rim of a sheet is asked to go through it. Under the paper's rule no "
                "plane is posed and it goes through; the certified rule leads it along the sheet.")
    for i, (rule, color, words) in enumerate((
            ("paper", "bad", "The nearest points lie on rims and edges: no plane, and the tip goes through."),
            ("certified", "made", "The motion itself is asked about. What it meets first gets a plane."))):
        status, u, planes = solved(mesh, tip, y, activation=rule, margin=m, radius=3)
        passes = (tip + u).imag < 0
        if passes != (rule == "paper"):
            sys.exit(f"draw: rim: {rule} led to {u}")
        s = Section(p, (8 + 356 * i, 8, 348, 262), -0.45 + 0.02j, 112)
        s.path(sheet, "skin")
        s.path([-3.5 + 1j * m, *1j * m * np.exp(-1j * np.linspace(0, np.pi, 25)), -3.5 - 1j * m], "offset")
        end = lambda v: tip + v
        for plane in planes[:2]:
            s.plane(tip, plane, (-1.4, 1.4), "one firm")
        if not passes:
            s.arrow(tip, end(y), "asked", 2.6)
            s.label(end(y), -8, 18, "asked for", "asked-t small", "middle")
        s.arrow(tip, end(u), color, 4.2)
        s.dot(tip, "tip", 5)
        s.label(tip, 10, -8, "tip", "bold")
        s.label(-1.5, 0, 42, "an open sheet", "small muted", "middle")
        p.text(22 + 356 * i, 35, rule, f"code bold halo {color}-t")
        for line, text in enumerate((words[:words.index(" ", 42)], words[words.index(" ", 42) + 1:])):
            p.text(22 + 356 * i, 288 + 18 * line, text, "small")
        print(f"draw: rim: {rule}: {status}, {len(planes)} planes")
    p.rule(360 + 20j, 360 + 310j)
    p.save("rim.svg")


def margin():
    floor = [-4.0 - 0.2j, -0.6 + 0.05j, 4.0 - 0.1j]
    tool, offset = 0.55, 0.2
    m = tool + offset
    tip = -0.9 + 1.75j
    status, u, planes = solved(prism(split(floor, 0.4), 0.4), tip, 0.9 - 1.9j, tool_radius=tool, margin=offset)
    p = Picture(720, 330, "Tool radius and margin",
                "Left: a tool of a radius that rests at the margin above a surface; the distance kept from "
                "the tip is their sum. Right: a slot narrower than twice that, which the tip does not enter.")
    s = Section(p, (8, 8, 348, 280), 0.75j, 112)
    s.body(floor)
    s.offset(floor, m)
    end = tip + u
    s.arrow(tip, end, "made", 3.4)
    s.circle(end, tool, "ball")
    s.circle(end, m, "grown")
    s.dot(end, "tip", 5)
    s.dot(tip, "asked-f", 4)
    foot = nearest(end, floor)
    down = unit(foot - end)
    s.gap(end, end + tool)
    s.label(end + tool / 2, 0, -8, "tool radius", "small", "middle")
    s.gap(end + tool * down, foot)
    s.label(end + (tool + offset / 2) * down, 12, 5, "margin", "small")
    s.gap(end, end - m)
    s.label(end - m / 2, 0, -8, math_of("m"), "", "middle")
    p.text(22, 310, "kept from the tip: " + math_of("m") + " = tool radius + margin", "small")
    print(f"draw: margin: {status}, {abs(foot - end):.4f}")

    wide = 0.5
    slot = [-3.0 + 0.6j, -wide + 0.6j, -wide - 1.6j, wide - 1.6j, wide + 0.6j, 3.0 + 0.6j]
    goals = 0.15 + 1j * np.linspace(0.4, -0.3, 61)
    tips = closed_loop(prism(split(slot, 0.25), 0.25), -0.9 + 1.9j, goals, 0.1, tool_radius=tool, margin=offset)
    s = Section(p, (364, 8, 348, 280), 0.62j, 104)
    s.body(slot)
    s.path(tips, "line made strong")
    s.circle(tips[-1], tool, "ball")
    s.circle(tips[-1], m, "grown")
    s.dot(tips[-1], "tip", 5)
    s.dot(goals[-1], "asked-f", 4.5)
    s.label(goals[-1], 9, 5, "goal", "small asked-t")
    p.text(378, 310, "A slot narrower than 2 " + math_of("m") + ": it stays at the mouth.", "small")
    p.rule(360 + 20j, 360 + 318j)
    print(f"draw: slot: ends {abs(nearest(tips[-1], slot) - tips[-1]):.4f} off")
    p.save("margin.svg")


def polytope():
    profile = profile_of(tissue, -5.5, 5.5, 0.22)
    tip, tool, offset, radius = 0.75 + 0.55j, 0.15, 0.1, 1.55
    guard = keepout.MotionConstraint(prism(profile, 0.22), tool_radius=tool, margin=offset)
    planes = guard.free_polytope((tip.real, tip.imag, HEIGHT), radius)
    # Cut by the plane of the section: what they allow of motions in it.
    normals = planes.normals[:, 0] + 1j * planes.normals[:, 1]
    cut = [(n, b) for n, b in zip(normals, planes.offsets) if abs(n) > 1e-9]
    region = list(radius * np.exp(1j * np.linspace(0, 2 * np.pi, 360, endpoint=False)))
    for n, b in cut:
        clipped = []
        for u, v in zip(region, region[1:] + region[:1]):
            at_u, at_v = dot(n, u) - b, dot(n, v) - b
            if at_u >= 0:
                clipped.append(u)
            if at_u * at_v < 0:
                clipped.append(u + at_u / (at_u - at_v) * (v - u))
        region = clipped
    touching = [(unit(n), b / abs(n)) for n, b in cut if min(dot(n, u) - b for u in region) < 1e-9]

    p = Picture(720, 362, "The free polytope",
                "A section through tissue. Within the ball around the tip, planes bound a convex region in "
                "which every motion is free.")
    s = Section(p, (8, 8, 704, 346), 0.8 + 0.5j, 92)
    s.body(profile)
    s.circle(tip, radius, "grown")
    s.path([tip + u for u in region], "ball", True)
    for n, b in touching:
        s.plane(tip, (n, b), (-1.9, 1.9), "one firm")
    s.dot(tip, "tip", 5)
    s.label(tip, 10, -8, "tip", "bold")
    s.label(tip + 1j * radius, 0, -9, "radius", "small muted", "middle")
    s.label(tip - 0.15 + 0.72j, 0, 0, "any motion in here is free,", "small", "middle")
    s.label(tip - 0.15 + 0.72j, 0, 17, "straight or curved", "small", "middle")
    p.text(22, 340, "anatomy, cut", "small muted halo")
    print(f"draw: polytope: {len(planes)} planes, {len(touching)} in the section")
    s.ruler(0.5, "0.5 mm", 590, 336)
    p.save("polytope.svg")


def pipeline():
    p = Picture(600, 312, "From the mesh to the step",
                "Mesh, index, candidates, exact hits, planes, problem, step: each stage passes its result to the next. "
                "By default the index passes the triangles along each trial motion to the rule.")
    wide, high, rows = 126, 80, (52, 176)
    left = lambda column: 18 + column * (wide + 20)

    def arrow(style, *points):
        u = unit(points[-1] - points[-2])
        p.put(f'<path class="line {style} firm" d="M{"L".join(map(xy, [*points[:-1], points[-1] - 5 * u]))}"/>')
        corners = (points[-1], points[-1] - (9 - 5j) * u, points[-1] - (9 + 5j) * u)
        p.put(f'<path class="{style.split()[0]}-f" d="M{"L".join(map(xy, corners))}Z"/>')

    middles = []
    for i, (color, name, *words) in enumerate((
            ("asked", "mesh", "triangles of", "the anatomy"),
            ("asked", "index", "finds triangles", "near the tip"),
            ("trial", "candidates", "may touch the", "motion sphere"),
            ("trial", "exact hits", "touch it; with", "closest points"),
            ("one", "planes", "the rule makes", "them from hits"),
            ("two", "problem", "nearest motion", "in the planes"),
            ("made", "step", "motion, status", "and reason"))):
        x, y = left(i if i < 4 else 7 - i), rows[i > 3]
        middles.append(complex(x + wide / 2, y + high / 2))
        p.put(f'<rect class="line {color} firm" x="{x}" y="{y}" width="{wide}" height="{high}" rx="8"/>')
        for line, style, words_ in zip((26, 48, 65), (f"name {color}-t", "small", "small"), (name, *words)):
            p.text(x + wide / 2, y + line, words_, style, "middle")
    for a, b in zip(middles, middles[1:]):
        u = unit(b - a)
        half = abs(u.real) * wide / 2 + abs(u.imag) * high / 2
        arrow("asked", a + half * u, b - half * u)
    index, planes, problem, step = (middles[i] for i in (1, 4, 5, 6))
    down, out = 1j * high / 2, wide / 2
    arrow("one dashed", index - down, complex(index.real, 34), complex(592, 34), complex(592, planes.imag), planes + out)
    p.text(index.real + 8, 25, "by default: only the triangles along each trial motion", "small")
    arrow("asked", problem - down - 24j, problem - down)
    p.text(problem.real - 8, rows[1] - 12, "desired increment", "small", "end")
    arrow("one", step + down, step + down + 24j, planes + down + 24j, planes + down)
    p.text(problem.real, rows[1] + high + 44, "the rule rejects the motion: one more plane", "small", "middle")
    arrow("made", step - out, step - out - 38)
    p.text(left(0) + 42, step.imag - 4, "robot", "name", "middle")
    p.text(left(0) + 42, step.imag + 16, "zero motion", "small", "middle")
    p.text(left(0) + 42, step.imag + 33, "after a failure", "small", "middle")
    p.save("pipeline.svg")


PICTURES = {"fixture": fixture, "candidates": candidates, "rules": rules, "rim": rim, "margin": margin,
            "polytope": polytope, "pipeline": pipeline}
