# SPDX-License-Identifier: BSD-3-Clause
"""A robot of the user's own in every command: a six-joint arm from a URDF, with bodies of a file or of its shapes.

Each command is typed as in docs/robots.md. The judges of the commands have their own kinematics and distances.
"""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

keepout = os.environ["KEEPOUT_COMMAND"]
robots = Path(__file__).parents[2] / "fixtures/robots"
own = "--robot robots/six_joint_arm.urdf --bodies robots/six_joint_arm.json"
bodies = ["upper_arm", "forearm", "wrist", "holder", "bit"]
shapes = ["base_link", "shoulder", "upper_arm", "forearm", "wrist_2", "holder", "bit"]


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "robots").mkdir()
    for file in robots.glob("six_joint_arm*"):
        shutil.copy(file, tmp_path / "robots")
    return tmp_path


def run(folder, arguments, expected=0, lines=None):
    ended = subprocess.run([keepout, *arguments.split()], cwd=folder, input=lines, capture_output=True, text=True,
                           timeout=60, env={**os.environ, "LC_ALL": "C.UTF-8", "KEEPOUT_WEB": "nowhere"})
    if "there is no command" in ended.stderr or "built without OMPL" in ended.stderr:
        pytest.skip(f"this build has no '{arguments.split()[0]}'")
    assert ended.returncode == expected, ended.stderr + ended.stdout
    return ended


@pytest.mark.parametrize("more, names", [(own, bodies), ("--robot robots/six_joint_arm.urdf", None)])
def test_simulate_keeps_all_bodies_off_the_mesh(folder, more, names):
    if names is None:  # the leaves of the URDF are several: the file names the tip, and the bodies are the shapes
        names = shapes
        (folder / "tip.json").write_text('{"base": "base_link", "tip": "tip"}')
        more += " --bodies tip.json"
    ended = run(folder, f"simulate gear {more} --strokes 3 --cycles 150 --speed 5 --json r.json --out r.html")
    record = json.loads((folder / "r.json").read_text())
    assert [body["name"] for body in record["bodies"]] == names
    rows = {row["mode"]: row for row in record["rows"]}
    assert rows["certified"]["cycles"] == 450
    assert rows["certified"]["below"] == rows["certified"]["in_mesh"] == rows["certified"]["limits_broken"] == 0
    assert rows["certified"]["refused"] < 450
    assert rows["none"]["in_mesh"] > 0, "the strokes do not test the guard"
    assert "kept all bodies (" + ", ".join(names[:-1]) in record["headline"]
    schema = json.loads((Path(__file__).parents[2] / "docs/schemas/record.json").read_text())
    jsonschema = pytest.importorskip("jsonschema", reason="needs python3-jsonschema")
    assert list(jsonschema.Draft202012Validator(schema).iter_errors(record)) == []
    stroke = record["meshes"][0]["strokes"][0]
    for run_of_mode in stroke["runs"]:
        assert len(run_of_mode["places"][0]) == len(run_of_mode["begins"][0]) == len(names)
    says = "link 'wrist_1' has no collision element: nothing of it is guarded" in ended.stderr
    assert says == (names is shapes)


def test_the_same_seed_gives_the_same_run(folder):
    def rows():
        run(folder, f"simulate gear {own} --strokes 2 --cycles 60 --speed 5 --json r.json --out r.html")
        record = json.loads((folder / "r.json").read_text())
        return record["rows"], record["meshes"]
    assert rows() == rows()


def test_verify_finds_no_breach(folder):
    ended = run(folder, f"verify gear {own} --cycles 1200 --json r.json")
    record = json.loads((folder / "r.json").read_text())
    assert "No breach in" in ended.stdout
    assert record["robot"] == "robots/six_joint_arm.urdf"
    total = record["total"]
    assert total["cycles"] > 4000 and total["below"] == total["limits_broken"] == total["strayed"] == 0
    assert any(row["least_beyond_tau"] is not None for row in record["rows"]), "no body came near"
    assert sum(row["blocked_share"] or 0 for row in record["rows"]) > 0, "the mesh limited no motion"


def test_verify_finds_a_breach_of_the_linearized_motion(folder):
    """The judge of the user's robot sees what the certified step prevents."""
    run(folder, f"verify gear {own} --cycles 3000 --scenario approach --speed 20 --motion linearized --json r.json")
    record = json.loads((folder / "r.json").read_text())
    assert record["total"]["below"] > 0


def test_plan_finds_paths_that_the_oracle_accepts(folder):
    run(folder, f"plan gear {own} --problems 1 --seeds 1 --seed 3 --seconds 20 --resolution 0.02 --json r.json")
    record = json.loads((folder / "r.json").read_text())
    certified = [row for row in record["summaries"] if row["checker"] == "certified"]
    assert certified[0]["solved"] == 1
    assert certified[0]["too_close"] == certified[0]["unproven"] == 0


def test_live_writes_a_page_that_says_that_it_is_a_recorded_run(folder):
    ended = run(folder, f"live cube {own} --no-open --out page.html")
    text = " ".join(re.sub("<[^>]*>", " ", (folder / "page.html").read_text()).split())
    for shown in (text, " ".join(ended.stdout.split())):
        assert "This page shows a recorded run only: the tool in it cannot be dragged." in shown
    assert "kept all bodies" in text


identity = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


def test_serve_guards_the_robot(folder):
    opened = {"do": "instrument", "urdf": "robots/six_joint_arm.urdf", "margin": 0.5}
    named = {**opened, "bodies": "robots/six_joint_arm.json",
             "frame": [[1, 0, 0, 0], [0, -1, 0, 90], [0, 0, -1, 962], [0, 0, 0, 1]]}  # hangs above the cube
    down = {"do": "joint_step", "linear": [0, 0, -0.2]}
    q = [0, -0.7, 1.4, 0, -0.87, 0]  # the tip is 20 mm above the cube
    process = subprocess.Popen([keepout, "serve", "cube"], cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               text=True)

    def ask(request):
        process.stdin.write(json.dumps(request) + "\n")
        process.stdin.flush()
        return json.loads(process.stdout.readline())

    answer = ask({"id": 1, **named})
    assert answer["joints"] == ["pan", "lift", "elbow", "roll", "bend", "spin"]
    assert answer["body_names"] == bodies and answer["bodies"] == 5 and answer["notices"] == []
    limited = 0
    least = None
    for _ in range(400):
        answer = ask({"id": 2, **down, "q": q})
        assert answer["ok"], answer
        q = [a + b for a, b in zip(q, answer["increment"])]
        limited += answer["status"] == "limited"
        least = answer.get("distance", least)
    assert limited > 50 and least is not None and least > 0.49
    # The shapes, and a pose that replaces that of the file.
    answer = ask({"id": 3, **opened, "base_link": "base_link", "tip_link": "tip", "frame": identity})
    assert answer["body_names"] == shapes
    assert "nothing of it is guarded" in answer["notices"][0]
    both = ask({"id": 4, **named, "capsules": [[6, 0, 0, 0, 6, 0, 0, 9, 1]]})
    assert both["error"]["kind"] == "no_instrument" and "omit one of them" in both["error"]["message"]
    process.stdin.close()
    assert process.wait(timeout=10) == 0
    process.stdout.close()


# Files of bodies, and texts of the message. tests/robot/read_robot_test.cpp has each fault of a file.
point = '{"link":"%s","xyz_mm":[0,0,%s]}'
one = '{"name":"a","radius_mm":1,"points":[%s]}'
faulty = {
    "empty": ("", "it is empty; name a file of JSON"),
    "missing_link": ('{"bodies":[%s]}' % (one % (point % ("drll", 0))), "no link 'drll'; did you mean 'drill'?"),
    "missing_tip": ('{"tip":"tap"}', "there is no link 'tap'; did you mean 'tip'?"),
    "not_finite": ('{"bodies":[%s]}' % (one % (point % ("drill", "NaN"))), "is not JSON: line 1"),
    "infinite": ('{"bodies":[%s]}' % (one % (point % ("drill", "1e999"))), "is not JSON: "),
    "too_many": ('{"bodies":[%s]}' % ",".join(17 * ["{}"]), "bodies must be an array of 1 to 16, and has 17"),
    "unknown": ('{"bodies":[{"nam":"a"}]}', 'bodies[0] has an unknown field "nam"; did you mean "name"?'),
}


@pytest.mark.parametrize("command", ["simulate gear", "verify gear", "plan gear", "live gear --no-open", "serve"])
@pytest.mark.parametrize("name", faulty)
def test_each_command_refuses_a_faulty_file_and_names_it(folder, command, name):
    content, says = faulty[name]
    (folder / "bad.json").write_text(content)
    before = sorted(path.name for path in folder.rglob("*"))
    if command == "serve":
        line = json.dumps({"do": "instrument", "urdf": "robots/six_joint_arm.urdf", "bodies": "bad.json"})
        answer = json.loads(run(folder, "serve cube", lines=line + "\n").stdout)
        message = answer["error"]["message"]
        assert answer["error"]["kind"] == "no_instrument"
    else:
        message = run(folder, f"{command} --robot robots/six_joint_arm.urdf --bodies bad.json", 1).stderr
    assert says in message and ("bad.json" in message or "six_joint_arm.urdf" in message), message
    assert sorted(path.name for path in folder.rglob("*")) == before


@pytest.mark.parametrize("command", ["simulate gear", "verify gear", "plan gear", "live gear --no-open"])
@pytest.mark.parametrize("more, status, says", [
    ("--robot none.urdf", 2, "--robot: there is no file 'none.urdf'"),
    ("--robot psm --bodies robots/six_joint_arm.json", 1, "--bodies: the robot 'psm' has its own bodies"),
    ("--bodies robots/six_joint_arm.json", 2, "--bodies can only be used together with --robot"),
    ("--robot robots/six_joint_arm.json", 1, "not XML"),
    ("--robot broken.urdf", 1, "link 'rod', collision 1: "),
])
def test_each_command_refuses_a_faulty_robot(folder, command, more, status, says):
    (folder / "broken.stl").write_text("solid a\nfacet normal 0 0 1\n")
    (folder / "broken.urdf").write_text("""<robot name="arm"><link name="base"/><link name="rod"><collision><geometry>
        <mesh filename="broken.stl"/></geometry></collision></link><joint name="slide" type="prismatic">
        <parent link="base"/><child link="rod"/><limit lower="0" upper="0.1" velocity="1" effort="1"/></joint></robot>""")
    message = run(folder, f"{command} {more}", status).stderr
    assert says in message, message


def test_no_command_overwrites_a_file_of_the_robot(folder):
    shutil.copy(folder / "robots/six_joint_arm.json", folder / "bodies.html")
    kept = (folder / "bodies.html").read_text()
    line = "--robot robots/six_joint_arm.urdf --bodies bodies.html --out bodies.html"
    for command in ("simulate gear", "verify gear", "live gear --no-open"):
        assert "bodies.html" in run(folder, f"{command} {line}", 1).stderr
        assert (folder / "bodies.html").read_text() == kept
