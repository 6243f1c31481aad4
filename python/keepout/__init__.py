# SPDX-License-Identifier: BSD-3-Clause
"""Keeps a robot's tool out of a triangle mesh of anatomy.

    mesh = keepout.load_mesh("skull.stl")
    guard = keepout.MotionConstraint(mesh, tool_radius=0.3, margin=0.2)
    step = guard.step(tip, desired)    # the allowed motion nearest to the one desired
    tip += step.motion                 # zero unless step.ok

    guard = keepout.InstrumentGuard(mesh, keepout.Instrument(chain, bodies), margin=0.5)
    step = guard.step(q, linear=(0, 0, -0.1))    # a whole instrument, in joint space
    q += step.increment

Lengths are in the unit of the mesh, usually mm. Tips, motions and planes are in the frame of the
mesh. Array arguments may be arrays or anything that numpy converts to an array. keepout.Error
explains an invalid argument.
"""

from ._core import *  # noqa: F403
from ._core import __version__
from ._renamed import alias as _alias
from ._results import Option, Part, Proofs, Simulation, Status, Steps

__all__ = ["__version__", *(name for name in dir() if not name.startswith("_"))]

# help() must show the module from which users import a name.
for _name in __all__:
    if _name != "__version__":
        globals()[_name].__module__ = "keepout"
del _name

for _owner, _former, _name in (
    (InstrumentStep, "share", "fraction"),  # noqa: F405
    (InstrumentStep, "level", "clearance_fraction"),  # noqa: F405
    (MotionProof, "share", "fraction"),  # noqa: F405
    (MotionConstraint, "max_looks", "max_work_units"),  # noqa: F405
    (InstrumentGuard, "max_looks", "max_work_units"),  # noqa: F405
    (Inspection, "looks_like_metres", "looks_like_meters"),  # noqa: F405
):
    _alias(_owner, _former, _name)
del _owner, _former, _name
