# SPDX-License-Identifier: BSD-3-Clause
"""Figures are reproducible, and legible for everyone in light and dark schemes."""
import itertools
import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from skimage.color import colorconv

from experiments import figures

#: Linear RGB as seen with color blindness (Machado, Oliveira, Fernandes 2009, severity 1).
EYES = {
    "all cones": np.eye(3),
    "protanopia": [[0.1523, 1.0526, -0.2049], [0.1145, 0.7863, 0.0992], [-0.0039, -0.0481, 1.0520]],
    "deuteranopia": [[0.3673, 0.8606, -0.228], [0.2801, 0.6725, 0.0474], [-0.0118, 0.0429, 0.9689]],
    "tritanopia": [[1.2555, -0.0767, -0.1788], [-0.0784, 0.9308, 0.1476], [0.0047, 0.6914, 0.3039]],
}
TO_XYZ = colorconv.xyz_from_rgb


def drawn() -> str:
    """Returns a figure that uses all functions of figures.py."""
    fig, axes = figures.new(170, 70, columns=2)
    random = np.random.default_rng(1)
    figures.box_plot(axes[0], {m: random.normal(size=9) for m in figures.MODES}, "depth [mm]")
    axes[1].fill_between([1, 10], [1, 2], color="black", alpha=0.2)
    axes[1].plot([1, 10], [1, 2], color=figures.color("paper"), label=figures.label("paper"))
    axes[1].set(xscale="log", xlabel="a < b", title="Rates & triangles")
    axes[1].legend()
    return figures.svg(fig)


def linear(shade: str) -> np.ndarray:
    return np.linalg.solve(TO_XYZ, colorconv.rgb2xyz(to_rgb(shade)))


def lab(light: np.ndarray) -> np.ndarray:
    """Returns a color in CIE L*a*b* under D65."""
    return colorconv.xyz2lab(TO_XYZ @ np.clip(light, 0, 1))


def test_the_same_figure_gives_the_same_bytes():
    assert drawn() == drawn()


def test_every_colour_adapts():
    text = drawn()
    picture, styles = re.subn(r"<style>.*?</style>", "", text)
    assert styles == 1
    assert not re.search(r"#[0-9a-f]{3,8}\b|rgb|black|white", picture)
    used = set(re.findall(r"var\((--[\w-]+)\)", text))
    assert {"--ink", "--paper", "--mode-certified", "--mode-distance_field"} <= used
    light, dark = re.findall(r"svg\{(.*?)\}", text)
    assert all(f"{name}:#" in light and f"{name}:#" in dark for name in used)
    assert "fill:var(--ink)" in light  # for elements that matplotlib draws in black without a fill attribute


@pytest.mark.parametrize("draw, told", [
    (lambda ax: ax.plot([1, 2], color="red"), "#ff0000"),
    (lambda ax: ax.imshow(np.eye(2)), "pixels"),
])
def test_what_would_not_adapt_is_refused(draw, told):
    fig, ax = figures.new(50, 50)
    draw(ax)
    with pytest.raises(ValueError, match=told):
        figures.svg(fig)


def test_it_is_text_with_a_title_and_names_that_are_used():
    written = drawn()
    root = ElementTree.fromstring(written)
    svg = "{http://www.w3.org/2000/svg}"
    assert root.get("role") == "img" and root[1].tag == svg + "desc"
    assert root[0].text == "depth [mm] by mode; Rates & triangles"
    words = ["".join(text.itertext()).strip() for text in root.iter(svg + "text")]
    assert all(figures.label(mode) in words for mode in figures.MODES)
    assert all(figures.label(mode) in root[1].text for mode in figures.MODES)
    names = [element.get("id") for element in root.iter() if element.get("id")]
    assert names and all(f"#{name}" in written for name in names)


def test_every_value_is_a_point():
    fig, ax = figures.new(60, 50)
    values = np.array([1.0, 1.0, 2.0, 50.0])
    figures.box_plot(ax, {"none": values, "paper": values[:0], "certified": values}, "depth [mm]")
    points = [line for line in ax.lines if line.get_marker() == "o"]
    assert [list(line.get_xdata()) for line in points] == [list(values), [], list(values)]
    for place, line in ((0, points[0]), (2, points[2])):
        places = line.get_ydata()
        assert len(set(places)) == 4 and np.abs(places - place).max() <= 0.2


@pytest.mark.parametrize("paper, shade", [("#ffffff", "light"), ("#18202b", "dark")])
def test_modes_are_told_apart_by_all_eyes(paper, shade):
    colors = {mode: getattr(look, shade) for mode, look in {**figures.MODES, "MyRule": figures.OWN}.items()}
    names = [figures.label(mode) for mode in colors]
    assert len(set(names)) == len(names) and all(names)
    for mode, color in colors.items():
        low, high = sorted((TO_XYZ[1] @ linear(one) for one in (color, paper)))
        assert (high + 0.05) / (low + 0.05) >= 3.0, f"{mode} is pale on {paper}"
    for eyes, seen in EYES.items():
        for one, other in itertools.combinations(colors, 2):
            first, second = (lab(np.array(seen) @ linear(colors[it])) for it in (one, other))
            assert np.linalg.norm(first - second) > 15.0, f"{one} is like {other}, with {eyes}"
