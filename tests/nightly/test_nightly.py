# SPDX-License-Identifier: BSD-3-Clause
"""Tests ./test --long with parts that only print: results, the page, Ctrl-C and --resume."""

import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

import pytest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PARTS = """
require_options_of_ctest() { [ "${1:-}" != --nonsense ]; }
# part release: prints its options
part_release() { echo "figure: 12345 steps with $*, $length, $minutes minutes"; }
# part asan: fails
part_asan() { echo "error: 1 < 2 & 3"; return 3; }
# part arm64: needs a program
part_arm64() { echo "skipped: a program is missing"; exit 77; }
# part slow: waits
part_slow() { [ ! -e "$root/fast" ] || return 0; sleep 3600 & echo "$!" > "$results/pid"; wait; }
"""


@pytest.fixture(name="tree")
def made_tree(tmp_path):
    for path in ("tests/nightly/__main__.py", "tests/nightly/page.py", "apps/web/src/page/base.css"):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(SOURCE / path, tmp_path / path)
    (tmp_path / "tests/nightly/parts.sh").write_text(PARTS)
    (tmp_path / "cmake").mkdir()
    (tmp_path / "cmake/set_up.sh").write_text("")
    return tmp_path


def start(tree, *words):
    return subprocess.Popen([sys.executable, tree / "tests/nightly", *words], stderr=subprocess.PIPE, text=True)


def run(tree, *words):
    """Returns the exit status, the output, the results by part, and the page."""
    process = start(tree, *words)
    output = process.communicate(timeout=60)[1]
    return process.returncode, output, *last(tree)


def last(tree):
    folder = max(tree.glob("out/nightly/*"), default=None)
    if folder is None:
        return {}, ""
    return json.loads((folder / "results.json").read_text())["results"], (folder / "index.html").read_text()


def is_running(pid):
    try:
        os.kill(pid, 0)
        return True
    except ProcessLookupError:
        return False


def statuses(results):
    return {part: result["status"] for part, result in results.items()}


def test_the_page_has_each_part_and_the_output_of_a_failure(tree):
    status, output, results, page = run(tree, "--without", "slow", "--minutes", "7")
    assert status == 1
    assert statuses(results) == {"release": "passed", "asan": "failed", "arm64": "skipped"}
    assert results["release"]["notes"] == ["12,345 steps with , long, 7 minutes"]
    assert results["arm64"]["notes"] == ["a program is missing"]
    assert "4 parts: 1 failed, 1 passed, 1 skipped, 1 not run." in output
    assert "<pre>error: 1 &lt; 2 &amp; 3</pre>" in page
    for text in ("12,345 steps with", "a program is missing", "not run", "prints its options", "GiB"):
        assert text in page
    assert not re.search(r"https?://|@import|\bsrc=", page)  # one file


def test_the_exit_status_is_0_if_all_parts_passed_or_were_skipped(tree):
    assert run(tree, "release", "arm64")[0] == 0


def test_options_of_ctest_go_to_two_parts(tree):
    status, _, results, _ = run(tree, "-R", "index")
    assert status == 1 and [*results] == ["release", "asan"]
    assert results["release"]["notes"] == ["12,345 steps with -R index, long, 30 minutes"]
    assert run(tree, "--nonsense")[0] == 1


@pytest.mark.parametrize("words", [["nonsense"], ["--without", "nonsense"], ["--minutes", "0"]])
def test_a_mistake_in_the_arguments_starts_no_part(tree, words):
    status, output, results, _ = run(tree, *words)
    assert status == 2 and "error: " in output and not results


def test_ctrl_c_ends_a_part_and_keeps_the_results_and_resume_continues(tree):
    process = start(tree, "release", "slow", "arm64")
    deadline = time.monotonic() + 30
    while not (pids := [*tree.glob("out/nightly/*/slow/pid")]) or not pids[0].read_text():
        assert time.monotonic() < deadline
        time.sleep(0.05)
    pid = int(pids[0].read_text())
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    assert process.returncode == 1
    assert statuses(last(tree)[0]) == {"release": "passed", "arm64": "skipped", "slow": "stopped"}
    while is_running(pid):
        assert time.monotonic() < deadline + 30
        time.sleep(0.05)

    (tree / "fast").touch()
    status, output, results, _ = run(tree, "release", "slow", "arm64", "--resume")
    assert status == 0 and "==> release" not in output
    assert statuses(results) == {"release": "passed", "arm64": "skipped", "slow": "passed"}
    assert len([*tree.glob("out/nightly/*")]) == 1


def test_each_part_has_a_title():
    text = (SOURCE / "tests/nightly/parts.sh").read_text(encoding="utf-8")
    named = re.findall(r"^part_(\w+)\(\)", text, re.M)
    assert named == re.findall(r"^# part (\w+): .+\npart_\1\(\)", text, re.M) and len(named) > 10
    subprocess.run(["bash", "-n", SOURCE / "tests/nightly/parts.sh"], check=True)
