# SPDX-License-Identifier: BSD-3-Clause
"""The numbers that Li et al. (2020) print, with their sections: IROS 2020.

We measured only `AUTHORS_CODE`. Numbers that appear only in their plots are missing; of the rate, they print two
points in words. Standard deviations are as printed; Li et al. do not say if they are of n or n - 1.
"""
from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Summary:
    """The summary of a sample, as printed: mean, standard deviation, and size."""

    mean: float
    sd: float
    n: int


@dataclass(frozen=True)
class Comparison:
    """Free hand against fixture, as printed. `n` counts as the test of Li et al. does."""

    about: str
    section: str
    unit: str
    trials: int  # of each mode
    free: Summary
    fixture: Summary
    p: float  # as printed: of the pooled two-sided Student test, except for PENETRATION_DEPTH


SAL = Comparison(
    "spectral arc length", "V-A", "", 5, Summary(-20.98, 0.79, 5), Summary(-10.02, 3.7, 5), 1.9e-4)

#: Durations are 232 and 237 s, 212 and 196 s. The first two have a deviation of 3.5, not 3.8.
DURATION = Comparison(
    "duration", "V-B", "s", 2, Summary(234.0, 3.8, 2), Summary(204.0, 11.0, 2), 0.069)

#: Two trials with 30 places each, 1 mm apart; the test treats all 60 as independent.
PATH_DEVIATION = Comparison(
    "cutting path deviation", "V-B", "mm", 2,
    Summary(0.63, 0.30, 60), Summary(0.37, 0.24, 60), 2.3e-6)

#: Absolute depths. The printed p does not follow from the printed summaries, which give 3e-8.
PENETRATION_DEPTH = Comparison(
    "absolute penetration depth", "V-B", "mm", 2,
    Summary(0.83, 0.51, 60), Summary(0.39, 0.26, 60), 7.9e-3)


@dataclass(frozen=True)
class Extreme:
    """The largest of all 60 samples of two trials, free hand and fixture, as printed [mm]."""

    about: str
    member: str  # of a row of E4, with the samples of a trial
    sign: float  # of the samples: the extreme is the largest sample times this sign
    free: float
    fixture: float


EXTREMES = (
    Extreme("largest cutting path deviation", "deviations_mm", 1.0, 1.27, 0.86),
    Extreme("largest over-cut", "depths_mm", 1.0, 2.46, 0.87),
    #: With the fixture they print "minimum under-cut", which we read as the largest.
    Extreme("largest under-cut", "depths_mm", -1.0, 1.35, 0.96),
)


@dataclass(frozen=True)
class Rate:
    """The rate of a loop on a mesh of this many triangles; `radius` in mm, None if it is not given."""

    triangles: int
    khz: float
    radius: float | None = None


#: IV-B, in words: C++ with cisst, Ubuntu 18.04, Intel Core i7-8700, a Stanford bunny.
RATES = (Rate(51_978, 7.73), Rate(989_376, 0.180))
#: IV-B: "less than approximately 200,000 triangles" keep the 1 kHz of a teleoperated loop.
TRIANGLES_AT_1_KHZ = 200_000

#: The authors' published code (cisstMesh, sawConstraintController), timed by us: one core, g++ 12 -O3, medians of
#: closed-loop contact states on a bunny of 150 mm, with a step of the radius.
AUTHORS_CODE = (
    Rate(51_978, 19.7, 5.0), Rate(200_000, 5.90, 5.0), Rate(989_374, 0.749, 5.0),
    Rate(51_978, 35.2, 1.0), Rate(989_374, 1.21, 1.0), Rate(989_374, 1.35, 0.25),
)
