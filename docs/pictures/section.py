# SPDX-License-Identifier: BSD-3-Clause
"""What the pictures of `draw` are made with: vectors of the plane, steps that keepout makes, SVG."""

import contextlib
import csv
import json
import math
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
KEEPOUT = os.environ.get("KEEPOUT", ROOT / "build/release/apps/keepout/keepout")


# --- vectors of the plane -------------------------------------------------------------------------

def add(a, b):
    return a[0] + b[0], a[1] + b[1]


def sub(a, b):
    return a[0] - b[0], a[1] - b[1]


def times(s, a):
    return s * a[0], s * a[1]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


def unit(a):
    return times(1 / math.hypot(*a), a)


def left_of(a):
    return -a[1], a[0]


def meet(n, b, m, c):
    """The point u with n . u = b and m . u = c."""
    det = n[0] * m[1] - n[1] * m[0]
    return (b * m[1] - c * n[1]) / det, (n[0] * c - m[0] * b) / det


def projected(y, planes):
    """The point nearest to y with normal . u >= offset for at most two planes."""
    allowed = lambda u: all(dot(n, u) >= b - 1e-12 for n, b in planes)
    feet = [y] + [add(y, times(b - dot(n, y), n)) for n, b in planes]
    if len(planes) == 2:
        feet.append(meet(*planes[0], *planes[1]))
    return min(filter(allowed, feet), key=lambda u: math.dist(u, y))


# --- keepout --------------------------------------------------------------------------------------

def split(profile, piece):
    """The profile with points no farther apart than about `piece`."""
    points = [profile[0]]
    for a, b in zip(profile, profile[1:]):
        n = max(1, round(math.dist(a, b) / piece))
        points += [add(a, times(i / n, sub(b, a))) for i in range(1, n + 1)]
    return points


def prism(points, piece, half=9.0):
    """Triangles of the profile drawn out along the third axis, from -half to half; their normals point
    to its left."""
    rows = round(2 * half / piece)
    heights = [-half + 2 * half * i / rows for i in range(rows + 1)]
    triangles = []
    for p, q in zip(points, points[1:]):
        for low, high in zip(heights, heights[1:]):
            a, b, c, d = (*p, low), (*q, low), (*q, high), (*p, high)
            triangles += [(a, c, b), (a, d, c)]
    return triangles


def write_stl(path, triangles):
    path.write_bytes(bytes(80) + struct.pack("<I", len(triangles)) +
                     b"".join(struct.pack("<12fH", 0, 0, 0, *a, *b, *c, 0) for a, b, c in triangles))


@contextlib.contextmanager
def served(triangles, *settings):
    """Yields a function that sends a request to `keepout serve` over a mesh and returns the answer, and a directory."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        write_stl(folder / "mesh.stl", triangles)
        server = subprocess.Popen([KEEPOUT, "serve", folder / "mesh.stl", *map(str, settings)], stdin=subprocess.PIPE,
                                  stdout=subprocess.PIPE, text=True, stderr=subprocess.DEVNULL)

        def ask(**request):
            server.stdin.write(json.dumps(request) + "\n")
            server.stdin.flush()
            answer = json.loads(server.stdout.readline())
            if not answer.get("ok"):
                raise SystemExit(f"draw: {answer}")
            return answer

        yield ask, folder
        server.stdin.close()
        server.wait()


def replay(mesh, poses, *settings):
    """Rows of STEPS.csv and PLANES.csv. `mesh`: triangles, or the path of a file."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        if not isinstance(mesh, pathlib.Path):
            write_stl(folder / "mesh.stl", mesh)
            mesh = folder / "mesh.stl"
        lines = [" ".join(map(repr, map(float, pose))) for pose in poses]
        (folder / "poses").write_text("\n".join(lines) + "\n")
        subprocess.run(
            [KEEPOUT, "replay", mesh, "--poses", folder / "poses", "--out", folder / "steps.csv",
             "--planes", folder / "planes.csv", *map(str, settings)],
            check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return [list(csv.DictReader((folder / name).read_text().splitlines()))
                for name in ("steps.csv", "planes.csv")]


def solved(mesh, tip, y, *settings):
    """One step in the plane: its status, the motion, and the planes in the order in which they were
    met."""
    # Off the rows of vertices, so that it is faces that are met, as it would be on anatomy.
    steps, planes = replay(mesh, [(*tip, 0.017, *y, 0)], *settings)
    u = [float(steps[0][name]) for name in ("ux", "uy", "uz")]
    if abs(u[2]) > 1e-7:
        sys.exit(f"draw: {u} is not in the plane")
    planes = [((float(p["nx"]), float(p["ny"])), float(p["offset"])) for p in planes]
    return steps[0]["status"], tuple(u[:2]), planes


def step(mesh, tip, y, *settings):
    """The same of a step that planes hold back, and lead to the motion."""
    status, u, planes = solved(mesh, tip, y, *settings)
    if status != "limited":
        sys.exit(f"draw: not a step to be drawn: {status}, {u}")
    if math.dist(projected(y, planes), u) > 1e-6:
        sys.exit(f"draw: the planes do not lead to the motion {u}")
    return u, planes


def closed_loop(mesh, start, goals, *settings):
    """Where the tip is led, from the start on, as it follows a goal in each cycle."""
    poses = [(*goal, 0.017, *start, 0.017) for goal in goals]
    steps, _ = replay(mesh, poses, "--closed-loop", *settings)
    at = lambda row, axis: float(row["p" + axis]) + float(row["u" + axis])
    return [start] + [(at(row, "x"), at(row, "y")) for row in steps]


# --- SVG ------------------------------------------------------------------------------------------

STYLE = """
    text { font-family: -apple-system, "Segoe UI", "Noto Sans", Helvetica, Arial, sans-serif;
           font-size: 14.5px; fill: #1f2933; }
    .halo { paint-order: stroke; stroke: #fbfaf7; stroke-width: 4px; stroke-linejoin: round; }
    .small { font-size: 13px; }
    .bold { font-weight: 600; }
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
        self.put(f'<path class="rule" d="M{a[0]:.1f} {a[1]:.1f}L{b[0]:.1f} {b[1]:.1f}"/>')

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
        self.picture, self.box, self.centre, self.scale = picture, box, centre, scale
        self.id = f"window{len(picture.parts)}"
        x, y, w, h = box
        picture.put(f'<clipPath id="{self.id}"><rect x="{x}" y="{y}" width="{w}" height="{h}" '
                    'rx="6"/></clipPath>')

    def at(self, p):
        x, y, w, h = self.box
        return (x + w / 2 + self.scale * (p[0] - self.centre[0]),
                y + h / 2 - self.scale * (p[1] - self.centre[1]))

    def path(self, points, style, closed=False):
        d = "M" + "L".join("%.1f %.1f" % self.at(p) for p in points) + ("Z" if closed else "")
        self.picture.put(f'<path class="{style}" d="{d}" clip-path="url(#{self.id})"/>')
        return d

    def body(self, profile):
        """What is below the profile, hatched."""
        below = [(99, profile[-1][1]), (99, -99), (profile[0][0], -99)]
        d = self.path([*profile, *below], "body", True)
        self.picture.put(f'<path fill="url(#hatch)" d="{d}" clip-path="url(#{self.id})"/>')
        self.path(profile, "skin")

    def offset(self, profile, distance):
        """The line `distance` above the profile."""
        points = []
        normals = [left_of(unit(sub(b, a))) for a, b in zip(profile, profile[1:])]
        points.append(add(profile[0], times(distance, normals[0])))
        for p, n, m in zip(profile[1:-1], normals, normals[1:]):
            turn = math.atan2(n[0] * m[1] - n[1] * m[0], dot(n, m))
            if turn >= 0:
                points.append(add(p, times(distance / (1 + dot(n, m)), add(n, m))))
                continue
            start = math.atan2(n[1], n[0])
            arc = [start + turn * i / 24 for i in range(25)]
            points += [add(p, (distance * math.cos(a), distance * math.sin(a))) for a in arc]
        points.append(add(profile[-1], times(distance, normals[-1])))
        self.path(points, "offset")

    def circle(self, centre, radius, style):
        x, y = self.at(centre)
        self.picture.put(f'<circle class="{style}" cx="{x:.1f}" cy="{y:.1f}" '
                         f'r="{self.scale * radius:.1f}" clip-path="url(#{self.id})"/>')

    def dot(self, p, style, radius=4.0):
        x, y = self.at(p)
        self.picture.put(f'<circle class="{style}" cx="{x:.1f}" cy="{y:.1f}" r="{radius}"/>')

    def arrow(self, a, b, color, width, shaft_to=1.0, begin=0.0, head=True):
        """From a to b; the shaft may begin and end on the way."""
        a, b = self.at(a), self.at(b)
        u = unit(sub(b, a))
        long, wide = 7 + 2.6 * width, 2.5 + 1.35 * width
        back = sub(b, times(long, u))
        end = add(a, times(shaft_to, sub(b, a))) if shaft_to < 1 else sub(b, times(long - 2, u))
        start = add(a, times(begin, sub(b, a)))
        self.picture.put(f'<path class="line {color}" stroke-width="{width}" '
                         f'style="stroke-linecap:butt" '
                         f'd="M{start[0]:.1f} {start[1]:.1f}L{end[0]:.1f} {end[1]:.1f}"/>')
        if head:
            p, q = add(back, times(wide, left_of(u))), sub(back, times(wide, left_of(u)))
            corners = "L".join("%.1f %.1f" % corner for corner in (b, p, q))
            self.picture.put(f'<path class="{color}-f" d="M{corners}Z"/>')

    def plane(self, tip, plane, span, style, ticks=True):
        """A line where normal . (p - tip) = offset; short strokes on the side that is not allowed.
        span: from where to where along it, in mm from the foot of the tip."""
        n, b = plane
        foot, along = add(tip, times(b, n)), (n[1], -n[0])
        ends = [add(foot, times(s, along)) for s in span]
        self.path(ends, f"line {style}")
        if not ticks:
            return
        back = times(8 / self.scale, sub(times(0.6, along), n))
        d = ""
        s, stop = span[0] + 6 / self.scale, span[1] - 4 / self.scale
        while s < stop:
            p = add(foot, times(s, along))
            d += "M%.1f %.1fL%.1f %.1f" % (*self.at(p), *self.at(add(p, back)))
            s += 13 / self.scale
        colour = style.split()[0]
        self.picture.put(f'<path class="line {colour} thin" d="{d}" clip-path="url(#{self.id})"/>')

    def along(self, tip, plane, where):
        """A point of a plane, as in `plane`."""
        n, b = plane
        return add(add(tip, times(b, n)), times(where, (n[1], -n[0])))

    def label(self, place, dx, dy, words, style="", anchor="start"):
        x, y = self.at(place)
        self.picture.text(x + dx, y + dy, words, style + " halo", anchor)

    def leader(self, a, b):
        """From a place on the page to a place in the section."""
        self.picture.put('<path class="leader" d="M%.1f %.1fL%.1f %.1f"/>' % (*a, *self.at(b)))

    def gap(self, a, b):
        """A distance, with an arrow at both ends."""
        a, b = self.at(a), self.at(b)
        u = unit(sub(b, a))
        d = "M%.1f %.1fL%.1f %.1f" % (*a, *b)
        for p, w in ((a, u), (b, times(-1, u))):
            for side in (1, -1):
                q = add(p, add(times(6, w), times(3 * side, left_of(w))))
                d += "M%.1f %.1fL%.1f %.1f" % (*p, *q)
        self.picture.put(f'<path class="leader" style="stroke-width:1.3" d="{d}"/>')

    def swing(self, pivot, n, m, radius, color):
        """An arrow along an arc, from the line with normal n to that with normal m."""
        start, stop = (math.atan2(-k[0], k[1]) for k in (n, m))
        start, stop = start + (stop - start) * 0.12, start + (stop - start) * 0.86
        points = [add(pivot, (radius * math.cos(a), radius * math.sin(a)))
                  for a in (start + (stop - start) * i / 24 for i in range(25))]
        self.path(points, f"line {color} thin")
        self.arrow(points[-3], points[-1], color, 1.2, shaft_to=0.5)

    def ruler(self, length, words, x, y):
        w = self.scale * length
        self.picture.put(f'<path class="leader" style="stroke-width:1.5" '
                         f'd="M{x} {y - 4}v8m0 -4h{w:.1f}m0 -4v8"/>')
        self.picture.text(x + w + 8, y + 4.5, words, "small muted")
