# SPDX-License-Identifier: BSD-3-Clause
# Shapes, units and failures are in the docstrings of the module: help(keepout.MotionConstraint).
from collections.abc import Sequence
from os import PathLike
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._results import Part as Part
from ._results import Proofs as Proofs
from ._results import Simulation as Simulation
from ._results import Status as Status
from ._results import Steps as Steps

__all__ = [
    "Body",
    "Chain",
    "ConvexTool",
    "Error",
    "Hits",
    "Index",
    "Inspection",
    "Instrument",
    "InstrumentGuard",
    "InstrumentStep",
    "Joint",
    "Mesh",
    "MotionConstraint",
    "MotionProof",
    "Part",
    "Planes",
    "Polytope",
    "Proofs",
    "Simulation",
    "Status",
    "Step",
    "Steps",
    "TableRow",
    "__version__",
    "activations",
    "chain_of_table",
    "indices",
    "load_mesh",
    "narrow_phases",
    "read_chain",
    "solvers",
]

__version__: str

class Error(ValueError): ...

class Inspection:
    @property
    def vertices(self) -> int: ...
    @property
    def unused_vertices(self) -> int: ...
    @property
    def triangles(self) -> int: ...
    @property
    def edges(self) -> int: ...
    @property
    def boundary_edges(self) -> int: ...
    @property
    def non_manifold_edges(self) -> int: ...
    @property
    def inconsistent_edges(self) -> int: ...
    @property
    def pinched_vertices(self) -> int: ...
    @property
    def repeated_vertex_triangles(self) -> int: ...
    @property
    def collinear_triangles(self) -> int: ...
    @property
    def duplicate_triangles(self) -> int: ...
    @property
    def components(self) -> int: ...
    @property
    def edge_components(self) -> int: ...
    @property
    def closed(self) -> bool: ...
    @property
    def watertight(self) -> bool: ...
    @property
    def inside_out(self) -> bool: ...
    @property
    def looks_like_metres(self) -> bool: ...
    @property
    def euler_characteristic(self) -> int: ...
    @property
    def genus(self) -> int | None: ...
    @property
    def area(self) -> float: ...
    @property
    def signed_volume(self) -> float | None: ...
    @property
    def low(self) -> tuple[float, float, float]: ...
    @property
    def high(self) -> tuple[float, float, float]: ...
    @property
    def self_intersections(self) -> int | None: ...

class Mesh:
    def __init__(
        self, vertices: ArrayLike, triangles: ArrayLike, *, weld: bool = False
    ) -> None: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def triangles(self) -> NDArray[np.uint32]: ...
    @property
    def normals(self) -> NDArray[np.float64]: ...
    @property
    def bounds(self) -> NDArray[np.float64]: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def space(self) -> Literal["RAS", "LPS"] | None: ...
    def inspect(self, *, self_intersections: bool = False) -> Inspection: ...
    def __len__(self) -> int: ...

def load_mesh(
    path: str | PathLike[str],
    *,
    space: Literal["RAS", "LPS"] | None = None,
    untagged: Literal["RAS", "LPS"] | None = None,
) -> Mesh: ...
def indices() -> list[Part]: ...
def activations() -> list[Part]: ...
def solvers() -> list[Part]: ...
def narrow_phases() -> list[Part]: ...

class Hits:
    @property
    def triangles(self) -> NDArray[np.uint32]: ...
    @property
    def offsets(self) -> NDArray[np.float64]: ...
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def distances(self) -> NDArray[np.float64]: ...
    def __len__(self) -> int: ...

class Index:
    def __init__(
        self,
        mesh: Mesh,
        name: str = "wide_bvh",
        *,
        cache: str | PathLike[str] | None = None,
    ) -> None: ...
    def query(self, center: ArrayLike, radius: float) -> NDArray[np.uint32]: ...
    def hits(self, center: ArrayLike, radius: float) -> Hits: ...
    def distances(
        self, points: ArrayLike, *, threads: int | None = None
    ) -> NDArray[np.float64]: ...
    def refitted(self, mesh: Mesh) -> Index: ...
    @property
    def mesh(self) -> Mesh: ...
    @property
    def name(self) -> str: ...
    @property
    def memory(self) -> int: ...

class Planes:
    @property
    def normals(self) -> NDArray[np.float64]: ...
    @property
    def offsets(self) -> NDArray[np.float64]: ...
    @property
    def sources(self) -> NDArray[np.uint32]: ...
    def __len__(self) -> int: ...

class Polytope(Planes):
    @property
    def status(self) -> str: ...
    @property
    def ok(self) -> bool: ...
    @property
    def reason(self) -> str: ...

class Step:
    @property
    def status(self) -> Status: ...
    @property
    def ok(self) -> bool: ...
    @property
    def reason(self) -> str: ...
    @property
    def motion(self) -> NDArray[np.float64]: ...
    @property
    def increment(self) -> NDArray[np.float64]: ...
    @property
    def planes(self) -> Planes: ...
    @property
    def active(self) -> NDArray[np.uint32]: ...
    @property
    def triangles(self) -> int: ...
    @property
    def distance(self) -> float | None: ...

class ConvexTool:
    @staticmethod
    def sphere(radius: float) -> ConvexTool: ...
    @staticmethod
    def capsule(start: ArrayLike, end: ArrayLike, radius: float) -> ConvexTool: ...
    @staticmethod
    def box(low: ArrayLike, high: ArrayLike) -> ConvexTool: ...
    @staticmethod
    def hull(points: ArrayLike, radius: float = 0.0) -> ConvexTool: ...
    @staticmethod
    def of_text(text: str) -> ConvexTool: ...
    def rotated(self, rotation: ArrayLike) -> ConvexTool: ...
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def radius(self) -> float: ...

class MotionConstraint:
    def __init__(
        self,
        mesh: Mesh,
        *,
        index: str | Index = "wide_bvh",
        index_cache: str | PathLike[str] | None = None,
        activation: str = "certified",
        solver: str = "active_set",
        radius: float = 5.0,
        tool_radius: float = 0.0,
        tool: ConvexTool | None = None,
        narrow_phase: str = "exact",
        margin: float = 0.2,
        damping: float = 0.0,
        recovery: float = 0.05,
        deepest: float = 10.0,
        refinements: int = 3,
        nodes: int = 0,
        query: Literal["motion", "sphere"] = "motion",
        distances: Literal["where_known", "always"] = "where_known",
        inside: Literal["led_out", "taken_as_is"] = "led_out",
        max_triangles: int = 65536,
        max_planes: int = 16384,
        max_joints: int = 7,
        max_rows: int = 64,
        max_looks: int = 0,
    ) -> None: ...
    def step(
        self,
        tip: ArrayLike,
        desired: ArrayLike,
        jacobian: ArrayLike | None = None,
        rows: tuple[ArrayLike, ArrayLike] | None = None,
    ) -> Step: ...
    def forget(self) -> None: ...
    def follow(self, index: Index) -> None: ...
    def free_polytope(self, tip: ArrayLike, radius: float) -> Polytope: ...
    def steps(
        self,
        tips: ArrayLike,
        desired: ArrayLike,
        *,
        threads: int | None = None,
        out: Steps | None = None,
    ) -> Steps: ...
    def replay(
        self,
        poses: ArrayLike,
        *,
        closed_loop: bool = False,
        max_step: float = 1.0,
        out: Steps | None = None,
    ) -> Steps: ...
    def simulate(
        self,
        starts: ArrayLike,
        hands: ArrayLike,
        *,
        max_step: float = 0.5,
        threads: int | None = None,
        out: Simulation | None = None,
    ) -> Simulation: ...
    @property
    def mesh(self) -> Mesh: ...
    @property
    def index(self) -> Index: ...
    @property
    def radius(self) -> float: ...
    @property
    def tool_radius(self) -> float: ...
    @property
    def tool(self) -> ConvexTool | None: ...
    @property
    def margin(self) -> float: ...
    @property
    def distance_kept(self) -> float: ...

class Joint:
    def __init__(
        self,
        name: str = "",
        *,
        kind: Literal["revolute", "prismatic"] = "revolute",
        origin: ArrayLike | None = None,
        axis: ArrayLike | None = None,
        lower: float | None = None,
        upper: float | None = None,
        velocity: float | None = None,
        increment: float | None = None,
    ) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def kind(self) -> Literal["revolute", "prismatic"]: ...
    @property
    def lower(self) -> float: ...
    @property
    def upper(self) -> float: ...
    @property
    def velocity(self) -> float: ...
    @property
    def increment(self) -> float: ...

class TableRow:
    def __init__(
        self,
        name: str = "",
        *,
        kind: Literal["revolute", "prismatic"] = "revolute",
        a: float = 0.0,
        alpha: float = 0.0,
        d: float = 0.0,
        theta: float = 0.0,
        lower: float | None = None,
        upper: float | None = None,
        velocity: float | None = None,
        increment: float | None = None,
    ) -> None: ...

class Chain:
    def __init__(
        self,
        joints: Sequence[Joint],
        *,
        base: ArrayLike | None = None,
        flange: ArrayLike | None = None,
    ) -> None: ...
    def place(self, q: ArrayLike) -> NDArray[np.float64]: ...
    @property
    def joints(self) -> list[Joint]: ...
    @property
    def base(self) -> NDArray[np.float64]: ...
    @property
    def flange(self) -> NDArray[np.float64]: ...
    def __len__(self) -> int: ...

def chain_of_table(
    rows: Sequence[TableRow],
    *,
    convention: Literal["modified", "standard"] = "modified",
    base: ArrayLike | None = None,
    flange: ArrayLike | None = None,
) -> Chain: ...
def read_chain(
    path: str | PathLike[str],
    *,
    base: str = "",
    tip: str = "",
    scale: float = 1000.0,
) -> Chain: ...

class Body:
    def __init__(
        self, name: str, points: Sequence[tuple[int, ArrayLike]], radius: float
    ) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def points(self) -> list[tuple[int, tuple[float, float, float]]]: ...
    @property
    def radius(self) -> float: ...

class Instrument:
    def __init__(self, chain: Chain, bodies: Sequence[Body]) -> None: ...
    @property
    def chain(self) -> Chain: ...
    @property
    def bodies(self) -> list[Body]: ...
    def recommended_band(self, period: float, least: float = 0.002) -> float: ...

class InstrumentStep:
    @property
    def status(self) -> Status: ...
    @property
    def ok(self) -> bool: ...
    @property
    def reason(self) -> str: ...
    @property
    def increment(self) -> NDArray[np.float64]: ...
    @property
    def share(self) -> float: ...
    @property
    def rounds(self) -> int: ...
    @property
    def rows(self) -> int: ...
    @property
    def distance(self) -> float | None: ...
    @property
    def nearest(self) -> int | None: ...

class MotionProof:
    @property
    def status(self) -> Status: ...
    @property
    def reason(self) -> str: ...
    @property
    def share(self) -> float: ...
    @property
    def distance(self) -> float | None: ...
    @property
    def is_clear(self) -> bool: ...

class InstrumentGuard:
    def __init__(
        self,
        mesh: Mesh,
        instrument: Instrument,
        *,
        index: str | Index = "wide_bvh",
        index_cache: str | PathLike[str] | None = None,
        solver: str = "active_set",
        margin: float = 0.2,
        band: float = 0.002,
        period: float = 0.001,
        recovery: float = 0.05,
        damping: float = 0.1,
        orientation_weight: float = 20.0,
        refinements: int = 1,
        check_sides: bool = True,
        certified: Literal["actual", "linearised"] = "actual",
        max_triangles: int = 16384,
        max_planes: int = 128,
        max_looks: int = 0,
    ) -> None: ...
    def step(
        self,
        q: ArrayLike,
        linear: ArrayLike | None = None,
        angular: ArrayLike | None = None,
        *,
        increment: ArrayLike | None = None,
        weights: ArrayLike | None = None,
    ) -> InstrumentStep: ...
    def prove(self, q: ArrayLike, increment: ArrayLike) -> MotionProof: ...
    def proofs(
        self,
        q: ArrayLike,
        increments: ArrayLike | None = None,
        *,
        threads: int | None = None,
    ) -> Proofs: ...
    def forget(self) -> None: ...
    def set_options(
        self,
        *,
        margin: float | None = None,
        band: float | None = None,
        period: float | None = None,
        recovery: float | None = None,
        damping: float | None = None,
        orientation_weight: float | None = None,
        refinements: int | None = None,
        check_sides: bool | None = None,
        certified: Literal["actual", "linearised"] | None = None,
    ) -> None: ...
    @property
    def mesh(self) -> Mesh: ...
    @property
    def index(self) -> Index: ...
    @property
    def instrument(self) -> Instrument: ...
    @property
    def margin(self) -> float: ...
    @property
    def band(self) -> float: ...
