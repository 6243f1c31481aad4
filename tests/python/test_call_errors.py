# SPDX-License-Identifier: BSD-3-Clause
"""The error of a call that does not match a signature names the wrong argument, and what it must be."""

import inspect
import re

import numpy as np
import pytest
from surfaces import psm, sphere

import keepout
from keepout import Body, Chain, Guide, Instrument, InstrumentGuard, Joint, Mesh, MotionConstraint, Region
from keepout._call_errors import in_our_words

vertices, triangles = sphere()
mesh = Mesh(vertices, triangles)
tip = MotionConstraint(mesh)
arm = InstrumentGuard(mesh, Instrument(psm(), [Body("tip", [(6, (0, 0, 0))], 1.0)]))
ball = Region.ball((0, 0, 0), 1.0)
origin = (0, 0, 0)
step = "step(tip, desired, jacobian=None, rows=None)"


@pytest.mark.parametrize(
    "call, says",
    [
        # Missing, additional or unknown arguments.
        (lambda: tip.step(origin), f"step lacks its argument 'desired': call {step}"),
        (lambda: tip.step(), f"step lacks its argument 'tip': call {step}"),
        (lambda: tip.step(origin, origin, None, None, 5), f"step takes 4 arguments by position, got 5: call {step}"),
        (lambda: tip.step(origin, origin, tpi=3),
         "step has no argument 'tpi'; did you mean 'tip'? known: tip, desired, jacobian, rows"),
        (lambda: tip.step(origin, tip=3), "step got its argument 'tip' twice, by position and by name"),
        (lambda: tip.forget(4), "forget takes no argument by position, got 1: call forget()"),
        (lambda: keepout.indices(color=4), "indices has no argument 'color'; known: none"),
        (lambda: keepout.load_mesh("a.stl", "RAS"),
         "load_mesh takes one argument by position, got 2: call load_mesh(path, *, space=None, "
         "untagged=None, unit=None, scale=None, flip=False)"),
        (lambda: Mesh(), "Mesh lacks its argument 'vertices': call Mesh(vertices, triangles, *, weld=False)"),
        (lambda: MotionConstraint(),
         "MotionConstraint lacks its argument 'mesh': call MotionConstraint(mesh, *, index='wide_bvh', "),
        (lambda: tip.set_options(0.5), "set_options takes no argument by position, got 1: call set_options(**options)"),
        (lambda: Region.ball(origin), "ball lacks its argument 'radius': call ball(center, radius)"),
        # Types.
        (lambda: keepout.load_mesh(3), "load_mesh: path: expected the path of a file, got 3"),
        (lambda: keepout.load_mesh("a.stl", space=3), "load_mesh: space: expected a string or None, got 3"),
        (lambda: Mesh(vertices, triangles, weld="no"), "Mesh: weld: expected True or False, got 'no'"),
        (lambda: InstrumentGuard(mesh, mesh), "InstrumentGuard: instrument: expected a keepout.Instrument, got keepout.Mesh"),
        (lambda: Instrument(psm(), [3]), "Instrument: bodies[0]: expected a keepout.Body, got 3"),
        (lambda: Body("a", 6, 1.0), "Body: points: expected a list, got 6"),
        (lambda: Body("a", [(6, origin)], None), "Body: radius: expected a number, got None"),
        (lambda: Chain([Joint(), "joint"]), "Chain: joints[1]: expected a keepout.Joint, got 'joint'"),
        (lambda: Joint("a", lower="far"), "Joint: lower: expected a number or None, got 'far'"),
        (lambda: keepout.read_chain(np.zeros(3)), "read_chain: path: expected the path of a file, got numpy.ndarray"),
        (lambda: arm.place("0", np.eye(4)), "place: mesh: expected a whole number, got '0'"),
        (lambda: arm.add_mesh(mesh), "add_mesh: index: expected a keepout.Index, got keepout.Mesh"),
        (lambda: tip.free_polytope(origin, "wide"), "free_polytope: radius: expected a number, got 'wide'"),
        (lambda: tip.steps([origin], [origin], threads=1.5), "steps: threads: expected a whole number or None, got 1.5"),
        (lambda: Region.ball(origin, "1"), "ball: radius: expected a number, got '1'"),
        (lambda: Region.ball(origin, True), "ball: radius: expected a number, got True"),
        (lambda: Region.ball(origin, np.True_), "ball: radius: expected a number, got numpy.bool"),
        (lambda: Region.ball(origin, np.array(["0.3"])), "ball: radius: expected a number, got numpy.ndarray"),
        (lambda: Joint("a", lower=False), "Joint: lower: expected a number or None, got False"),
        (lambda: Guide.point("a", True, origin, ball), "point: link: expected a whole number, got True"),
        (lambda: mesh.inspect(places=True), "inspect: places: expected a whole number, got True"),
        (lambda: tip.steps([origin], [origin], threads=True), "steps: threads: expected a whole number or None, got True"),
        (lambda: Guide.point("a", "ball"), "point: region: expected a keepout.Region, got 'ball'"),
        (lambda: Guide.point("a", 6.5, origin, ball), "point: link: expected a whole number, got 6.5"),
        (lambda: Guide.point(None, ball), "point: name: expected a string, got None"),
        (lambda: MotionConstraint.step(3, origin, origin), "step: self: expected a keepout.MotionConstraint, got 3"),
        (lambda: Guide.point("a"),
         "point: expected point(name, region) or point(name, link, position, region), got point('a')"),
    ],
)
def test_a_call_that_does_not_fit_says_why_in_one_line(call, says):
    with pytest.raises(TypeError) as raised:
        call()
    text = str(raised.value)
    assert text.startswith(says), text
    assert "\n" not in text and "pybind" not in text and "_core" not in text, text


@pytest.mark.parametrize(
    "signatures, args, kwargs, says",
    [
        (["(place: Tuple[int, object]) -> None"], (3,), {}, "f: place: expected a tuple of 2, got 3"),
        (["(place: Tuple[int, object]) -> None"], (("x", 1),), {}, "f: place[0]: expected a whole number, got 'x'"),
        (["(guides: List[Union[keepout._core.Guide, str]]) -> None"], (["a", 3],), {},
         "f: guides[1]: expected a keepout.Guide or a string, got 3"),
        (["(count: int = 3) -> None"], (), {"count": 2**40}, "f: count: 1099511627776 is out of range"),
        (["(a: int) -> None", "(a: int, b: str) -> None"], (1, 2), {}, "f: b: expected a string, got 2"),
        (["(a: some.new.Kind) -> None"], (1,), {}, "f: expected f(a), got arguments of other types"),
    ],
)
def test_any_signature_is_understood(signatures, args, kwargs, says):
    numbered = "".join(f"    {i}. {signature}\n" for i, signature in enumerate(signatures, 1))
    text = f"f(): incompatible function arguments. The following argument types are supported:\n{numbered}\nInvoked with: 1\n"
    assert in_our_words(text, args, kwargs) == says
    assert in_our_words("something else", args, kwargs) is None


def test_numbers_of_numpy_are_numbers():
    for one in (1, np.float32(1), np.int8(1), np.uint64(1), np.array(1.0)):
        assert Region.ball(origin, one).excess((2, 0, 0)) == 1.0
        assert MotionConstraint(mesh, margin=one).margin == 1.0
    for no_number in (True, np.True_, np.array(["0.3"])):
        with pytest.raises(keepout.Error, match="^margin: expected .*, got (True|numpy)"):
            MotionConstraint(mesh, margin=no_number)
        with pytest.raises(keepout.Error, match="^max_rows: expected .*, got (True|numpy)"):
            MotionConstraint(mesh, max_rows=no_number)


def test_a_long_text_is_told_short():
    with pytest.raises(TypeError) as raised:
        tip.free_polytope(origin, 1000 * "x")
    assert len(str(raised.value)) < 120


def test_errors_of_values_keep_their_own_words():
    with pytest.raises(keepout.Error, match="^tip: expected numbers of shape"):
        tip.step((0, 0), origin)
    with pytest.raises(TypeError, match="^MotionConstraint has no argument 'marging'; did you mean 'margin'"):
        MotionConstraint(mesh, marging=0.2)

    class Angry:
        def __float__(self):
            raise TypeError("not today")

    with pytest.raises(TypeError, match="not today|arguments of other types"):
        tip.free_polytope(origin, Angry())


def test_every_function_of_the_module_is_explained():
    """No call with arguments of a wrong type reports pybind11's own message."""

    class Nothing:
        pass

    called = 0
    for owner in (keepout, *(item for item in vars(keepout).values() if inspect.isclass(item))):
        for name in dir(owner):
            function = getattr(owner, name)
            written = getattr(function, "__doc__", None) or ""
            if not re.match(rf"{name}\(", written) or (name.startswith("_") and name != "__init__"):
                continue
            with pytest.raises(TypeError) as raised:
                function(*[Nothing()] * 20)
            called += 1
            assert "incompatible" not in str(raised.value), str(raised.value)
    assert called > 60


def test_an_object_without_a_constructor_is_refused():
    class Early(keepout.MotionConstraint):
        def __init__(self):
            self.first = self.margin

    bare = keepout.MotionConstraint.__new__(keepout.MotionConstraint)
    for use in (lambda: bare.step((0, 0, 60), (0, 0, -1)), lambda: bare.margin, Early):
        with pytest.raises(TypeError, match=r"call __init__ first; in a subclass, super\(\).__init__"):
            use()
