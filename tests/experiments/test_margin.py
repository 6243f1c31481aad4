# SPDX-License-Identifier: BSD-3-Clause
"""Tests the chain from fiducial error to touching the dura: geometry, tracking errors, and the same draws again."""
import numpy as np
import pytest
from experiments import anatomy, e7_margin
from experiments.experiment import Scale, Unit

try:
    anatomy.mesh_file("skull")
except (OSError, anatomy.subprocess.CalledProcessError) as missing:
    pytest.skip(f"the CT skull is not prepared: {missing}", allow_module_level=True)


def arm() -> e7_margin.ResearchKitArm:
    here = e7_margin.place()
    middle = len(here.points) // 2
    return e7_margin.ResearchKitArm(here.points[middle] + 150.0 * here.up[middle], here.up[middle], here.ahead)


def test_the_arm_points_straight_down_from_its_port() -> None:
    here = e7_margin.place()
    middle = len(here.points) // 2
    tip = arm().tips(arm().start(140.0))
    assert tip == pytest.approx(here.points[middle] + 10.0 * here.up[middle], abs=0.01)


def test_the_sampled_bodies_end_at_the_tip_of_any_joints() -> None:
    random = np.random.default_rng(1)
    joints = arm().start(140.0) + random.uniform(-0.3, 0.3, (20, 6))
    points, radii = arm().sampled(joints)
    assert points[:, -1] == pytest.approx(arm().tips(joints), abs=1e-9)
    assert set(radii) == set(e7_margin.ResearchKitArm.RADII) and points.shape[1] == len(radii)


def test_no_error_of_the_joints_displaces_the_instrument_by_more_than_their_margin() -> None:
    random = np.random.default_rng(2)
    joints = arm().start(150.0) + random.uniform(-0.1, 0.1, (300, 6))
    signs = np.sign(random.standard_normal((300, 6)))
    before, _ = arm().sampled(joints)
    after, _ = arm().sampled(joints + signs * e7_margin.JOINT_ERRORS)
    displaced = np.linalg.norm(after - before, axis=2).max()
    assert 0.3 * e7_margin.ResearchKitArm.joint_margin() < displaced <= e7_margin.ResearchKitArm.joint_margin()


@pytest.mark.parametrize("tool", [e7_margin.POINT, e7_margin.INSTRUMENT])
def test_without_errors_the_tool_presses_on_its_margin_along_the_whole_path(
    tool: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(e7_margin, "JOINT_ERRORS", np.zeros(6))
    for row in e7_margin.run(Unit("one", {"tool": tool, "fle": 1e-3, "draws": 1, "seed": 1})):
        assert row["reached"] == 1.0 and not row["touches"]
        assert row["clearance_mm"] == pytest.approx(row["registration_margin_mm"], abs=0.03)


def test_the_same_draws_give_the_same_rows_and_margins_grow_with_confidence() -> None:
    unit = Unit("two", {"tool": e7_margin.POINT, "fle": 1.0, "draws": 2, "seed": 3})
    rows = e7_margin.run(unit)
    assert rows == e7_margin.run(unit)
    margins = [row["registration_margin_mm"] for row in rows if row["covers"] == e7_margin.KNOWN and row["draw"] == 0]
    assert margins == sorted(margins) and len(margins) == len(e7_margin.CONFIDENCES)
    assert rows[0]["registration_error_mm"] == rows[4]["registration_error_mm"] != rows[-1]["registration_error_mm"]


def test_findings_have_every_combination() -> None:
    units = [Unit(tool, {"tool": tool, "fle": fle, "draws": 1, "seed": 1})
             for tool in (e7_margin.POINT, e7_margin.INSTRUMENT) for fle in e7_margin.FLES[:2]]
    rows = [row for unit in units for row in e7_margin.run(unit)]
    found = e7_margin.findings(rows, Scale())
    assert [len(table.rows) for table in found.tables] == [2 * (9 + len(e7_margin.FIXED)), 2 * 9] and len(found.claims) == 2
    assert found == e7_margin.findings(rows, Scale())
