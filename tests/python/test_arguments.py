# SPDX-License-Identifier: BSD-3-Clause
"""Arguments of every kind are converted, or rejected by name."""

import re

import numpy as np
import pytest
from surfaces import psm, sphere

import keepout
from keepout import ConvexTool, Guide, Region, Status

vertices, triangles = sphere()
sphere_mesh = keepout.Mesh(vertices, triangles)
beside = keepout.MotionConstraint(sphere_mesh, tool_radius=0.3, margin=0.2)
many = np.zeros((500, 3))
above, down = (0, 0, 14), (0, 0, -1)
arm = keepout.InstrumentGuard(sphere_mesh, keepout.Instrument(psm(), [keepout.Body("tip", [(6, (0, 0, 0))], 1.0)]))
near = Region.ball((0, 0, 0), 1.0)
markers = np.array([[0, 95, 20], [70, 40, 35], [-72, 38, 30], [60, -60, 80], [-10, -20, 130.0]])
fit = keepout.fit_rigid(markers, markers)


def refused(match):
    return pytest.raises(keepout.Error, match=match)


@pytest.mark.parametrize(
    "call, says",
    [
        (lambda: keepout.Mesh(np.full((3, 3), np.nan), [[0, 1, 2]], weld=True), "finite"),
        (lambda: keepout.MotionConstraint(sphere_mesh, index=keepout.Index(keepout.Mesh(vertices, triangles))),
         "index: expected an Index of the same Mesh"),
        (lambda: keepout.MotionConstraint(vertices), "mesh: expected a keepout.Mesh, got numpy.ndarray"),
        (lambda: keepout.Index("skull.stl"), "mesh: expected a keepout.Mesh, got str"),
        (lambda: beside.index.hits((0, 0, 0), -1.0), "radius: expected a finite number not below zero"),
        (lambda: beside.index.query((0, 0, np.nan), 1.0), "center: expected finite numbers"),
        # Masks are not ignored.
        (lambda: beside.step(np.ma.masked_array([0.0, 0, 14], mask=[0, 1, 0]), down), "tip: .* masked array"),
        (lambda: beside.steps(np.ma.masked_array(many, mask=False), many), "tips: .* masked array"),
        # Jacobians and rows.
        (lambda: beside.step(above, down, jacobian=np.zeros((2, 3))), r"jacobian: .* \(3, n\), got shape \(2, 3\)"),
        (lambda: beside.step(above, down, jacobian=np.zeros((3, 0))), "jacobian: "),
        (lambda: beside.step(above, down, rows=5), "rows: expected a pair"),
        (lambda: beside.step(above, down, rows=([[1, 0, 0]],)), "rows: expected a pair"),
        (lambda: beside.step(above, down, rows=([[1, 0]], [0])), r"rows\[0\]: .* \(m, 3\), got shape \(1, 2\)"),
        (lambda: beside.step(above, down, rows=([[1, 0, 0]], [0, 1])), r"rows\[1\]: .* \(1,\), got shape \(2,\)"),
        (lambda: beside.step(above, down, np.eye(3), ([[1, 0, 0, 0]], [0])), r"rows\[0\]: .* \(m, 3\)"),
        # Batches.
        (lambda: beside.steps(many, many[1:]),
         r"desired: .* \(500, 3\), as many as tips, or \(3,\), got shape \(499, 3\)"),
        (lambda: beside.steps((0, 0), down), r"tips: .* \(n, 3\) or \(3,\), got shape \(2,\)"),
        (lambda: beside.steps(above, np.zeros(4)), r"desired: .* \(n, 3\) or \(3,\), got shape \(4,\)"),
        (lambda: beside.steps(many, many[None]), r"desired: .* got shape \(1, 500, 3\)"),
        (lambda: beside.replay(many), r"poses: .* \(n, 6\)"),
        (lambda: beside.simulate(many, many), r"hands: .* \(500, cycles, 3\)"),
        *((lambda n=n: beside.steps(many, many, threads=n), f"threads: expected 1 to 1024, .* got {n}")
          for n in (0, -3, 1025)),
        (lambda: beside.simulate(many, many[:, None], max_step=5.1), "max_step: "),
        (lambda: beside.replay(np.zeros((1, 6)), closed_loop=True, max_step=np.nan), "max_step: "),
        # Convex tools.
        (lambda: ConvexTool.capsule((0, 0), (0, 0, 1), 1), "start: expected"),
        (lambda: ConvexTool.sphere(1).rotated(2 * np.eye(3)), "rotation"),
        (lambda: keepout.MotionConstraint(sphere_mesh, tool=ConvexTool.sphere(1), tool_radius=0.5),
         "leave tool_radius at 0"),
        (lambda: keepout.MotionConstraint(sphere_mesh, tool="sphere:-1"), "the tool 'sphere': .*; write sphere:R or"),
        (lambda: keepout.MotionConstraint(sphere_mesh, tool=3),
         "^tool: expected a keepout.ConvexTool or the text of one, such as .*, got int$"),
        # Guides.
        (lambda: arm.set_guides([Guide.point("far", 7, (0, 0, 0), near)]), "link 7"),
        (lambda: Guide.point("a", 6, (0, 0, 0), near).with_band(0), "band"),
        (lambda: Region.ball((0, 0, 0), -1), "radius: expected a number from 1e-15 to 1e15, got -1"),
        (lambda: Region.slab((0, 0, 0), (0, 0, 1), np.nan), "half_width: expected a number from 1e-15 to 1e15, got nan"),
        (lambda: Guide.point("a", near).with_band(-1), "the band of guide 'a' must be a length above 0, got -1"),
        (lambda: Guide.axis("a", 6, (0, 0, 1), (0, 0, 1), 4.0), "at most 3 rad: 4"),
        (lambda: keepout.Instrument(
            psm(), [keepout.Body("a", [(6, (0, 0, 0))], -1.0)]), "the radius of body 1 .* from 0 to 1e15, not -1"),
        (lambda: keepout.Chain([keepout.Joint("turn", lower=1, upper=0)]), "lower limit above its upper one.*: 1 and 0"),
        (lambda: keepout.Chain([keepout.Joint("turn", velocity=-2)]), "limit of velocity that is not above zero: -2"),
        (lambda: arm.add_mesh(arm.index, margin=-1), "margin: expected a length, or 0 for the margin of the options, got -1"),
        (lambda: arm.set_options(band=0.5), "band: expected less than the margin of each mesh, .* is 0.2, got 0.5"),
        (lambda: arm.set_options(band=1e-14), "band: expected more than .*lost in the rounding.*got 1e-14"),
        (lambda: Region.slab((0, 0), (1, 0, 0), 1), r"point: expected .* \(3,\)"),
        (lambda: Guide.remote_center("a", (0, (0, 0, 0)), 4, (0, 0, 0), 1), "^to: expected a pair"),
        (lambda: Guide.of_text("ball:0,0:1"), "the guide 'ball:0,0:1': '0,0' is not a point.*; write "),
        (lambda: beside.set_guides(["ball:0,0,0:1", near]),
         r"^guides\[1\]: expected a keepout.Guide or the text of one, such as .*, got keepout.Region$"),
        (lambda: beside.set_guides([Guide.orientation("a", 6, np.eye(3), 0.1)]), r"^guides\[0\]: .* got list$"),
        (lambda: beside.set_guides("ball:0,0,0:1"), "^guides: expected a list of guides, got str$"),
        (lambda: arm.set_guides(Guide.point("a", near)), "^guides: expected a list of guides, got keepout.Guide$"),
        (lambda: beside.set_guides(["tip=point:6:0,0,0:ball:0,0,0:1"]), "a guide of a point without a link"),
        # Registrations.
        (lambda: keepout.fit_rigid(markers[:2], markers[:2]), "at least three pairs"),
        (lambda: keepout.fit_rigid(markers, markers[:4]), "5 measured points, but 4"),
        (lambda: keepout.fit_rigid(markers.T, markers), r"measured: expected .*\(n, 3\)"),
        (lambda: keepout.fit_rigid(markers, markers, weights=[]), "weights: expected one for each"),
        (lambda: keepout.fit_rigid(markers, markers, weights=[1, 1, 1, 1, 0]), r"weights\[4\]"),
        (lambda: keepout.fit_rigid(markers, np.outer(range(5), [1, 2, 3])), "on a line"),
        (lambda: keepout.registration_margin(fit, np.zeros((0, 3))), "no targets"),
        (lambda: keepout.registration_margin(fit, (0, 0, 0), confidence=1), "confidence"),
        (lambda: keepout.target_error(fit, (0, 0, 0), fle=-1), "fle"),
    ],
)
def test_what_is_refused_is_named(call, says):
    with refused(says):
        call()


@pytest.mark.parametrize(
    "bad, says",
    [
        (None, r"vertices: expected numbers of shape \(n, 3\), got None"),
        ("abc", r"vertices: .* dtype <U3"),
        (vertices.T, r"vertices: .* shape \(3, \d+\)"),
        (vertices[0], r"vertices: .* shape \(3,\)"),
        (np.zeros((0, 3)), "triangles: expected vertices from 0"),
        (vertices.astype(complex), "vertices: .* complex128"),
        (vertices.astype(bool), "vertices: .* bool"),
        (vertices.astype(object), "vertices: .* object"),
        ([[1, 2, 3], [4, 5]], "vertices: .* numpy makes no array"),
        (np.where(vertices > 9, np.nan, vertices), "finite"),
        (np.where(vertices > 9, np.inf, vertices), "finite"),
    ],
)
def test_vertices_that_are_refused(bad, says):
    with refused(says):
        keepout.Mesh(bad, triangles)


@pytest.mark.parametrize(
    "bad, says",
    [
        (triangles.astype(float), "triangles: expected integers.* float64"),
        (triangles - 1, "triangles: expected vertices from 0 to .* got -1 in row 0"),
        (triangles + 2**32, "triangles: expected vertices from 0 to"),
        (np.full((1, 3), 2**63, np.uint64), "triangles: "),
        (triangles.ravel(), r"triangles: .* \(m, 3\)"),
        (np.zeros((0, 3), int), "triangle"),
        ([], r"triangles: .* \(m, 3\)"),
        (triangles > 3, "triangles: .* bool"),
    ],
)
def test_triangles_that_are_refused(bad, says):
    for weld in (False, True):
        with refused(says):
            keepout.Mesh(vertices, bad, weld=weld)


def test_any_layout_is_converted():
    usual = keepout.Mesh(vertices, triangles)
    wide = np.zeros((len(vertices), 7))
    wide[:, ::3] = vertices
    for v in (np.asfortranarray(vertices), wide[:, ::3], vertices.tolist(), vertices[::-1][::-1]):
        for dtype in (np.int8 if len(vertices) < 128 else np.int16, np.uint16, np.uint64, ">i4"):
            mesh = keepout.Mesh(v, np.asfortranarray(triangles.astype(dtype)))
            np.testing.assert_array_equal(mesh.vertices, usual.vertices)
            np.testing.assert_array_equal(mesh.triangles, triangles)
    single = keepout.Mesh(vertices.astype(np.float32), triangles)
    np.testing.assert_array_equal(single.vertices, vertices.astype(np.float32).astype(float))
    frozen = vertices.copy()
    frozen.flags.writeable = False
    np.testing.assert_array_equal(keepout.Mesh(frozen, triangles).vertices, vertices)


def test_a_point_comes_in_many_forms(guard):
    exact = guard.step(np.array([0.5, 0.25, 10.75]), np.array([0, 0, -1.0])).motion
    column = np.zeros((3, 4))
    column[:, 1] = 0.5, 0.25, 10.75
    swapped = np.array([0.5, 0.25, 10.75], ">f8")
    unaligned = np.zeros(25, np.uint8)[1:].view(np.float64)
    unaligned[:] = 0.5, 0.25, 10.75
    single = np.array([0.5, 0.25, 10.75], np.float32)
    for tip in ((0.5, 0.25, 10.75), [0.5, 0.25, 10.75], column[:, 1], swapped, unaligned, single):
        for desired in ((0, 0, -1), [0, 0.0, -1], np.array([0, 0, -1], np.int8)):
            guard.forget()
            np.testing.assert_array_equal(guard.step(tip, desired).motion, exact)


def test_what_memory_cannot_hold_is_a_memory_error(guard):
    def many(*shape):
        return np.broadcast_to(1.0, shape)

    for call in (
        lambda: keepout.Mesh(many(2**45, 3), triangles),
        lambda: keepout.Mesh(vertices, np.broadcast_to(np.int32(0), (2**45, 3))),
        lambda: guard.steps(many(2**45, 3), (0, 0, 1)),
        lambda: guard.step((0, 0, 14), (0, 0, 1), jacobian=many(3, 2**45)),
        lambda: guard.step((0, 0, 14), (0, 0, 1), rows=(many(2**45, 3), [])),
    ):
        with pytest.raises(MemoryError):
            call()


@pytest.mark.skipif(np.finfo(np.longdouble).maxexp < 16384, reason="as wide as a double")
def test_numbers_that_fit_no_double_are_refused_where_numpy_is_asked_to(guard):
    wide = np.full((3, 3), np.longdouble("1e4000"))
    with np.errstate(over="raise"):
        for name, arguments in (
            ("tip", (wide[0], (0, 0, 1))),
            ("jacobian", ((0, 0, 14), (0, 0, 1), wide)),
            (r"rows\[0\]", ((0, 0, 14), (0, 0, 1), None, (wide, [0, 0, 0]))),
        ):
            with refused(name + ": expected numbers that fit a double, got dtype"):
                guard.step(*arguments)


def test_a_file_name_that_is_not_text_is_told(tmp_path):
    with refused("no such file") as raised:
        keepout.load_mesh(tmp_path / "a\udcff.stl")
    assert "a\udcff.stl" in str(raised.value)


@pytest.mark.parametrize("bad", [(1, 2), [1.0, 2, 3, 4], np.zeros((1, 3)), 5.0, "xyz", None, {1: 2}])
def test_points_that_are_refused(guard, bad):
    with refused(r"tip: expected numbers of shape \(3,\)"):
        guard.step(bad, (0, 0, 1))
    with refused(r"desired: expected numbers of shape \(3,\)"):
        guard.step((0, 0, 14), bad)
    with refused(r"tip: "):
        guard.free_polytope(bad, 1.0)
    with refused(r"center: "):
        guard.index.hits(bad, 1.0)


def test_what_is_not_finite_is_a_status(guard, outside):
    assert guard.step((np.nan, 0, 14), (0, 0, 1)).status is Status.invalid_input
    assert guard.step((0, 0, 14), (0, np.inf, 1)).status is Status.invalid_input
    assert guard.step((0, 0, 14), (0, 0, 100)).status is Status.beyond_reach
    nan = np.full((3, 2), np.nan)
    assert guard.step((0, 0, 14), (0, 0, 1), nan).status is Status.invalid_input
    tips, desired = outside[0].copy(), outside[1].copy()
    clean = guard.steps(tips, desired)
    tips[10, 1] = np.nan
    desired[20, 2] = -np.inf
    mixed = guard.steps(tips, desired)
    assert list(np.flatnonzero(~mixed.ok)) == [10, 20]
    assert np.all(mixed.motion[[10, 20]] == 0)
    rest = np.setdiff1d(np.arange(len(tips)), [10, 20])
    np.testing.assert_array_equal(mixed.motion[rest], clean.motion[rest])


@pytest.mark.parametrize(
    "settings, says",
    [
        ({"index": "nonsense"}, "no .*'nonsense'; known: .*wide_bvh"),
        ({"index": "wide-bvh"}, "no .*'wide-bvh'; did you mean 'wide_bvh'[?] known: "),
        ({"activation": "certifed"}, "no .*'certifed'; did you mean 'certified'[?] known: "),
        ({"solver": "slsqp"}, "no .*'slsqp'; did you mean 'nlopt_slsqp'[?] known: "),
        ({"activation": "nonsense"}, "known: .*certified"),
        ({"solver": "nonsense"}, "known: .*active_set"),
        ({"index": 5}, "index: expected a name"),
        ({"query": "far"}, "query: expected 'motion' or 'sphere', got 'far'"),
        ({"inside": "ignored"}, "inside: "),
        ({"distances": "never"}, "distances: expected 'where_known' or 'always', got 'never'"),
        ({"radius": -1.0}, "radius"),
        ({"radius": np.nan}, "radius"),
        ({"margin": -1.0}, "^margin: expected 0 or a number from 1e-15 to 1e15, got -1$"),
        ({"margin": np.nan}, "^margin: expected 0 or a number from 1e-15 to 1e15, got nan$"),
        ({"margin": 0.0}, "margin 0 and tool_radius 0 together must be well above"),
        ({"margin": 1e14, "radius": 1e-3}, "^radius: expected more than 1e-9 of .* 1e14 .* got 0.001$"),
        ({"margin": 1e15, "tool_radius": 1e15}, "^margin: expected at most 1e15 together with tool_radius, got 1e15"),
        ({"max_planes": -1}, "max_planes: expected a whole number from 0 to 1073741824, got -1"),
        ({"max_triangles": -1}, "max_triangles"),
        ({"max_planes": 2**40}, "max_planes: .* got 1099511627776"),
        ({"refinements": 1.5}, "refinements: expected a whole number from 0 to 1000, got 1.5"),
        ({"damping": "much"}, "damping: expected a number from 0 to 1e30, got 'much'"),
        ({"nodes": 2**70}, "nodes: expected a whole number from 0 to 65536, got"),
    ],
)
def test_settings_that_are_refused(mesh, settings, says):
    with refused(says):
        keepout.MotionConstraint(mesh, **settings)


def test_empty_batches(guard):
    none = np.zeros((0, 3))
    assert len(guard.steps(none, none)) == 0
    assert len(guard.replay(np.zeros((0, 6)))) == 0
    assert guard.simulate(none, np.zeros((0, 5, 3))).tips.shape == (0, 6, 3)
    still = guard.simulate([(0, 0, 14)], np.zeros((1, 0, 3)))
    assert still.tips.tolist() == [[[0, 0, 14]]] and "none" in repr(still)


def test_batches_of_any_layout(guard, outside):
    tips, desired = outside
    usual = guard.steps(tips, desired)
    frozen = tips.copy()
    frozen.flags.writeable = False
    for t in (np.asfortranarray(tips), tips.tolist(), np.repeat(tips, 2, axis=0)[::2], frozen):
        np.testing.assert_array_equal(guard.steps(t, desired).motion, usual.motion)
    single = tips.astype(np.float32)
    np.testing.assert_array_equal(
        guard.steps(single, desired).motion, guard.steps(single.astype(float), desired).motion
    )


def test_one_point_stands_for_all(guard, outside):
    tips, desired = outside
    same = guard.steps(tips, np.tile(desired[0], (len(tips), 1)))
    for one in (desired[0], desired[:1], desired[0].tolist()):
        np.testing.assert_array_equal(guard.steps(tips, one).motion, same.motion)
    same = guard.steps(np.tile(tips[0], (len(desired), 1)), desired)
    for one in (tips[0], tips[:1], tips[0].tolist()):
        steps = guard.steps(one, desired)
        np.testing.assert_array_equal(steps.motion, same.motion)
        assert len(steps) == len(desired)
    assert len(guard.steps(tips[0], desired[0])) == 1
    assert len(guard.steps(np.zeros((0, 3)), desired[0])) == 0
    assert len(guard.steps(tips[0], np.zeros((0, 3)))) == 0
    room = keepout.Steps.empty(len(tips))
    assert guard.steps(tips, desired[0], out=room) is room


def test_an_unknown_keyword_is_a_type_error(mesh):
    with pytest.raises(TypeError, match="no argument 'marging'; did you mean 'margin'[?] known: mesh"):
        keepout.MotionConstraint(mesh, marging=0.2)
    with pytest.raises(TypeError, match="no argument 'rule'; known: .*activation, solver"):
        keepout.MotionConstraint(mesh, rule="certified")
    # The known names of the message are all arguments that exist.
    with pytest.raises(TypeError) as raised:
        keepout.MotionConstraint(mesh, toolradius=0.2)
    known = str(raised.value).split("known: ")[1].split(", ")
    line = keepout.MotionConstraint.__init__.__doc__.splitlines()[0]
    assert known == re.findall(r"(\w+): ", line)[1:]
    with pytest.raises(TypeError):
        keepout.MotionConstraint(mesh, "wide_bvh")
