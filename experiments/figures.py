# SPDX-License-Identifier: BSD-3-Clause
"""The style of the figures. A figure is drawn once, for paper and for light and dark pages.

    fig, ax = figures.new(120, 70)
    ax.plot(times, depths, color=figures.color("certified"), label=figures.label("certified"))
    figure = Figure("depth", "Depth over time", "The caption.", figures.svg(fig))

Draw in INK (matplotlib's "black"), SOFT, GRID, PAPER ("white") and the colors of modes, with any opacity. The
function svg() makes each of them a custom property of CSS, with another color on dark pages. It rejects any other
color, and pixel images, which could not change.
"""
from __future__ import annotations

import io
import re
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from numpy.typing import NDArray

MM_OF_INCH = 25.4

INK = "#000000"  # text
SOFT = "#566173"  # axes and remarks
GRID = "#dfe3ea"
PAPER = "#ffffff"


@dataclass(frozen=True)
class Look:
    """The label of a mode, and its color on light and on dark pages."""

    name: str
    light: str
    dark: str


#: The colors of the activation rules on all pages, light and dark, by name.
_of_pages = {rule: colors for rule, *colors in re.findall(
    r"--rule-(\w+): light-dark\((#\w{6}), (#\w{6})\)",
    (Path(__file__).parents[1] / "apps/web/src/page/rule_colors.css").read_text(encoding="utf-8"))}

#: The look of each mode. Colors differ for color-blind eyes too, and have a contrast of 3 : 1 or more. Add yours
#: here; tests/experiments/test_figures.py checks its color.
MODES = {
    "none": Look("no fixture", *_of_pages["none"]),
    "all_faces": Look("all faces", *_of_pages["all_faces"]),
    "paper": Look("the paper's rule", *_of_pages["paper"]),
    "certified": Look("certified", *_of_pages["certified"]),
    "closest_points_2007": Look("closest points (2007)", "#3e1ae8", "#7853fc"),
    "vector_field": Look("vector field", "#850760", "#b03ead"),
    "distance_field": Look("distance field", "#615503", "#dad00b"),
    "fcl_slide": Look("FCL, sliding", "#3d020d", "#e66072"),
    "bullet_slide": Look("Bullet, sliding", "#5e099b", "#ecdcee"),
}

#: The colors of a rule of your own (`--rule`), whose label is its name.
OWN = Look("", "#9e59fe", "#fd1d17")

#: The modes that others are compared with: their boxes are fuller, and their names bold.
STRESSED = ("paper", "certified")

#: By the name of the custom property; _DRAWN maps the drawn color to that name.
_LOOKS = {
    "ink": Look("", "#17202e", "#e8edf4"),
    "soft": Look("", SOFT, "#9eabbd"),
    "grid": Look("", GRID, "#2c3745"),
    "paper": Look("", PAPER, "#18202b"),
    "own": OWN,
} | {"mode-" + mode.replace(".", "-"): look for mode, look in MODES.items()}
_DRAWN = {INK: "ink"} | {look.light: name for name, look in _LOOKS.items() if name != "ink"}

matplotlib.rcdefaults()  # not the user's preferences: the same bytes everywhere
matplotlib.rcParams.update({
    "svg.fonttype": "none",
    "svg.hashsalt": "keepout",
    "font.sans-serif": ["DejaVu Sans"],  # wider than the displayed font, so that text does not overlap
    "font.size": 9,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.edgecolor": SOFT,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.prop_cycle": matplotlib.cycler(color=[INK, SOFT]),
    "grid.color": GRID,
    "xtick.color": SOFT,
    "ytick.color": SOFT,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "lines.markersize": 4,
})


def new(
    width_mm: float, height_mm: float, *, columns: int = 1, rows: int = 1
) -> tuple[Figure, Any]:
    """Returns an empty figure and its axes: one Axes, or an array of several."""
    size = (width_mm / MM_OF_INCH, height_mm / MM_OF_INCH)
    fig = Figure(figsize=size, layout="constrained")
    return fig, fig.subplots(rows, columns)


def color(mode: str) -> str:
    """Returns the color of a mode, the same in all figures."""
    return MODES.get(mode, OWN).light


def label(mode: str) -> str:
    """Returns the label of a mode."""
    return MODES[mode].name if mode in MODES else mode


def box_plot(ax: Axes, groups: dict[str, NDArray[np.float64]], label_of_values: str) -> None:
    """Draws box plots of values by mode, one below the other, and every value as a point.

    A box spans the quartiles, with a line at the median. Whiskers reach the last value within 1.5 times its length.
    Points are spread across the box only to separate them.
    """
    for place, (mode, values) in enumerate(groups.items()):
        shade = color(mode)
        lines = {"color": shade, "linewidth": 1.0}
        face = to_rgba(shade, 0.4 if mode in STRESSED else 0.1)
        ax.boxplot(
            values,
            vert=False,
            positions=[place],
            widths=0.56,
            showfliers=False,
            patch_artist=True,
            boxprops={"facecolor": face, "edgecolor": shade},
            whiskerprops=lines,
            capprops=lines,
            medianprops={"color": shade, "linewidth": 2.2},
        )
        spread = (np.arange(len(values)) * 0.6180339887) % 1.0 - 0.5  # the golden section spreads them evenly
        ax.plot(values, place + 0.4 * spread, "o", color=shade, alpha=0.5, markersize=2.6, markeredgewidth=0)
    ax.set_yticks(range(len(groups)), [label(mode) for mode in groups])
    for mode, tick in zip(groups, ax.get_yticklabels()):
        tick.set_fontweight("bold" if mode in STRESSED else "normal")
    ax.set_ylim(len(groups) - 0.4, -0.6)
    ax.grid(False, axis="y")
    ax.set_xlabel(label_of_values)


def svg(fig: Figure) -> str:
    """Returns the figure as SVG, for a file or a page; the figure is empty afterwards.

    The same figure gives the same bytes. Raises ValueError for content without a dark color.
    """
    file = io.StringIO()
    fig.savefig(file, format="svg")
    named = [(ax.get_title(), ax.get_ylabel(), ax.get_xlabel()) for ax in fig.axes]
    titles = [title or (f"{y} by {x}" if y else f"{x} by mode") for title, y, x in named]
    fig.clear()
    text = file.getvalue()
    if "<image" in text:
        raise ValueError("a figure must consist of lines and faces, because pixels have no dark colors")
    names: set[str] = {"ink"}

    def property_of(found: re.Match[str]) -> str:
        if found[2] not in _DRAWN:
            raise ValueError(f"{found[2]} is not a color of figures.py, so it has no dark color")
        names.add(_DRAWN[found[2]])
        return f"{found[1]}: var(--{_DRAWN[found[2]]})"

    text = re.sub(r"\b(fill|stroke): (#[0-9a-f]{6})", property_of, text)
    text = re.sub(r"'DejaVu Sans'[^;\"]*", "system-ui, sans-serif", text)
    # matplotlib places formulas letter by letter for one font; without positions they fit any font.
    text = re.sub(r'(<tspan [^>]*x="[^" ]+)[^"]*"', r'\1"', text)
    # Remove dates, comments, and the style that _style() replaces.
    text = re.sub(r"\s*<!--.*?-->|\s*<metadata>.*?</metadata>|<defs>\s*<style.*?</defs>", "", text,
                  flags=re.DOTALL)
    # matplotlib gives every element an id; unused ones could occur twice on a page.
    used = set(re.findall(r"#([\w.-]+)", text))
    text = re.sub(r' id="([^"]*)"', lambda found: found[0] if found[1] in used else "", text)
    drawn = [look.name for name, look in _LOOKS.items() if name in names and look.name]
    head = [f"<title>{escape('; '.join(titles))}</title>"]
    head += [f"<desc>Drawn are: {escape('; '.join(drawn))}.</desc>"] if drawn else []
    head += [f"<style>{_style(names)}</style>"]
    root, content = text[text.index("<svg ") :].removeprefix("<svg").split(">", 1)
    return f'<svg role="img"{root}>\n ' + "\n ".join(head) + content


def _style(names: set[str]) -> str:
    """Returns the custom properties of these names. Elements without a color get the ink's."""
    light = ";".join(f"--{name}:{_LOOKS[name].light}" for name in sorted(names))
    dark = ";".join(f"--{name}:{_LOOKS[name].dark}" for name in sorted(names))
    return (
        f"svg{{{light};fill:var(--ink)}}"
        f"@media screen and (prefers-color-scheme:dark){{svg{{{dark}}}}}"
        "*{stroke-linejoin:round;stroke-linecap:butt}"
    )
