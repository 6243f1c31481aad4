# SPDX-License-Identifier: BSD-3-Clause
"""README.md says of the committed results what stands in them."""
import re
from pathlib import Path

RESULTS = Path(__file__).resolve().parents[2] / "experiments" / "results"
TEXT = (RESULTS / "README.md").read_text()


def rows_of(title: str) -> list[dict[str, str]]:
    """The rows of each table with this title, by the names of their columns."""
    found = []
    for part in TEXT.split(f"**{title}.**")[1:]:
        lines = [line for line in part.split("\n\n", 2)[1].splitlines() if line.startswith("|")]
        heads = [cell.strip() for cell in lines[0].strip("|").split("|")]
        found += [
            dict(zip(heads, (cell.strip() for cell in line.strip("|").split("|")), strict=True))
            for line in lines[2:]
        ]
    return found


def test_certified_let_the_tip_into_nothing_in_the_frame_that_it_was_told() -> None:
    rows = [row for row in rows_of("What came into the anatomy") if row["mode"] == "certified"]
    assert len(rows) == 2  # tracing and cutting
    for row in rows:
        assert row["setpoint passes through, registered frame"] == "0"
        assert float(row["deepest setpoint, registered frame [mm]"]) == 0.0
        assert float(row["tip deeper than that error [mm]"]) == 0.0
        assert row["tip short of the path's end"] == "0"
    swept = [row for row in rows_of("Tremor, corridor, and a set-up without errors") if row["mode"] == "certified"]
    assert len(swept) > 5
    assert all(row["setpoint passes through"] == "0" and float(row["deepest setpoint [mm]"]) == 0.0 for row in swept)


def test_certified_kept_out_of_every_shape_and_every_thin_wall() -> None:
    of = {row["mode"]: row for row in rows_of("Modes over all closed shapes")}
    kept, shapes, got_in = map(int, re.findall(r"(\d+) of (\d+) shapes, (\d+) of", of["certified"]["kept out of, got in"])[0])
    assert kept == shapes > 11 and got_in == 0
    assert all(row["certified"] == "0" for row in rows_of("Loops in which the tip crossed the surface"))
    walls = [row for row in rows_of("A grid of distances, and the mesh itself") if row["mode"] == "certified"]
    assert walls and all(row["entered / passed"].startswith("0 / 0 of") for row in walls)


def test_four_of_nine_counterexamples_pass_the_papers_rule_and_none_the_certified() -> None:
    rows = rows_of("Each rule on each counterexample, 20 cycles")
    assert len(rows) == 9
    assert sum(row["the paper's rule"] != "held" for row in rows) == 4
    assert all(row["certified"] == "held" for row in rows)


def test_by_the_papers_test_depth_and_duration_gain_and_deviation_and_smoothness_do_not() -> None:
    tested = {row["measure"]: row for row in rows_of("Each fixture against no fixture") if row["mode"] == "certified"}

    def gains(measure: str, sign: float) -> bool:
        free, held = (float(tested[measure][column].split(" ")[0]) for column in ("no fixture", "fixture"))
        return sign * (held - free) > 0.0 and float(tested[measure]["Student, as the paper"]) < 0.05

    assert gains("absolute penetration depth", -1.0) and gains("duration", -1.0)
    assert not gains("cutting path deviation", -1.0) and not gains("spectral arc length, 20 Hz", 1.0)


def test_the_readme_states_the_results_over_whole_trials() -> None:
    readme = " ".join((RESULTS.parents[1] / "README.md").read_text().split())
    rows = {row.strip("|").split("|")[0].split(" (")[0].strip(): row for row in TEXT.split("## E1")[0].splitlines() if row.startswith("|")}

    def cells(name: str) -> list[str]:
        return [cell.strip() for cell in rows[name].strip("|").split("|")]

    free, held = (number.split(" ")[0] for number in cells("spectral arc length")[4].split(",")[0].split(" \u2192 "))
    assert float(held) < float(free)  # less smooth
    sure = {name: re.findall(r"p = ([\d.]+)", cells(name)[1])[0] for name in ("spectral arc length", "absolute penetration depth", "duration")}
    assert f"spectral arc length {free} to {held}, p = {sure['spectral arc length']} over trials" in readme
    assert f"p = {sure['absolute penetration depth']} and {sure['duration']}" in readme


def test_every_figure_of_the_summary_is_there() -> None:
    named = re.findall(r"\(figures/([\w.]+)\)", TEXT)
    assert len(named) > 10
    assert {file.name for file in (RESULTS / "figures").iterdir()} == set(named)
