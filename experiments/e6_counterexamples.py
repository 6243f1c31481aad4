# SPDX-License-Identifier: BSD-3-Clause
"""E6: small meshes on which the algorithm of Li et al. (2020), or some reading of it, fails (section III).

Section III-B enumerates the local cases and finds the algorithm complete. Here are nine meshes of a few triangles,
each with one desired motion. The judge decides if the motion that a rule allows passes through. We found the meshes
by search; one of them is closed and well made. docs/activation.md explains each failure.
"""
from __future__ import annotations

import keepout
import keepout_peers
import numpy as np

from . import figures
from .experiment import Claim, Findings, Row, Scale, Table, Unit
from .modes import FIXTURES, make_rule
from .rules.native import terrain_of
from .rules.rule import Task

NAME = "e6_counterexamples"
TITLE = "E6 Counterexamples (section III)"

MARGIN = 0.001  # [mm]
CYCLES = 20  # the desired motion is repeated


def units(scale: Scale) -> list[Unit]:
    return [Unit(mode, {"mode": mode}) for mode in FIXTURES]


def run(unit: Unit) -> list[Row]:
    """Returns a row for each counterexample."""
    rows: list[Row] = []
    for name, vertices, triangles, tip, desired, radius in keepout_peers.counterexamples():
        mesh = keepout.Mesh(vertices, triangles)
        judge = terrain_of(mesh).judge()
        task = Task(mesh, margin=MARGIN, radius=radius)
        rule = make_rule(unit.settings["mode"], task)
        assert rule is not None, "a fixture has a rule"
        places = [np.array(tip)]
        for _ in range(CYCLES):
            places.append(places[-1] + rule.step(places[-1], desired))
        ways = np.array(places)
        # A tip that starts on the surface touches it: only a motion through the surface counts.
        starts_free = judge.distances(ways[:1])[0] != 0.0
        through = judge.crossings(ways[:-1], ways[1:]) if starts_free else np.zeros(CYCLES, bool)
        rows.append(
            {
                "example": name,
                "mode": unit.settings["mode"],
                "closed": judge.closed,
                "first_step_passes": bool(through[0]),
                "passes": bool(through.any()),
                "first_share": float(np.linalg.norm(ways[1] - ways[0]) / np.linalg.norm(desired)),
            }
        )
    return rows


def findings(rows: list[Row], scale: Scale) -> Findings:
    examples = list(dict.fromkeys(row["example"] for row in rows))
    of = {(row["example"], row["mode"]): row for row in rows}
    passed = {m: [e for e in examples if of[e, m]["passes"]] for m in FIXTURES}

    def said(mode: str) -> str:
        return f"{len(passed[mode])} of {len(examples)} passed through"

    def cell(row: Row) -> str:
        if row["first_step_passes"]:
            return "passes at once"
        return "passes later" if row["passes"] else "held"

    fewest = min(len(p) for p in passed.values())
    closed = [e for e in examples if of[e, "paper"]["closed"]]
    on_closed = ", ".join(f"{e}: {cell(of[e, 'paper'])}" for e in closed)
    return Findings(
        f"The paper's rule on the closed mesh, {on_closed}. On all meshes, {said('paper')} "
        f"({', '.join(passed['paper']) or 'none'}). Certified: {said('certified')}.",
        claims=[
            Claim(
                about="completeness: local cases in which the tip passes through (III-B)",
                paper="none",
                reproduction=said("paper"),
                certified=said("certified"),
                best=", ".join(figures.label(m) for m in FIXTURES if len(passed[m]) == fewest),
                sure="each is a proof by example, judged in exact arithmetic",
                note="a neighbor with a nearer closest point replaces a triangle, and its plane "
                "may not cover that triangle",
            )
        ],
        tables=[
            Table(
                f"Each rule on each counterexample, {CYCLES} cycles",
                ["mesh", "closed", *map(figures.label, FIXTURES)],
                [
                    [e, "yes" if of[e, "paper"]["closed"] else "no"]
                    + [cell(of[e, m]) for m in FIXTURES]
                    for e in examples
                ],
                "These meshes are a few millimeters large, so coarse grids cannot represent them. "
                "On CE4 the tip starts on the surface, which counts as held.",
            )
        ],
    )
