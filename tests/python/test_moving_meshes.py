# SPDX-License-Identifier: BSD-3-Clause
"""Tests an instrument beside several meshes that are placed and that move."""

import numpy as np
import pytest
from surfaces import at, sphere

import keepout
from keepout import Body, Chain, Instrument, InstrumentGuard, Joint, Status

period = 1e-3


def ball_guard(speed=None, **options):
    """Returns a guard of a 1 mm ball beside a 50 mm sphere, and its index. `speed`: limits the joints. [mm/s]"""
    instrument = keepout.free_ball(1.0)
    if speed is not None:
        slides = [
            Joint(name, kind="prismatic", axis=axis, lower=-500, upper=500, velocity=speed)
            for name, axis in zip("xyz", np.eye(3))
        ]
        instrument = Instrument(Chain(slides), [Body("ball", [(3, (0, 0, 0))], 1.0)])
    index = keepout.Index(keepout.Mesh(*sphere(64, 50.0)))
    guard = InstrumentGuard(
        index.mesh, instrument, index=index, period=period,
        damping=1e-9, orientation_weight=0, **options,
    )  # fmt: skip
    return guard, index


def test_a_mesh_that_comes_on_pushes_the_instrument_before_it():
    guard, index = ball_guard(margin=0.5)
    q = np.array([53.0, 0.0, 0.0])
    guard.place(0, None, linear=(50, 0, 0), angular=(0, 0, np.pi / 6))
    for cycle in range(1000):
        step = guard.step(q, linear=(0, 0, 0))
        assert step.status in (Status.free, Status.limited) and step.clearance_fraction == 1.0
        q = q + step.increment
        distance = np.linalg.norm(q - (0.05 * (cycle + 1), 0, 0)) - 50.0 - 1.0
        assert distance > 0.498 - 0.1, "its triangles are a little within the sphere"
    assert q[0] > 100.0
    assert np.allclose(guard.place_of(0)[:3, 3], (50, 0, 0)), "and it goes on"


def test_each_mesh_has_a_margin_and_a_place_of_its_own():
    guard, index = ball_guard(margin=0.5)
    assert guard.add_mesh(index, margin=2.0) == 1 and guard.mesh_count == 2
    guard.place(1, at(120, 0, 0))
    q = np.array([60.0, 0.0, 0.0])
    for way, mesh, margin in ((-1.0, 0, 0.5), (1.0, 1, 2.0)):
        for _ in range(40):
            step = guard.step(q, linear=(0.5 * way, 0, 0))
            q = q + step.increment
        assert step.nearest_mesh == mesh
        assert step.distance == pytest.approx(margin, abs=3e-3)
    place = guard.proofs(q, [[40.0, 0, 0], [-20.0, 0, 0]])
    assert list(place.is_clear) == [False, False]
    guard.place(1, at(400, 0, 0))
    assert guard.prove(q, (40.0, 0, 0)).is_clear, "proofs see where meshes are"


def test_what_outruns_the_joints_is_named():
    guard, _ = ball_guard(speed=2000, margin=0.5)
    guard.place(0, None, linear=(2100, 0, 0))  # [mm/s], faster than the joints
    q = np.array([52.0, 0.0, 0.0])
    seen = []
    for _ in range(20):
        step = guard.step(q, linear=(0, 0, 0))
        seen.append(step.status)
        if not step.ok:
            assert step.clearance_fraction == 0.0 or step.status == Status.touching
            break
        assert (step.clearance_fraction < 1.0) == (step.status == Status.degraded)
        q = q + step.increment
        named = () if step.clearance_fraction == 1.0 else ((0, 0, step.clearance_fraction),)
        assert step.degraded == named
    assert Status.degraded in seen and not step.ok


def test_a_place_that_is_none_stops_it():
    guard, index = ball_guard()
    for bad in (np.full((4, 4), np.nan), 2.0 * np.eye(4)):
        with pytest.raises(keepout.Error, match="last row"):
            guard.place(0, bad)
    stretched = np.diag([1.1, 1, 1, 1])
    with pytest.raises(keepout.Error, match="previous pose"):
        guard.place(0, stretched)
    q = (70.0, 0, 0)
    assert guard.step(q, linear=(1, 0, 0)).status == Status.invalid_input
    guard.place(0, None)
    assert guard.step(q, linear=(1, 0, 0)).status == Status.free
    with pytest.raises(keepout.Error, match="'?mesh'?"):
        guard.place(3, None)
    with pytest.raises(keepout.Error, match="margin"):
        guard.add_mesh(index, margin=-1.0)
    with pytest.raises(keepout.Error, match="band"):
        guard.add_mesh(index, margin=0.001)


def test_an_approach_is_slowed_down():
    guard, _ = ball_guard(margin=0.5, slowing_within=5.0, slowing_time=0.02)
    q = np.array([60.0, 0.0, 0.0])
    slowed = 0
    least = 0.0  # distance that the slowdown allows
    for _ in range(300):
        step = guard.step(q, linear=(-0.4, 0, 0))
        if step.distance is None:
            assert -step.increment[0] == pytest.approx(0.4, rel=1e-6)
        else:
            slowed += 1
            assert step.distance >= least - 1e-9
            least = step.distance - (step.distance - 0.5) * period / 0.02 - guard.band
        q = q + step.increment
    assert 100 < slowed < 300
