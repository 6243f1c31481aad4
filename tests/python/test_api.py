# SPDX-License-Identifier: BSD-3-Clause
"""Tests the classes and functions of the module."""

import inspect
import re
import warnings

import numpy as np
import pytest
from surfaces import box, sphere

import keepout
from keepout import Status, _core


def test_parts_are_listed_and_each_can_be_used(mesh):
    assert "wide_bvh" in [part.name for part in keepout.indices()]
    assert [part.name for part in keepout.activations()] == ["all_faces", "paper", "certified"]
    assert keepout.solvers()[0].name == "active_set"
    assert all(part.description for part in keepout.indices() + keepout.solvers())
    for part in keepout.indices():
        step = keepout.MotionConstraint(mesh, index=part.name).step((0, 0, 10.5), (0, 0, -1))
        assert step.status == Status.limited, part.name
    for part in keepout.activations():
        inside = "taken_as_is" if part.name != "certified" else "escape"
        guard = keepout.MotionConstraint(mesh, activation=part.name, inside=inside)
        assert guard.step((0, 0, 10.5), (0, 0, -1)).ok, part.name


def test_status_is_the_one_of_cpp():
    assert tuple(status.name for status in Status) == _core._status_names
    assert [int(status) for status in Status] == list(range(len(Status)))
    for subject in ("tip", "instrument", "polytope"):
        assert all(len(status.reason_for(subject)) > 10 for status in Status)
    with pytest.raises(keepout.Error, match="subject"):
        Status.free.reason_for("robot")
    assert [s.name for s in Status if s.ok] == ["free", "limited", "recovering", "truncated", "degraded"]


def test_a_status_is_written_as_its_name():
    assert f"{Status.limited}" == str(Status.limited) == "%s" % Status.limited == "limited"
    assert f"{Status.limited:>9}|{Status.limited:.3}" == "  limited|lim"
    assert f"{Status.limited:d} {Status.limited:02x}" == "1 01"
    assert repr(Status.limited) == "<Status.limited: 1>"
    assert Status.limited == 1 and np.array([1], np.uint8)[0] == Status.limited


def test_a_guard_tells_what_it_keeps(mesh):
    guard = keepout.MotionConstraint(mesh, radius=4.0, tool_radius=0.3, margin=0.2)
    assert (guard.radius, guard.tool_radius, guard.margin) == (4.0, 0.3, 0.2)
    assert guard.distance_kept == 0.3 + 0.2
    for part in ("certified", "wide_bvh", "radius=4", "tool_radius=0.3", "margin=0.2", "triangles"):
        assert part in repr(guard)


def test_a_step_tells_its_distance(mesh, outside):
    known = keepout.MotionConstraint(mesh, tool_radius=0.3, margin=0.2)
    always = keepout.MotionConstraint(mesh, tool_radius=0.3, margin=0.2, distances="always")
    distances = known.index.distances
    for tip in [*outside[0][:50], (0, 0, 10.3), (0, 0, 80.0), (0, 0, 9.0)]:
        true = distances([tip])[0]
        step = known.step(tip, (0, 0, 0))
        is_inside = np.linalg.norm(tip) < 10
        assert (step.distance is not None) == (true <= 0.5 or is_inside)
        if step.distance is not None:
            np.testing.assert_allclose(step.distance, true, rtol=1e-12)
        np.testing.assert_allclose(always.step(tip, (0, 0, 0)).distance, true, rtol=1e-12)
    assert always.step((np.nan, 0, 0), (0, 0, 0)).distance is None


def test_a_step_is_held_back(guard):
    free = guard.step([0, 0, 14], [0, 0, -1])
    assert free.ok and free.status is Status.free and list(free.motion) == [0, 0, -1]
    held = guard.step([0.1, 0.2, 10.6], [0, 0, -1])
    assert held.status is Status.limited and -0.2 < held.motion[2] < 0
    assert len(held.planes) > 0 and held.triangles > 0
    assert np.all(held.planes.normals @ held.motion >= held.planes.offsets - 1e-9)
    np.testing.assert_allclose(np.linalg.norm(held.planes.normals, axis=1), 1)
    assert np.all(held.planes.sources < len(guard.mesh))
    assert np.all(held.active < len(held.planes))
    np.testing.assert_array_equal(held.increment, held.motion)
    assert "limited" in repr(held) and held.reason


def test_joints_and_rows(guard):
    jacobian = np.array([[1.0, 0, 0, 1], [0, 1, 0, 1], [0, 0, 2, 0]])
    guard = keepout.MotionConstraint(guard.mesh, damping=1e-6)
    step = guard.step([0, 0, 14], [0.1, 0.2, -1], jacobian=jacobian)
    assert step.increment.shape == (4,)
    np.testing.assert_allclose(jacobian @ step.increment, step.motion, atol=1e-9)
    np.testing.assert_allclose(step.motion, [0.1, 0.2, -1], atol=1e-4)
    # Rows limit the second and the third joint.
    rows = ([[0.0, 1, 0, 0], [0, 0, 1, 0]], [0.0, -0.1])
    step = guard.step([0, 0, 14], [0, -1, -1], jacobian=np.asfortranarray(jacobian), rows=rows)
    assert step.increment[1] >= -1e-9 and step.increment[2] >= -0.1 - 1e-9
    only_rows = guard.step([0, 0, 14], [0, 0, -1], rows=([[0.0, 0, 1]], [-0.25]))
    np.testing.assert_allclose(only_rows.motion, [0, 0, -0.25], atol=1e-9)
    assert list(only_rows.active) == [len(only_rows.planes)]
    none = keepout.MotionConstraint(guard.mesh).step([0, 0, 14], [0, 0, -1], rows=(np.zeros((0, 3)), []))
    assert list(none.motion) == [0, 0, -1]
    many = keepout.MotionConstraint(guard.mesh, max_joints=3).step([0, 0, 14], [0, 0, 1], jacobian)
    assert many.status is Status.over_capacity


def test_more_than_three_joints_want_damping(mesh):
    jacobian = np.random.default_rng(3).normal(size=(3, 7))
    undamped = keepout.MotionConstraint(mesh).step((0, 0, 14), (0, 0, -1), jacobian)
    assert undamped.status is Status.ill_posed and "set `damping` above 0" in undamped.reason
    assert keepout.MotionConstraint(mesh, damping=1e-6).step((0, 0, 14), (0, 0, -1), jacobian).ok


def test_steps_remember_and_forget():
    # A cube in a cube. Between them, the nearest cube decides the side, unless the last step ended there.
    corners, cube = box(-1, 1)
    mesh = keepout.Mesh(np.vstack([50 * corners, 5 * corners]), np.vstack([cube, cube + 8]))
    assert mesh.inspect().watertight and not mesh.inspect().inside_out
    guard = keepout.MotionConstraint(mesh)
    assert guard.step((0, 0, 26), (0, 0, 4)).status is Status.free
    batch = guard.steps([(0, 0, 26), (0, 0, 30)], [(0, 0, 4), (0, 0, 0.1)])
    assert list(batch.status) == [Status.free, Status.inside]  # each pose by itself
    assert guard.step((0, 0, 30), (0, 0, 0.1)).status is Status.free  # a batch does not change this state
    guard.forget()
    assert guard.step((0, 0, 30), (0, 0, 0.1)).status is Status.inside


def test_a_guard_follows_anatomy_that_moves():
    vertices, triangles = sphere()
    guard = keepout.MotionConstraint(keepout.Mesh(vertices, triangles), margin=0.5)
    before = guard.index
    top = (0, 0, 11.5)
    assert guard.step(top, (0, 0, 0)).status is Status.free
    for swollen, status in ((1.12, Status.recovering), (1.2, Status.recovering), (1.0, Status.free)):
        mesh = keepout.Mesh(swollen * vertices, triangles)
        guard.follow(guard.index.refitted(mesh))
        assert guard.mesh is mesh and guard.index.mesh is mesh and guard.index.name == before.name
        step = guard.step(top, (0, 0, 0))
        assert step.status is status and step.motion[2] >= 0
        assert guard.steps(top, np.zeros((2, 3))).status[1] == status
    assert before.mesh is not guard.mesh  # and does not change
    grid = keepout.Index(guard.mesh, "pd_tree").refitted(keepout.Mesh(2 * vertices, triangles))
    assert grid.name == "pd_tree" and grid.distances([(0, 0, 0)])[0] > 15
    with pytest.raises(keepout.Error, match="triangles must be the same"):
        before.refitted(keepout.Mesh(vertices, triangles[1:]))


def test_the_free_polytope_keeps_the_distance(guard):
    polytope = guard.free_polytope((0, 0, 11.0), radius=2.0)
    assert polytope.ok and polytope.status is Status.free and len(polytope) > 0
    random = np.random.default_rng(1)
    d = random.normal(size=(2000, 3))
    d = d[np.linalg.norm(d, axis=1) <= 2.0]
    d = d[np.all(d @ polytope.normals.T >= polytope.offsets, axis=1)]
    assert len(d) > 100
    assert np.all(guard.index.distances((0, 0, 11.0) + d) >= 0.5 - 1e-9)
    refused = guard.free_polytope((np.nan, 0, 0), 1.0)
    assert not refused.ok and refused.status is Status.invalid_input and len(refused) == 6


def test_queries_and_hits_are_those_of_brute_force(mesh):
    oracle = keepout.Index(mesh, "brute_force")
    for part in keepout.indices():
        index = keepout.Index(mesh, part.name)
        for center, radius in [((0, 0, 9.5), 2.0), ((3.0, 4.0, 8.0), 5.0), ((0, 0, 30), 1.0)]:
            exact, found = oracle.hits(center, radius), index.hits(center, radius)
            np.testing.assert_array_equal(found.triangles, exact.triangles)
            np.testing.assert_array_equal(found.offsets, exact.offsets)
            np.testing.assert_array_equal(found.distances, exact.distances)
            assert set(exact.triangles) <= set(index.query(center, radius))
        np.testing.assert_allclose(
            np.linalg.norm(found.points - center, axis=1), found.distances, rtol=1e-12
        )
    assert index.mesh is mesh and index.memory > 0 and "triangles" in repr(index)
    everything = oracle.hits((0, 0, 0), 100.0)
    assert len(everything) == len(mesh)


def test_distances(mesh):
    index = keepout.Index(mesh)
    points = np.array([[0, 0, 10.0], [0, 0, 12.5], [np.nan, 0, 0], [np.inf, 0, 0], [1e6, 0, 0]])
    found = index.distances(points, threads=2)
    np.testing.assert_allclose(found[:2], [0, 2.5], atol=1e-12)
    assert np.all(np.isnan(found[2:4])) and abs(found[4] - (1e6 - 10)) < 0.2
    many = np.random.default_rng(2).normal(size=(1000, 3)) * 12
    np.testing.assert_array_equal(index.distances(many, threads=1), index.distances(many, threads=3))
    assert index.distances(np.zeros((0, 3))).shape == (0,)
    exact = keepout.Index(mesh, "brute_force").distances(many)
    for part in keepout.indices():
        found = keepout.Index(mesh, part.name).distances(many)
        np.testing.assert_array_equal(found, exact, err_msg=part.name)


def test_an_index_is_kept_on_the_disk_and_shared(mesh, tmp_path):
    index = keepout.Index(mesh, cache=tmp_path)
    assert len(list(tmp_path.iterdir())) == 1
    guard = keepout.MotionConstraint(mesh, index=index)
    assert guard.index is index and guard.mesh is mesh
    again = keepout.MotionConstraint(mesh, index_cache=str(tmp_path))
    assert len(list(tmp_path.iterdir())) == 1
    assert list(again.step((0, 0, 10.5), (0, 0, -1)).motion) == list(
        guard.step((0, 0, 10.5), (0, 0, -1)).motion
    )


def test_an_index_that_cannot_be_kept_is_told_of(mesh, tmp_path):
    in_the_way = tmp_path / "cache"
    in_the_way.write_text("no folder")
    with pytest.warns(UserWarning, match="not stored for the next start"):
        keepout.Index(mesh, cache=in_the_way)


def test_welding_and_inspection():
    vertices, triangles = sphere()
    soup = vertices[triangles].reshape(-1, 3)
    apart = np.arange(len(soup)).reshape(-1, 3)
    with pytest.warns(UserWarning, match="^Mesh: the surface is open") as said:
        loose = keepout.Mesh(soup, apart)
    assert loose.warnings == [str(warning.message) for warning in said]
    loose = loose.inspect()
    assert not loose.closed and loose.boundary_edges == 3 * len(triangles)
    assert loose.genus is None and loose.signed_volume is None and "open" in str(loose)
    welded = keepout.Mesh(soup, apart, weld=True)
    found = welded.inspect(self_intersections=True)
    assert len(welded.vertices) == len(vertices) and found.watertight and found.genus == 0
    assert found.self_intersections == 0 and "watertight" in repr(found)
    assert welded.warnings == []
    with pytest.warns(UserWarning, match="^Mesh: the surface is closed and faces inward"):
        flipped = keepout.Mesh(vertices, triangles[:, ::-1]).inspect()
    with pytest.warns(UserWarning, match='^Mesh: the mesh is 0.2 mm across .*unit="'):
        keepout.Mesh(vertices / vertices.max() / 10, triangles)
    assert flipped.inside_out and flipped.signed_volume < 0
    normals = welded.normals
    assert np.all(np.einsum("ij,ij->i", normals, welded.vertices[welded.triangles[:, 0]]) > 0)


def test_an_inspection_says_where_faults_are():
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [3, 2, 2]]
    found = keepout.Mesh(vertices, triangles).inspect(self_intersections=True)
    assert found.boundary_edges == 3 and found.repeated_vertex_triangles == 1
    edges = found.places["boundary_edges"]
    assert edges.shape == (3, 2, 3)
    np.testing.assert_array_equal(edges[0], [[1, 0, 0], [0, 1, 0]])
    np.testing.assert_array_equal(
        found.places["degenerate_triangles"], [[[0, 0, 1], [0, 1, 0], [0, 1, 0]]])
    assert found.places["pinched_vertices"].shape == (0, 1, 3)
    assert found.places["self_intersections"].shape == (0, 6, 3)
    few = keepout.Mesh(vertices, triangles).inspect(places=1)
    assert few.boundary_edges == 3 and few.places["boundary_edges"].shape == (1, 2, 3)
    assert "self_intersections" not in few.places


def test_loading_tells_what_is_wrong(tmp_path, sphere_file):
    mesh = keepout.load_mesh(str(sphere_file))
    assert mesh.inspect().watertight and mesh.warnings == [] and len(mesh) > 1000
    assert mesh.bounds.shape == (2, 3) and np.all(mesh.bounds[0] < mesh.bounds[1])
    with pytest.raises(keepout.Error, match="absent.stl"):
        keepout.load_mesh(tmp_path / "absent.stl")


def test_a_mesh_is_turned_to_the_space_asked_for(tmp_path):
    text = "# SPACE=LPS\nv 1 2 3\nv 4 2 3\nv 1 5 3\nf 1 2 3\n"
    tagged, bare = tmp_path / "tagged.obj", tmp_path / "bare.obj"
    tagged.write_text(text)
    bare.write_text(text.partition("\n")[2])
    as_it_stands = keepout.load_mesh(tagged)
    assert as_it_stands.space == "LPS" and keepout.load_mesh(bare).space is None
    turned = keepout.load_mesh(tagged, space="RAS")
    assert turned.space == "RAS"
    assert np.array_equal(turned.vertices, as_it_stands.vertices * [-1, -1, 1])
    assert keepout.load_mesh(bare, space="RAS", untagged="RAS").space == "RAS"
    with pytest.raises(keepout.Error, match="untagged"):
        keepout.load_mesh(bare, space="RAS")
    assert keepout.load_mesh(bare, space="ras", untagged="ras").space == "RAS"
    with pytest.raises(keepout.Error, match="space.*'RAS', 'LPS' or None.*'rsa'"):
        keepout.load_mesh(bare, space="rsa")


def test_a_mesh_is_scaled_and_flipped_on_demand_and_says_so(tmp_path, caplog):
    path = tmp_path / "part.obj"
    path.write_text("v 0 0 0\nv .05 0 0\nv 0 .05 0\nv 0 0 .05\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n")
    with pytest.warns(UserWarning, match='part.obj: the mesh is 0.05 mm across.*unit="m"'):
        plain = keepout.load_mesh(path)
    with warnings.catch_warnings(), caplog.at_level("INFO", "keepout"):
        warnings.simplefilter("error")
        mesh = keepout.load_mesh(path, unit="m", flip=True)
    assert mesh.notices == [
        "part.obj: scaled by 1000, from m to mm",
        "part.obj: flipped: each triangle is wound the other way",
    ]
    assert caplog.messages == mesh.notices
    assert (mesh.scale, mesh.flipped, mesh.warnings) == (1000, True, [])
    assert (plain.scale, plain.flipped, plain.notices) == (1, False, [])
    np.testing.assert_array_equal(mesh.vertices, 1000 * plain.vertices)
    np.testing.assert_array_equal(mesh.normals, -plain.normals)
    assert keepout.load_mesh(path, scale=500).scale == 500
    for bad in (0, -1, float("nan"), float("inf")):
        with pytest.raises(keepout.Error, match="scale must be a finite number above 0"):
            keepout.load_mesh(path, scale=bad)
    for bad in ("inch", "", "M"):
        with pytest.raises(keepout.Error, match="unit"):
            keepout.load_mesh(path, unit=bad)
    with pytest.raises(keepout.Error, match="one of them"):
        keepout.load_mesh(path, unit="m", scale=2)


def test_closed_loops_stay_out(guard):
    hands = np.zeros((3, 60, 3))
    hands[:, :, 2] = np.linspace(14, 5, 60)
    hands[1:, :, 0] = 1.5
    starts = hands[:, 0].copy()
    ran = guard.simulate(starts, hands)
    assert ran.tips.shape == (3, 61, 3) and ran.status.shape == (3, 60) and len(ran) == 3
    np.testing.assert_array_equal(ran.tips[:, 0], starts)
    np.testing.assert_array_equal(ran.tips[1], ran.tips[2])
    assert ran.ok.all() and Status.limited in ran.counts() and "limited" in repr(ran)
    assert guard.index.distances(ran.tips.reshape(-1, 3)).min() > 0.5 - 1e-6
    # simulate() gives the same motions as a closed-loop replay.
    poses = np.hstack([hands[1], np.broadcast_to(starts[1], hands[1].shape)])
    alone = guard.replay(poses, closed_loop=True, max_step=0.5)
    np.testing.assert_array_equal(np.cumsum(np.vstack([starts[1], alone.motion]), axis=0), ran.tips[1])


def test_every_public_name_is_documented():
    assert keepout.__doc__ and keepout.__version__
    for name in set(keepout.__all__) - {"__version__"}:
        public = getattr(keepout, name)
        assert public.__doc__ and public.__module__ == "keepout", name
        if inspect.isclass(public) and issubclass(public, (Exception, tuple, int)):
            continue
        members = dict(vars(public)) if inspect.isclass(public) else {}
        for member, value in list(members.items()):
            if member.startswith("_") or member in getattr(public, "__annotations__", {}):
                continue
            assert value.__doc__, f"{name}.{member}"


def test_arrays_are_documented_with_shapes():
    arrays = {"normals", "offsets", "vertices", "triangles", "motion", "sources", "bounds", "points"}
    for name in ("Mesh", "Planes", "Step", "Hits"):
        for member in arrays & set(vars(getattr(keepout, name))):
            if (name, member) == ("Step", "triangles"):
                continue  # a number
            doc = getattr(keepout, name).__dict__[member].__doc__
            assert re.match(r"\(\w+,( \w+)?\) (float64|uint32)", doc), f"{name}.{member}"


def test_what_a_file_has_to_say_is_a_warning(tmp_path):
    path = tmp_path / "tagged.obj"
    path.write_text("# SPACE=LPS\nv 0 0 0\nv 50 0 0\nv 0 50 0\nv 0 0 50\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
    with pytest.warns(UserWarning, match="tagged.obj: .*LPS") as said:
        mesh = keepout.load_mesh(path)
    assert mesh.warnings and [str(w.message) for w in said] == mesh.warnings
    assert said[0].filename == __file__, "of the line that loads the mesh"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(UserWarning):
            keepout.load_mesh(path)
        assert keepout.load_mesh(path, space="LPS").warnings == []


def test_former_names_warn_and_have_the_same_value(mesh):
    guard = keepout.InstrumentGuard(mesh, keepout.free_ball(0.1), margin=0.2)
    proof = guard.prove([0.0, 0.0, 15.0], [0.1, 0.0, 0.0])
    with pytest.warns(DeprecationWarning, match="MotionProof.share is now fraction"):
        assert proof.share == proof.fraction
    with pytest.warns(DeprecationWarning, match="max_looks is now max_work_units"):
        limited = keepout.InstrumentGuard(mesh, keepout.free_ball(0.1), max_looks=1000)
    assert limited.max_work_units == 1000
    assert Status["fallback"] is Status.truncated and Status["yielding"] is Status.degraded
