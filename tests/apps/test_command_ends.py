# SPDX-License-Identifier: BSD-3-Clause
"""The end of the keepout command: signals, a closed pipe, progress without a terminal, and --quiet."""

import json
import math
import os
import re
import shutil
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

keepout = os.environ["KEEPOUT_COMMAND"]
root = Path(__file__).parents[2]
patience = 120  # for a command on a busy machine [s]
soon = 5  # enough for something that takes a second if the machine is not busy [s]
stopping = "keepout: stopping and writing the finished results. Repeat the signal to end at once.\n"


def start(folder, *arguments, **environment):
    environment = {**os.environ, "LC_ALL": "C", "KEEPOUT_WEB": "nowhere", **environment}
    return subprocess.Popen([keepout, *arguments], cwd=folder, env=environment, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def run(folder, *arguments, **environment):
    process = start(folder, *arguments, **environment)
    out, err = process.communicate(timeout=patience)
    return process.returncode, out, err


def seconds_until_read(process, text):
    """Reads stderr up to a text, and returns how long that took."""
    begin, read = time.monotonic(), ""
    while text not in read:
        part = process.stderr.readline()
        assert part, f"{text!r} never came, but {read!r}"
        read += part
    return time.monotonic() - begin


def rest_of(process):
    """Returns stdout and the rest of stderr; communicate() would lose what is read already but not yet returned."""
    out, err = process.stdout.read(), process.stderr.read()
    process.wait(timeout=patience)
    return out, err


def stopped(process, number):
    """Sends a signal to the command alone; returns its exit status, stdout and the rest of stderr."""
    process.send_signal(number)
    assert seconds_until_read(process, stopping) < soon
    out, err = rest_of(process)
    return process.returncode, out, err


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_simulate_keeps_the_strokes_that_are_finished(tmp_path, number):
    process = start(tmp_path, "simulate", "cube", "--strokes", "1e5", "--cycles", "100", "--json", "r.json")
    time.sleep(2)
    status, out, err = stopped(process, number)
    record = json.loads((tmp_path / "r.json").read_text())
    strokes = record["runs"][0]["summary"]["strokes"]
    assert status == 130 and not record["complete"]
    assert all(run["summary"]["cycles"] == 100 * strokes > 0 for run in record["runs"]), "whole strokes only"
    assert f"keepout: stopped; {strokes:,} of 100,000 strokes were finished, and are kept in keepout-report.html and r.json" in err
    assert "Report, with tables and settings, no pictures: keepout-report.html" in out
    assert "The command was stopped" in (tmp_path / "keepout-report.html").read_text()


def test_simulate_of_a_robot_has_no_row_of_what_did_not_run(tmp_path):
    process = start(tmp_path, "simulate", "cube", "gear", "--robot", "psm", "--strokes", "1e5", "--cycles", "20",
                    "--json", "r.json")
    time.sleep(3)
    status, out, err = stopped(process, signal.SIGINT)
    record = json.loads((tmp_path / "r.json").read_text())
    assert status == 130 and not record["complete"]
    assert [(row["mesh"], row["speed"], row["mode"]) for row in record["rows"]] == [
        ("cube", 1.0, mode) for mode in ("certified", "linearized", "tip only", "none")]
    assert len({row["cycles"] for row in record["rows"]} - {0}) == 1
    assert [mesh["name"] for mesh in record["meshes"]] == ["cube"]
    assert "gear" not in out and "of 400,000 strokes were finished" in err


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_simulate_writes_nothing_before_a_stroke_is_finished(tmp_path, number):
    process = start(tmp_path, "simulate", "cube", "--cycles", "1e6", "--json", "r.json")
    time.sleep(1)
    process.send_signal(number)
    begin = time.monotonic()
    out, err = process.communicate(timeout=patience)
    assert time.monotonic() - begin < soon
    assert (process.returncode, out) == (130, "")
    assert err == "keepout: stopped before anything was finished: nothing was written\n"
    assert list(tmp_path.iterdir()) == []


def test_replay_keeps_the_steps_that_are_finished(tmp_path):
    count = 1_000_000
    (tmp_path / "poses").write_text("0 0 51 0.1 0 -0.4\n" * count)
    process = start(tmp_path, "replay", "cube", "--poses", "poses", "--out", "s.csv", "--planes", "p.csv",
                    "--activation", "all_faces")
    while not (parts := list(tmp_path.glob("s.csv.partial-*"))) or parts[0].stat().st_size < 1000:
        time.sleep(0.01)
    status, out, err = stopped(process, signal.SIGTERM)
    lines = (tmp_path / "s.csv").read_text().splitlines()
    assert status == 130 and 1 < len(lines) < count
    assert lines[-1].count(",") == lines[0].count(","), "whole lines only"
    assert f"keepout: stopped; {len(lines) - 1:,} of 1,000,000 steps were finished, and are kept in s.csv and p.csv" in err
    assert out.startswith(f"{len(lines) - 1:,} steps -> s.csv")


def test_verify_of_very_many_steps_stops_and_takes_little_memory(tmp_path):
    process = start(tmp_path, "verify", "cube", "--steps", "1e12", "--json", "r.json")
    time.sleep(2)
    peak = int(re.search(r"VmHWM:\s*(\d+) kB", Path(f"/proc/{process.pid}/status").read_text())[1])
    begin = time.monotonic()
    status, _, err = stopped(process, signal.SIGINT)
    assert status == 130, err
    assert time.monotonic() - begin < soon
    assert peak < 500_000, "a list of all trajectories takes 16 GB"
    assert json.loads((tmp_path / "r.json").read_text())["steps_done"] > 0


def test_compare_stops_while_it_records_problems(tmp_path):
    process = start(tmp_path, "compare", "cube", "--poses", "6", "--problems", "1e6", "--json", "r.json")
    time.sleep(3)
    begin = time.monotonic()
    status, _, err = stopped(process, signal.SIGINT)
    assert status == 130, err
    assert time.monotonic() - begin < soon
    assert not json.loads((tmp_path / "r.json").read_text())["complete"]


def test_compare_stopped_before_its_first_row_leaves_an_older_record(tmp_path):
    (tmp_path / "r.json").write_text("precious")
    process = start(tmp_path, "compare", "gear", "--poses", "1e6", "--json", "r.json")
    time.sleep(3)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=patience)
    assert process.returncode == 130 and "stopped before anything was finished: nothing was written" in err
    assert (tmp_path / "r.json").read_text() == "precious"


def test_verify_fails_if_nothing_was_tested(tmp_path):
    status, out, err = run(tmp_path, "verify", "cube", "--robot", "psm", "--scenario", "wedged", "--cycles", "500",
                           "--json", "w.json")
    assert status == 1 and "keepout: nothing was tested" in err, out
    assert json.loads((tmp_path / "w.json").read_text())["headline"] == "Nothing was tested."


@pytest.mark.parametrize("line", ["compare cube --poses 1e6", "verify fan.off --steps 1e12"])
def test_a_signal_before_anything_is_finished_ends_the_command_at_once(tmp_path, line):
    write_fan(tmp_path / "fan.off", 100_000)
    process = start(tmp_path, *line.split(), "--json", "r.json")
    time.sleep(0.4)
    process.send_signal(signal.SIGINT)
    begin = time.monotonic()
    _, err = process.communicate(timeout=patience)
    assert time.monotonic() - begin < soon
    assert process.returncode == 130
    assert err.endswith("keepout: stopped before anything was finished: nothing was written\n")
    assert [path.name for path in tmp_path.iterdir()] == ["fan.off"]


@pytest.mark.parametrize("line", ["simulate cube big.stl --robot psm --strokes 1 --cycles 10 --speed 1",
                                  "verify cube big.stl --robot psm --cycles 10", "verify cube big.stl --steps 1e4"])
def test_a_signal_while_a_later_mesh_is_loaded_keeps_what_is_finished(tmp_path, line):
    random = np.random.default_rng(1)
    triangles = np.zeros(500_000, [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    triangles["corners"] = random.uniform(-100, 100, (len(triangles), 1, 3)) + random.uniform(-0.1, 0.1, (len(triangles), 3, 3))
    (tmp_path / "big.stl").write_bytes(bytes(80) + len(triangles).to_bytes(4, "little") + triangles.tobytes())
    process = start(tmp_path, *line.split(), "--json", "r.json")
    memory = Path(f"/proc/{process.pid}/status")
    while int(re.search(r"VmRSS:\s*(\d+) kB", memory.read_text())[1]) < 120_000:  # the cube needs a third of it
        assert process.poll() is None
        time.sleep(0.005)
    begin = time.monotonic()
    status, _, err = stopped(process, signal.SIGINT)
    assert time.monotonic() - begin < soon
    assert status == 130, err
    record = json.loads((tmp_path / "r.json").read_text())
    assert record["complete"] is False and "big" not in json.dumps(record.get("rows"))


def write_fan(path, triangles):
    """Writes a cone of long triangles around one vertex: each is near all others."""
    corners = ["%.9g %.9g 0" % (50 * math.cos(a), 50 * math.sin(a))
               for a in (2 * math.pi * i / triangles for i in range(triangles))]
    faces = [f"3 0 {i + 1} {(i + 1) % triangles + 1}" for i in range(triangles)]
    path.write_text("\n".join([f"OFF\n{triangles + 1} {triangles} 0\n0 0 10", *corners, *faces]) + "\n")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_inspect_stops_while_it_finds_self_intersections(tmp_path, number):
    write_fan(tmp_path / "fan.off", 100_000)
    process = start(tmp_path, "inspect", "fan.off", "--self-intersections", "--out", "page.html")
    time.sleep(2)
    process.send_signal(number)
    begin = time.monotonic()
    out, err = process.communicate(timeout=patience)
    assert time.monotonic() - begin < soon
    assert (process.returncode, out) == (130, "")
    assert err == "keepout: stopped before anything was finished: nothing was written\n"
    assert [path.name for path in tmp_path.iterdir()] == ["fan.off"]


def test_the_benchmark_of_a_simulation_has_the_mesh_as_it_was_asked_for(tmp_path):
    write_fan(tmp_path / "fan.off", 12)
    process = start(tmp_path, *"simulate fan.off --scale 0.001 --strokes 1 --cycles 20 --bench --verbose --json r.json".split())
    while not process.stdout.readline().startswith("5   "):
        assert process.poll() is None
    process.send_signal(signal.SIGINT)
    rest_of(process)
    row = json.loads((tmp_path / "r.json").read_text())["benchmark"]["rows"][0]
    assert row["hits_mean"] > 11, "all 12 triangles are within 5 mm of a fan of 0.1 mm"


poses = "0 0 60 1 2 -3\n"


@pytest.mark.parametrize("name", ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1", "link", "-"])
def test_a_result_on_stdout_is_appended_to_what_is_there_and_is_alone(tmp_path, name):
    (tmp_path / "poses").write_text(poses)
    (tmp_path / "link").symlink_to("/dev/stdout")
    replay = f"'{keepout}' replay cube --poses poses --out {name}"
    subprocess.run(["bash", "-c", f"echo precious > log; {replay} >> log; (echo one; {replay}; echo two) > other; "
                    f"{replay} | cat > third"], cwd=tmp_path, capture_output=True, timeout=patience, check=True)
    log, other, result = (re.sub(r"(\d+,){4}(?=\d+\n)", "TIMES,", (tmp_path / file).read_text())
                          for file in ("log", "other", "third"))
    assert re.fullmatch(r"step,status,.*,distance\n0,free,.*,TIMES,10\n", result)
    assert log == f"precious\n{result}"
    assert other == f"one\n{result}two\n"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["link", "log", "other", "poses", "third"]


def test_a_result_goes_to_a_terminal_and_to_any_open_file(tmp_path):
    (tmp_path / "poses").write_text(poses)
    terminal, end = os.openpty()
    arguments = [keepout, "replay", "cube", "--poses", "poses", "--out", "-", "--planes", "/dev/fd/3"]
    done = subprocess.run(["bash", "-c", '"$@" 3>> planes', "bash", *arguments], cwd=tmp_path, stdin=end, stdout=end,
                          stderr=subprocess.PIPE, text=True, timeout=patience, check=True)
    assert os.read(terminal, 4096).decode().startswith("step,status,")
    assert (tmp_path / "planes").read_text().startswith("step,triangle,")
    assert "1 step -> -" in done.stderr


def test_a_page_on_stdout_keeps_no_record_beside_it(tmp_path):
    for name in ("-", "/dev/stdout"):
        status, out, _ = run(tmp_path, "inspect", "cube", "--out", name)
        assert status == 0 and out.startswith("<!") and out.rstrip().endswith("</html>")
    assert not list(tmp_path.iterdir()) and not Path("/dev/stdout.json").exists()


@pytest.mark.parametrize("line, kept, lost", [
    ("verify cube --steps 20 --json kept.json --out - > /dev/full", "kept.json", "stdout"),
    ("simulate cube --strokes 1 --cycles 20 --json kept.json --out - > /dev/full", "kept.json", "stdout"),
    ("replay cube --poses poses --planes kept.csv --out lost.csv", "kept.csv", "lost.csv"),
])
def test_a_result_that_cannot_be_written_does_not_take_the_others_with_it(tmp_path, line, kept, lost):
    (tmp_path / "poses").write_text(1000 * poses)
    limit = "ulimit -f 8; " if lost != "stdout" else ""
    done = subprocess.run(["bash", "-c", f"{limit}'{keepout}' {line}"], cwd=tmp_path, capture_output=True, text=True,
                          timeout=patience, check=False)
    assert done.returncode == 1
    assert (f"keepout: {lost}: could not be written to the end; is the disk full? (these were written: {kept})\n"
            in done.stderr)
    assert "No breach" in done.stderr or "verify" not in line
    text = (tmp_path / kept).read_text()
    assert json.loads(text) if kept.endswith("json") else text == "step,triangle,nx,ny,nz,offset\n"
    assert sorted(path.name for path in tmp_path.iterdir()) == [kept, "poses"]


def preparation(folder, text):
    """Writes a program that prepares sample meshes. Returns the environment in which keepout uses it."""
    program = folder / "prepare"
    program.write_text(f"#!/bin/sh\n{text}\n")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    return {"KEEPOUT_PREPARE": str(program), "KEEPOUT_CACHE": str(folder / "cache")}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("command", ["inspect liver", "verify", "plan"])
def test_a_signal_ends_the_preparation_of_a_sample_mesh(tmp_path, command, number):
    environment = preparation(tmp_path, "echo $$ > child; echo preparing; sleep 1000 & wait")
    process = start(tmp_path, *command.split(), **environment)
    seconds_until_read(process, "preparing")
    process.send_signal(number)
    begin = time.monotonic()
    _, err = rest_of(process)
    assert time.monotonic() - begin < soon
    assert process.returncode == 130, err
    assert err.count("interrupted") == 1
    assert "interrupted while the sample mesh '" in err and "not prepared" not in err
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "child").read_text()), 0)


def test_a_preparation_that_fails_is_not_advised_to_be_run_again(tmp_path):
    status, _, err = run(tmp_path, "inspect", "liver", **preparation(tmp_path, "echo the disk is full; exit 1"))
    assert status == 1
    assert err.startswith("the disk is full\nkeepout: the fixture 'liver' is not prepared: the program '")
    assert "fixtures/prepare" not in err


def test_a_reader_that_is_gone_does_not_keep_bench_from_its_report(tmp_path):
    bench = (f"'{keepout}' bench --mesh cube --index wide_bvh,pd_tree --radius 1 --queries 20 --seconds 0.1 "
             "--json b.json --out b.html")
    done = subprocess.run(["bash", "-c", f"{bench} | head -2; echo ${{PIPESTATUS[0]}}"], cwd=tmp_path, text=True,
                          capture_output=True, timeout=patience, check=True)
    assert done.stdout.splitlines()[2:] == ["1"]
    assert json.loads((tmp_path / "b.json").read_text())["complete"]
    assert (tmp_path / "b.html").exists()
    assert "full" not in done.stderr


def test_bench_fails_if_an_index_misses_triangles(tmp_path):
    _, parts, _ = run(tmp_path, "bench", "--list")
    compiler = shutil.which("cc")
    if "embree is not in this build" in parts or not compiler:
        pytest.skip("needs Embree and a compiler")
    (tmp_path / "wrong.c").write_text("_Bool rtcPointQuery(void) { return 0; }  // and finds nothing\n")
    subprocess.run([compiler, "-shared", "-fPIC", "-o", "wrong.so", "wrong.c"], cwd=tmp_path, check=True)
    arguments = ["bench", "--mesh", "cube", "--index", "embree,wide_bvh", "--activation", "paper", "--radius", "1",
                 "--queries", "20", "--seconds", "0.1", "--json", "b.json"]
    for library, status, wrong in (("", 0, []), (str(tmp_path / "wrong.so"), 1, ["embree"])):
        ended, out, err = run(tmp_path, *arguments, LD_PRELOAD=library)
        benchmark = json.loads((tmp_path / "b.json").read_text())["benchmark"]
        assert ended == status, out + err
        assert [row["index"] for row in benchmark["rows"] if row["wrong"]] == wrong
        assert ("keepout: the answers of 1 of 2 rows are wrong" in err) == bool(wrong)
        assert ("The answers of 1 of 2 rows are wrong." in benchmark["headline"]) == bool(wrong)


def test_a_record_on_stdout_is_the_finished_one(tmp_path):
    arguments = ["--mesh", "cube", "--index", "wide_bvh", "--activation", "paper", "--radius", "1", "--queries", "5",
                 "--seconds", "0.01", "--quiet"]
    status, out, err = run(tmp_path, "bench", *arguments, "--json", "-", "--out", "b.html")
    assert status == 0, err
    assert json.loads(out)["complete"]


long_commands = {
    "simulate": "simulate cube --strokes 1e5 --cycles 1000",
    "simulate --robot": "simulate cube --robot psm --strokes 1e5",
    "replay": "replay cube --poses poses --out s.csv --activation all_faces --radius 200",
    "verify": "verify cube --steps 1e9",
    "bench": "bench --mesh cube --index wide_bvh --radius 1 --queries 1e6 --seconds 1000",
    "inspect": "inspect fan.off --self-intersections",
    "compare": "compare cube --problems 1e5 --poses 6 --pairs 10",
}


@pytest.mark.parametrize("quiet", [[], ["--quiet"]])
def test_without_a_terminal_there_is_a_line_every_ten_seconds_unless_it_is_quiet(tmp_path, quiet):
    folders = {name: tmp_path / name for name in long_commands}
    for folder in folders.values():
        folder.mkdir()
    (folders["replay"] / "poses").write_text("0 0 51 0.1 0 -0.4\n" * 300_000)
    write_fan(folders["inspect"] / "fan.off", 200_000)
    running = {name: start(folders[name], *line.split(), *quiet) for name, line in long_commands.items()}
    time.sleep(14)
    for process in running.values():
        process.send_signal(signal.SIGINT)
    for name, process in running.items():
        _, err = process.communicate(timeout=patience)
        assert process.returncode == 130, f"{name}: {err}"
        # The parts of `compare` are short: it prints the seconds of each one at its end.
        lines = re.findall(r": [\d.]+ s$" if name == "compare" else r" % after 1\d s", err, re.MULTILINE)
        assert bool(lines) != bool(quiet), f"{name}: {err}"
        if quiet:
            assert all(line.startswith("keepout: stopped") for line in err.splitlines()), f"{name}: {err}"


def test_quiet_keeps_warnings_and_goes_before_and_behind_the_command(tmp_path):
    (tmp_path / "m.off").write_text("OFF\n3 1 0\n0 0 0\n0.1 0 0\n0 0.1 0\n3 0 1 2\n")
    for arguments in (["--quiet", "serve", "m.off"], ["serve", "m.off", "-q"]):
        process = start(tmp_path, *arguments)
        process.stdout.close()
        process.stdout = None
        _, err = process.communicate(timeout=patience)
        assert "m.off: the surface is open" in err and "serving" not in err
    status, out, err = run(tmp_path, "simulate", "cube", "--strokes", "1", "--cycles", "10", "--quiet")
    assert (status, err) == (0, "")
    assert "Try next" not in out and "keepout-report.html" in out
    status, out, err = run(tmp_path, "simulate", "cube", "--strokes", "1", "--cycles", "10")
    assert "plain page" in err and "Try next" in out
    assert run(tmp_path, "convert", "cube", "m.ply")[0] == 0
    out = run(tmp_path, "simulate", "m.ply", "--scale", "2.5", "--untagged", "lps", "--strokes", "1", "--cycles", "10")[1]
    assert "keepout inspect m.ply --untagged LPS --scale 2.5 " in out
    assert "keepout convert m.ply --untagged LPS --scale 2.5 CONVERTED.ply " in out
    assert "keepout verify CONVERTED.ply " in out


def test_a_tool_that_never_moves_is_not_praised(tmp_path):
    """The tool is in a cavity of 100 mm whose lengths are in meters."""
    corners = [(x, y, z) for z in (-0.05, 0.05) for y in (-0.05, 0.05) for x in (-0.05, 0.05)]
    faces = ["1 2 0", "3 2 1", "6 5 4", "6 7 5", "4 1 0", "4 5 1", "3 6 2", "7 6 3", "2 4 0", "6 4 2", "5 3 1", "7 3 5"]
    (tmp_path / "meters.off").write_text("OFF\n8 12 0\n" + "".join("%g %g %g\n" % corner for corner in corners)
                                         + "".join(f"3 {face}\n" for face in faces))
    status, out, _ = run(tmp_path, "simulate", "meters.off", "--strokes", "3", "--cycles", "300", "--json", "r.json",
                         "--activation", "all_faces,paper")
    record = json.loads((tmp_path / "r.json").read_text())
    assert status == 1
    for run_of in record["runs"][1:]:
        assert run_of["summary"]["stopped"] == run_of["summary"]["cycles"] == 900
        assert run_of["words"] == ("stood still in all 900 cycles; 3 of 3 strokes began nearer than the required "
                                   "clearance")
        assert run_of["summary"]["starts_too_close"] == 3
    assert record["headline"] == (
        "Rules 'all_faces' and 'paper' tested nothing: the tool stood still in all 900 cycles. "
        "3 of 3 strokes began nearer to the surface than the required clearance, 0.200 mm: is the mesh in millimeters?")
    assert record["headline"] in " ".join(out.split())


def test_terminal_output_is_ascii_in_the_locale_c(tmp_path):
    arguments = ["bench", "--mesh", "cube", "--index", "wide_bvh", "--radius", "1", "--queries", "20", "--seconds", "0.1",
                 "--json", "b.json"]
    for locale, unit in (("C", " us with "), ("C.UTF-8", " µs with ")):
        status, out, err = run(tmp_path, *arguments, LC_ALL=locale)
        assert status == 0 and unit in out
        assert locale != "C" or (out + err).isascii()
        assert "\u00a0" not in out + (tmp_path / "b.json").read_text()


def test_the_client_of_serve_prints_its_usage():
    client = str(root / "examples" / "python" / "serve_client.py")
    for arguments in ([], ["keepout"], ["keepout", "mesh", "more"]):
        done = subprocess.run([sys.executable, client, *arguments], text=True, capture_output=True, check=False)
        assert done.returncode == 2
        assert "Usage: serve_client.py KEEPOUT MESH" in done.stderr and "Traceback" not in done.stderr
