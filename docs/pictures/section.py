# SPDX-License-Identifier: BSD-3-Clause
"""Parts of the pictures of `draw`: steps that keepout makes in a plane, and SVG. Points are complex numbers."""

import cmath
import pathlib
import re
import sys

import keepout
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent


# --- the plane ------------------------------------------------------------------------------------

def dot(a, b):
    return (a * b.conjugate()).real


def unit(a):
    return a / abs(a)


def meet(n, b, m, c):
    """Returns the point u with n . u = b and m . u = c."""
    return 1j * (c * n - b * m) / (n.conjugate() * m).imag


def projected(y, planes):
    """Returns the point nearest to y with normal . u >= offset for at most two planes."""
    feet = [y] + [y + (b - dot(n, y)) * n for n, b in planes]
    if len(planes) == 2:
        feet.append(meet(*planes[0], *planes[1]))
    return min((u for u in feet if all(dot(n, u) >= b - 1e-12 for n, b in planes)), key=lambda u: abs(u - y))


# --- keepout --------------------------------------------------------------------------------------

# Steps are between the rows of vertices, so that the tip meets faces, as it would on anatomy.
HEIGHT = 0.017


def split(profile, piece):
    """Returns the profile with points no farther apart than about `piece`."""
    parts = [np.linspace(a, b, max(1, round(abs(b - a) / piece)) + 1)[1:] for a, b in zip(profile, profile[1:])]
    return np.concatenate([profile[:1], *parts])


def prism(points, piece, half=9.0):
    """Returns the mesh of a profile extruded along the third axis, from -half to half. Its normals point to the
    left of the profile."""
    heights = np.linspace(-half, half, round(2 * half / piece) + 1)
    flat = np.repeat(points, len(heights))
    vertices = np.stack([flat.real, flat.imag, np.tile(heights, len(points))], axis=1).astype(np.float32)
    number = np.arange(len(flat)).reshape(len(points), -1)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    return keepout.Mesh(vertices, np.stack([a, c, b, a, d, c], axis=-1).reshape(-1, 3))


def solved(mesh, tip, y, **options):
    """Returns the status of one step in the plane, the motion, and the planes in the order in which they were met."""
    made = keepout.MotionConstraint(mesh, **options).step((tip.real, tip.imag, HEIGHT), (y.real, y.imag, 0))
    if abs(made.motion[2]) > 1e-7:
        sys.exit(f"draw: {made.motion} is not in the plane")
    planes = [(complex(*n[:2]), b) for n, b in zip(made.planes.normals, made.planes.offsets)]
    return made.status, complex(*made.motion[:2]), planes


def step(mesh, tip, y, **options):
    """Like solved(), but without the status: it fails unless the planes limit the motion, and lead to it."""
    status, u, planes = solved(mesh, tip, y, **options)
    if status != keepout.Status.limited:
        sys.exit(f"draw: not a step to be drawn: {status}, {u}")
    if abs(projected(y, planes) - u) > 1e-6:
        sys.exit(f"draw: the planes do not lead to the motion {u}")
    return u, planes


def closed_loop(mesh, start, goals, max_step, **options):
    """Returns the positions of a tip that follows one goal in each cycle, including its start."""
    lifted = lambda points: np.stack([np.real(points), np.imag(points), np.full(len(points), HEIGHT)], axis=1)
    guard = keepout.MotionConstraint(mesh, **options)
    tips = guard.simulate(lifted([start]), [lifted(goals)], max_step=max_step).tips[0]
    return tips[:, 0] + 1j * tips[:, 1]


# --- SVG ------------------------------------------------------------------------------------------

STYLE = """
    text { font-family: -apple-system, "Segoe UI", "Noto Sans", Helvetica, Arial, sans-serif;
           font-size: 14.5px; fill: #1f2933; }
    .halo { paint-order: stroke; stroke: #fbfaf7; stroke-width: 4px; stroke-linejoin: round; }
    .small { font-size: 13px; }
    .bold { font-weight: 600; }
    .name { font-weight: 600; font-size: 18px; }
    .math { font-family: Georgia, "Times New Roman", "Noto Serif", serif; font-style: italic;
            font-size: 17px; }
    .code { font-family: ui-monospace, SFMono-Regular, Menlo, Consolas, monospace; }
    .muted { fill: #59636e; }
    .card { fill: #fbfaf7; stroke: #d5d0c5; }
    .rule { stroke: #ddd8cd; }
    .leader { stroke: #8a929b; fill: none; stroke-width: 1; }
    .body { fill: #e9dfcd; }
    .hatch { stroke: #d2c2a5; stroke-width: 1.6; }
    .skin { fill: none; stroke: #7a6542; stroke-width: 2.2; stroke-linejoin: round; }
    .knot { fill: #7a6542; }
    .offset { fill: none; stroke: #7a6542; stroke-width: 1.1; }
    .ball { fill: #4a90d9; fill-opacity: .13; stroke: #4a7fb5; stroke-width: 1.2; }
    .grown { fill: none; stroke: #4a7fb5; stroke-width: 1.3; stroke-dasharray: 6 5; }
    .tool { fill: none; stroke: #59636e; stroke-width: 1; stroke-dasharray: 2 3; }
    .tip { fill: #1f2933; }
    .line { fill: none; stroke-linecap: round; }
    .asked { stroke: #858d96; } .asked-f { fill: #858d96; } .asked-t { fill: #626b75; }
    .trial { stroke: #d9851e; } .trial-f { fill: #d9851e; } .trial-t { fill: #a35a06; }
    .bad { stroke: #d3232f; } .bad-f, .bad-t { fill: #c21f2b; }
    .made { stroke: #0b5fd0; } .made-f, .made-t { fill: #0b5fd0; }
    .one { stroke: #15803d; } .one-f, .one-t { fill: #15803d; }
    .two { stroke: #8a3fc7; } .two-f, .two-t { fill: #8a3fc7; }
    .thin { stroke-width: 1.2; } .firm { stroke-width: 2; } .strong { stroke-width: 2.6; }
    .dashed { stroke-dasharray: 8 6; } .faint { opacity: .62; }
    .badge { fill: #fff; font-weight: 700; font-size: 13px; text-anchor: middle; }
    @media (prefers-color-scheme: dark) {
      text { fill: #e6e9ed; }
      .halo { stroke: #171b21; }
      .muted { fill: #a3adb8; }
      .card { fill: #171b21; stroke: #343b45; }
      .rule { stroke: #343b45; }
      .leader { stroke: #77818c; }
      .body { fill: #3b352b; }
      .hatch { stroke: #52493a; }
      .skin, .offset { stroke: #c9ae7f; }
      .knot { fill: #c9ae7f; }
      .ball { fill: #5aa2f0; fill-opacity: .14; stroke: #6ba3dd; }
      .grown { stroke: #6ba3dd; }
      .tool { stroke: #a3adb8; }
      .tip { fill: #f2f4f6; }
      .asked { stroke: #98a1ab; } .asked-f { fill: #98a1ab; } .asked-t { fill: #aeb7c0; }
      .trial { stroke: #eda145; } .trial-f, .trial-t { fill: #eda145; }
      .bad { stroke: #ff5f66; } .bad-f, .bad-t { fill: #ff6b72; }
      .made { stroke: #4d9dff; } .made-f, .made-t { fill: #63a9ff; }
      .one { stroke: #4cc27a; } .one-f, .one-t { fill: #4cc27a; }
      .two { stroke: #c08bf2; } .two-f, .two-t { fill: #c08bf2; }
      .badge { fill: #171b21; }
    }
"""


def math_of(letter, style="", sub=None):
    """A variable within a text."""
    low = f'<tspan dy="4" class="small {style}">{sub}</tspan><tspan dy="-4">&#8203;</tspan>'
    return f'<tspan class="math {style}">{letter}</tspan>' + (low if sub is not None else "")


def xy(p):
    return f"{p.real:.1f} {p.imag:.1f}"


class Picture:
    """An SVG of a given size; y of the page goes down."""

    def __init__(self, width, height, title, description):
        self.parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
            f'width="{width}" height="{height}" role="img" aria-labelledby="title description">',
            f'  <title id="title">{title}</title>',
            f'  <desc id="description">{description}</desc>',
            "  <!-- SPDX-FileCopyrightText: 2026 the keepout authors -->",
            "  <!-- SPDX-License-Identifier: BSD-3-Clause -->",
            f"  <!-- made by docs/pictures/draw -->\n  <style>{STYLE}  </style>",
            '  <defs><pattern id="hatch" width="9" height="9" patternUnits="userSpaceOnUse" '
            'patternTransform="rotate(45)"><path class="hatch" d="M0 0V9"/></pattern></defs>',
            f'  <rect class="card" x=".5" y=".5" width="{width - 1}" height="{height - 1}" '
            'rx="10"/>']

    def put(self, text):
        self.parts.append("  " + text)

    def rule(self, a, b):
        self.put(f'<path class="rule" d="M{xy(a)}L{xy(b)}"/>')

    def text(self, x, y, words, style="", anchor="start"):
        self.put(f'<text x="{x:.1f}" y="{y:.1f}" class="{style}" text-anchor="{anchor}">{words}'
                 "</text>")

    def badge(self, x, y, number, color):
        self.put(f'<circle class="{color}-f" cx="{x:.1f}" cy="{y:.1f}" r="10"/>')
        self.text(x, y + 4.6, number, "badge", "middle")

    def save(self, name):
        """Writes the file, with those rules of STYLE that the picture uses."""
        text = "\n".join(self.parts)
        used = set(" ".join(re.findall(r'class="([^"]*)"', text)).split())
        of_used = lambda rule: rule[0] if used & set(re.findall(r"\.([\w-]+)", rule[0].split("{")[0])) else ""
        style = re.sub(r" *\.[\w-]+(?:, \.[\w-]+)* \{[^}]*\}", of_used, STYLE)
        text = text.replace(STYLE, re.sub(r"\n(?: *\n)+", "\n", style))
        (HERE / name).write_text(text + "\n</svg>\n")
        print(f"draw: {name}")


class Section:
    """A window of a picture onto the plane of the section, in mm."""

    def __init__(self, picture, box, centre, scale):
        """box: x, y, width, height on the page. scale: of one mm."""
        self.picture, self.centre, self.scale = picture, centre, scale
        self.id = f"window{len(picture.parts)}"
        x, y, w, h = box
        self.middle = complex(x + w / 2, y + h / 2)
        picture.put(f'<clipPath id="{self.id}"><rect x="{x}" y="{y}" width="{w}" height="{h}" '
                    'rx="6"/></clipPath>')

    def at(self, p):
        """Returns the place on the page, whose y goes down."""
        return self.middle + self.scale * (p - self.centre).conjugate()

    def path(self, points, style, closed=False):
        d = "M" + "L".join(xy(self.at(p)) for p in points) + ("Z" if closed else "")
        self.picture.put(f'<path class="{style}" d="{d}" clip-path="url(#{self.id})"/>')
        return d

    def hatched(self, outline):
        """The body inside an outline."""
        d = self.path(outline, "body", True)
        self.picture.put(f'<path fill="url(#hatch)" d="{d}" clip-path="url(#{self.id})"/>')

    def body(self, profile):
        """The body below the profile, hatched."""
        self.hatched([*profile, complex(99, profile[-1].imag), 99 - 99j, complex(profile[0].real, -99)])
        self.path(profile, "skin")

    def offset(self, profile, distance):
        """The line `distance` above the profile."""
        edges = np.diff(profile)
        normals = 1j * edges / abs(edges)
        points = [profile[0] + distance * normals[0]]
        for p, n, m in zip(profile[1:-1], normals, normals[1:]):
            turn = cmath.phase(m / n)
            if turn >= 0:
                points.append(p + distance / (1 + dot(n, m)) * (n + m))
            else:
                points.extend(p + distance * n * np.exp(1j * np.linspace(0, turn, 25)))
        self.path([*points, profile[-1] + distance * normals[-1]], "offset")

    def circle(self, centre, radius, style):
        at = self.at(centre)
        self.picture.put(f'<circle class="{style}" cx="{at.real:.1f}" cy="{at.imag:.1f}" '
                         f'r="{self.scale * radius:.1f}" clip-path="url(#{self.id})"/>')

    def dot(self, p, style, radius=4.0):
        at = self.at(p)
        self.picture.put(f'<circle class="{style}" cx="{at.real:.1f}" cy="{at.imag:.1f}" r="{radius}"/>')

    def arrow(self, a, b, color, width, shaft_to=1.0, begin=0.0, head=True):
        """Draws an arrow from a to b; the shaft may cover only a part of it."""
        a, b = self.at(a), self.at(b)
        u = unit(b - a)
        long, wide = 7 + 2.6 * width, 2.5 + 1.35 * width
        end = a + shaft_to * (b - a) if shaft_to < 1 else b - (long - 2) * u
        self.picture.put(f'<path class="line {color}" stroke-width="{width}" '
                         f'style="stroke-linecap:butt" d="M{xy(a + begin * (b - a))}L{xy(end)}"/>')
        if head:
            corners = "L".join(map(xy, (b, b - (long - 1j * wide) * u, b - (long + 1j * wide) * u)))
            self.picture.put(f'<path class="{color}-f" d="M{corners}Z"/>')

    def plane(self, tip, plane, span, style, ticks=True):
        """Draws a line where normal . (p - tip) = offset, with short strokes on the forbidden side.

        span: its two ends along the line, in mm from the foot of the tip."""
        self.path([self.along(tip, plane, s) for s in span], f"line {style}")
        if not ticks:
            return
        back = 8 / self.scale * (-0.6j - 1) * plane[0]
        starts = [self.along(tip, plane, s)
                  for s in np.arange(span[0] + 6 / self.scale, span[1] - 4 / self.scale, 13 / self.scale)]
        d = "".join(f"M{xy(self.at(p))}L{xy(self.at(p + back))}" for p in starts)
        self.picture.put(f'<path class="line {style.split()[0]} thin" d="{d}" clip-path="url(#{self.id})"/>')

    def along(self, tip, plane, where):
        """A point of a plane, as in `plane`."""
        n, b = plane
        return tip + (b - 1j * where) * n

    def label(self, place, dx, dy, words, style="", anchor="start"):
        at = self.at(place)
        self.picture.text(at.real + dx, at.imag + dy, words, style + " halo", anchor)

    def leader(self, a, b):
        """From a place on the page to a place in the section."""
        self.picture.put(f'<path class="leader" d="M{xy(a)}L{xy(self.at(b))}"/>')

    def gap(self, a, b):
        """Draws a distance, with an arrow at both ends."""
        a, b = self.at(a), self.at(b)
        u = unit(b - a)
        d = f"M{xy(a)}L{xy(b)}" + "".join(f"M{xy(p)}L{xy(p + w * u)}" for p, ends in (
            (a, (6 + 3j, 6 - 3j)), (b, (-6 - 3j, -6 + 3j))) for w in ends)
        self.picture.put(f'<path class="leader" style="stroke-width:1.3" d="{d}"/>')

    def swing(self, pivot, n, m, radius, color):
        """An arrow along an arc, from the line with normal n to that with normal m."""
        start, turn = -1j * radius * n, cmath.phase(m / n)
        points = pivot + start * np.exp(1j * np.linspace(0.12 * turn, 0.86 * turn, 25))
        self.path(points, f"line {color} thin")
        self.arrow(points[-3], points[-1], color, 1.2, shaft_to=0.5)

    def ruler(self, length, words, x, y):
        w = self.scale * length
        self.picture.put(f'<path class="leader" style="stroke-width:1.5" '
                         f'd="M{x} {y - 4}v8m0 -4h{w:.1f}m0 -4v8"/>')
        self.picture.text(x + w + 8, y + 4.5, words, "small muted")
