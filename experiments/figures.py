# SPDX-License-Identifier: BSD-3-Clause
"""How the figures look. A figure is drawn once, for paper and for pages in light and in dark.

    fig, ax = figures.new(120, 70)
    ax.plot(times, depths, color=figures.color("certified"), label=figures.label("certified"))
    figure = Figure("depth", "Depth over time", "What is to be seen.", figures.svg(fig))

Draw in INK (matplotlib's "black"), SOFT, GRID, PAPER ("white") and the colours of modes, as opaque
as it suits: svg() makes each of them a custom property of CSS, which is another colour in the dark.
It refuses any other colour, and pictures of pixels, which would not follow.
"""
from __future__ import annotations

import io
import re
import textwrap
from dataclasses import dataclass
from html import escape
from typing import Any

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from numpy.typing import NDArray

MM_OF_INCH = 25.4

INK = "#000000"  # what is written
SOFT = "#566173"  # axes, and what is said beside
GRID = "#dfe3ea"
PAPER = "#ffffff"


@dataclass(frozen=True)
class Look:
    """What people call something, and its colour on light and on dark paper."""

    name: str
    light: str
    dark: str


#: Of each mode. Colours are apart for colour-blind eyes too, and stand out from the paper by 3 : 1
#: or more. Add yours here; tests/experiments/test_figures.py says whether its colour will do.
MODES = {
    "none": Look("no fixture", "#17202e", "#e8edf4"),
    "all_faces": Look("all faces", "#939646", "#ffdc31"),
    "paper": Look("the paper's rule", "#d63a00", "#ff7a35"),
    "certified": Look("certified", "#1864dc", "#5b9bff"),
    "closest_points_2007": Look("closest points (2007)", "#4900d4", "#8141fc"),
    "vector_field": Look("vector field", "#890072", "#d490a4"),
    "sdf_0.25": Look("distance field, 0.25 mm", "#174835", "#1c7f5d"),
    "sdf_0.5": Look("distance field, 0.5 mm", "#4a7a50", "#a4f87f"),
    "sdf_1": Look("distance field, 1 mm", "#2ea38d", "#63ffb2"),
    "fcl_continuous": Look("FCL, continuous", "#940a00", "#ca3621"),
    "bullet_sweep": Look("Bullet, sweep", "#a465ba", "#baa0db"),
}

#: What the others are set beside: their boxes are fuller, and their names bold.
STRESSED = ("paper", "certified")

#: By the name of the custom property; the colour in which it is drawn is the key of _DRAWN.
_LOOKS = {
    "ink": Look("", "#17202e", "#e8edf4"),
    "soft": Look("", SOFT, "#9eabbd"),
    "grid": Look("", GRID, "#2c3745"),
    "paper": Look("", PAPER, "#18202b"),
} | {"mode-" + mode.replace(".", "-"): look for mode, look in MODES.items()}
_DRAWN = {INK: "ink"} | {look.light: name for name, look in _LOOKS.items() if name != "ink"}

matplotlib.rcdefaults()  # not what this user prefers: the same bytes everywhere
matplotlib.rcParams.update({
    "svg.fonttype": "none",
    "svg.hashsalt": "keepout",
    "font.sans-serif": ["DejaVu Sans"],  # wider than what is shown: nothing will overlap
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
    """An empty figure and its axes: one Axes, or an array of them where there are several."""
    size = (width_mm / MM_OF_INCH, height_mm / MM_OF_INCH)
    fig = Figure(figsize=size, layout="constrained")
    return fig, fig.subplots(rows, columns)


def color(mode: str) -> str:
    """In which to draw what a mode did, the same in all figures."""
    return MODES[mode].light


def label(mode: str) -> str:
    """What people call a mode."""
    return MODES[mode].name


def box_plot(ax: Axes, groups: dict[str, NDArray[np.float64]], ylabel: str) -> None:
    """Box plots of values by mode, from left to right, and every value as a point.

    A box is from the lower to the upper quartile, with a line at the median; whiskers lead to the
    last value within 1.5 times its height. Points are spread sidewise only to be told apart.
    """
    for place, (mode, values) in enumerate(groups.items()):
        shade = color(mode)
        lines = {"color": shade, "linewidth": 1.0}
        face = to_rgba(shade, 0.4 if mode in STRESSED else 0.1)
        ax.boxplot(
            values,
            positions=[place],
            widths=0.56,
            showfliers=False,
            patch_artist=True,
            boxprops={"facecolor": face, "edgecolor": shade},
            whiskerprops=lines,
            capprops=lines,
            medianprops={"color": shade, "linewidth": 2.2},
        )
        spread = (np.arange(len(values)) * 0.6180339887) % 1.0 - 0.5  # the golden section: even
        ax.plot(place + 0.4 * spread, values, "o", color=shade, alpha=0.5, markersize=2.6,
                markeredgewidth=0)
    room = MM_OF_INCH * ax.figure.get_figwidth() * ax.get_position().width / len(groups)
    if room > 20.0:  # mm, for a name in lines; else names are slanted
        names = [textwrap.fill(label(mode), 12, break_long_words=False) for mode in groups]
        ax.set_xticks(range(len(groups)), names)
    else:
        ax.set_xticks(range(len(groups)), [label(mode) for mode in groups], rotation=30, ha="right",
                      rotation_mode="anchor")
    for mode, tick in zip(groups, ax.get_xticklabels()):
        tick.set_fontweight("bold" if mode in STRESSED else "normal")
    ax.set_xlim(-0.6, len(groups) - 0.4)
    ax.grid(False, axis="x")
    ax.set_ylabel(ylabel)


def svg(fig: Figure) -> str:
    """The figure as SVG, for a file of its own or a page; the figure is empty afterwards.

    The same figure gives the same bytes. Raises ValueError for what would not follow into the dark.
    """
    file = io.StringIO()
    fig.savefig(file, format="svg")
    titles = [
        ax.get_title() or f"{ax.get_ylabel()} by {ax.get_xlabel() or 'mode'}" for ax in fig.axes
    ]
    fig.clear()
    text = file.getvalue()
    if "<image" in text:
        raise ValueError("a figure is of lines and faces; pixels do not follow into the dark")
    names: set[str] = {"ink"}

    def property_of(found: re.Match[str]) -> str:
        if found[2] not in _DRAWN:
            raise ValueError(f"{found[2]} is no colour of figures.py: dark pages need another")
        names.add(_DRAWN[found[2]])
        return f"{found[1]}: var(--{_DRAWN[found[2]]})"

    text = re.sub(r"\b(fill|stroke): (#[0-9a-f]{6})", property_of, text)
    text = re.sub(r"'DejaVu Sans'[^;\"]*", "system-ui, sans-serif", text)
    # Formulas are set letter by letter, for one font: let words run in whichever is there.
    text = re.sub(r'(<tspan [^>]*x="[^" ]+)[^"]*"', r'\1"', text)
    # No date, no comments; what its style says, _style() says too.
    text = re.sub(r"\s*<!--.*?-->|\s*<metadata>.*?</metadata>|<defs>\s*<style.*?</defs>", "", text,
                  flags=re.DOTALL)
    # matplotlib numbers everything; what nothing refers to would only be twice on a page.
    used = set(re.findall(r"#([\w.-]+)", text))
    text = re.sub(r' id="([^"]*)"', lambda found: found[0] if found[1] in used else "", text)
    drawn = [look.name for name, look in _LOOKS.items() if name in names and look.name]
    head = [f"<title>{escape('; '.join(titles))}</title>"]
    head += [f"<desc>Drawn are: {escape('; '.join(drawn))}.</desc>"] if drawn else []
    head += [f"<style>{_style(names)}</style>"]
    root, content = text[text.index("<svg ") :].removeprefix("<svg").split(">", 1)
    return f'<svg role="img"{root}>\n ' + "\n ".join(head) + content


def _style(names: set[str]) -> str:
    """The custom properties of these names. What matplotlib gives no colour is of the ink."""
    light = ";".join(f"--{name}:{_LOOKS[name].light}" for name in sorted(names))
    dark = ";".join(f"--{name}:{_LOOKS[name].dark}" for name in sorted(names))
    return (
        f"svg{{{light};fill:var(--ink)}}"
        f"@media screen and (prefers-color-scheme:dark){{svg{{{dark}}}}}"
        "*{stroke-linejoin:round;stroke-linecap:butt}"
    )
