# SPDX-License-Identifier: BSD-3-Clause
"""The errors of a real set-up: registration, lag, deflection. A fixture sees only the registered position.

The robot's frame is registered to the anatomy by fiducials, which the tool touches. Each touch has an error (fiducial
localization error), and so does the fit. The registered and the true position of the tip differ by a rigid motion.
The tip of the da Vinci research kit is known to 0.65 mm RMS after calibration. Source: Hwang et al., "Efficiently
calibrating cable-driven surgical robots with RGBD fiducial sensing and recurrent neural networks", RA-L 2020. Li et
al. (2020) use six fiducials.
"""
from __future__ import annotations

from dataclasses import dataclass

import keepout
import numpy as np

from .experiment import Array


@dataclass(frozen=True)
class SetUp:
    """The errors of a set-up. `ideal()` has none."""

    fle: float = 0.65  # fiducial localization error, root mean square of the vector [mm]
    latency: float = 0.01  # from handle to robot, and back [s]
    lag: float = 0.01  # time constant with which the robot follows its setpoint [s]
    tip_stiffness: float = 4.0  # of robot and tool at the tip [N/mm]

    @staticmethod
    def ideal() -> SetUp:
        return SetUp(fle=0.0, latency=0.0, lag=0.0, tip_stiffness=np.inf)


@dataclass(frozen=True)
class RigidMotion:
    """x -> rotation x + translation."""

    rotation: Array
    translation: Array

    def __call__(self, points: Array) -> Array:
        moved: Array = points @ self.rotation.T + self.translation
        return moved

    def inverse(self) -> RigidMotion:
        """Returns the motion back."""
        return RigidMotion(self.rotation.T, -self.rotation.T @ self.translation)


def fiducials_around(place: Array, up: Array, spread: float = 40.0) -> Array:
    """Returns (6, 3): two rings of three around the place of the cut, on a head with a radius of 80 mm."""
    side = np.cross(up, [0.0, 1.0, 0.0])
    side = side / np.linalg.norm(side)
    other = np.cross(up, side)
    rings = []
    for number in range(6):
        angle = np.pi / 3 * number
        far = spread * (1.0 if number % 2 else 0.6)
        flat = np.cos(angle) * side + np.sin(angle) * other
        rings.append(place + far * flat - up * far**2 / 160.0)
    return np.array(rings)


def registered_from_true(setup: SetUp, fiducials: Array, random: np.random.Generator) -> RigidMotion:
    """Returns the rigid motion from the true position of a point to its registered one, in the anatomy's frame.

    The robot's frame is a random rigid motion, which cancels except for the errors. Each touched point has an error
    of `setup.fle`; keepout.fit_rigid makes the fit.
    """
    if setup.fle == 0.0:
        return RigidMotion(np.eye(3), np.zeros(3))
    axes, _ = np.linalg.qr(random.standard_normal((3, 3)))
    robot_from_true = RigidMotion(axes * np.linalg.det(axes), random.uniform(-300.0, 300.0, 3))
    touched = robot_from_true(fiducials)
    touched = touched + random.standard_normal(touched.shape) * setup.fle / np.sqrt(3.0)
    fit = keepout.fit_rigid(touched, fiducials).mesh_from_robot
    return RigidMotion(
        fit[:3, :3] @ robot_from_true.rotation,
        fit[:3, :3] @ robot_from_true.translation + fit[:3, 3],
    )
