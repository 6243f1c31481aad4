# SPDX-License-Identifier: BSD-3-Clause
"""Campaigns in shards, on processes of this machine and on a Dask cluster, have the numbers of one machine."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

if "KEEPOUT_COMMAND" not in os.environ:
    pytest.skip("needs the command", allow_module_level=True)
patience = 300  # [s]

tips = ["cube", "gear", "--steps", "20500", "--seed", "3"]
instruments = ["cortex", "--robot", "psm", "--cycles", "6500", "--speed", "5", "--scenario", "approach,raised"]
unsafe = ["cortex", "--robot", "psm", "--cycles", "8000", "--speed", "20", "--scenario", "approach", "--motion", "linearized"]
hostile = ["--scenario", "approach,stuck", "--cycles", "900", "--speed", "1"]


def start(folder, *arguments, **environment):
    return subprocess.Popen([sys.executable, "-m", "keepout.campaign", *arguments], cwd=folder, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, env={**os.environ, **environment})


def run(folder, *arguments, status=0, **environment):
    process = start(folder, *arguments, **environment)
    out, err = process.communicate(timeout=patience)
    assert process.returncode == status, out + err
    return err


def verify(folder, *arguments):
    subprocess.run([os.environ["KEEPOUT_COMMAND"], "verify", *arguments], cwd=folder, check=True, capture_output=True,
                   timeout=patience)


def results(file):
    """Returns the bytes of a record without times, machines and the names of shards."""
    record = json.loads(file.read_text())
    for key in ("shards", "shard_count", "date", "command", "machine"):
        del record[key]
    for row in [*record.get("meshes", []), *record.get("rows", []), record["total"]]:
        for key in [key for key in row if key == "seconds" or key.endswith("_us")]:
            del row[key]
    return json.dumps(record)


def shards_in(folder):
    return sorted((folder / "keepout-campaign" / "shards").glob("*.json"))


@pytest.mark.parametrize("arguments, shards", [(tips, (1, 7)), (instruments, (3, 2)), (unsafe, (4, 1)), (hostile, (3, 2))])
def test_shards_are_the_whole(tmp_path, arguments, shards):
    verify(tmp_path, *arguments, "--json", "whole.json")
    assert (json.loads((tmp_path / "whole.json").read_text())["headline"].startswith("No breach")) == (arguments is not unsafe)
    for count in shards:
        run(tmp_path, *arguments, "--shards", str(count), "--jobs", "2", "--folder", str(count), "--json", "r.json")
        assert results(tmp_path / "r.json") == results(tmp_path / "whole.json")
        assert len(json.loads((tmp_path / "r.json").read_text())["shards"]) == count


def test_a_campaign_that_was_stopped_goes_on(tmp_path):
    arguments = [*tips[:2], "--steps", "160000", "--shards", "40", "--jobs", "2"]
    for number in (signal.SIGINT, signal.SIGTERM):
        process = start(tmp_path, *arguments)
        before = len(shards_in(tmp_path))
        deadline = time.monotonic() + patience
        while len(shards_in(tmp_path)) < before + 3 and time.monotonic() < deadline:
            time.sleep(0.02)
        process.send_signal(number)
        _, err = process.communicate(timeout=patience)
        assert process.returncode == 130 and "the same command continues" in err and "Traceback" not in err
        assert before + 3 <= len(shards_in(tmp_path)) < 40
    kept = {file: file.stat().st_mtime_ns for file in shards_in(tmp_path)}
    kept.popitem()[0].write_text("{")  # torn: it is run again
    run(tmp_path, *arguments, "--json", "r.json")
    assert all(file.stat().st_mtime_ns == kept[file] for file in kept)
    verify(tmp_path, *arguments[:4], "--json", "whole.json")
    assert results(tmp_path / "r.json") == results(tmp_path / "whole.json")


def test_another_campaign_does_not_take_the_shards_of_this_one(tmp_path):
    run(tmp_path, "cube", "--steps", "1000", "--shards", "2")
    for arguments, told in ((["cube", "--steps", "2000", "--shards", "2"], "arguments"),
                            (["cube", "--steps", "1000", "--shards", "1"], "shards")):
        assert f"another campaign: its {told} differ" in run(tmp_path, *arguments, status=1)


def test_mistakes_are_reported(tmp_path):
    for arguments, told in ((["none.stl"], "none.stl"), (["cube", "--steps", "1000"], "use fewer shards"),
                            (["cube", "--shard", "1/2"], "--shard"), (["cube", "--stepps", "9"], "--stepps")):
        err = run(tmp_path, *arguments, "--folder", arguments[-1].replace("/", "_"), status=1)
        assert told in err and "Traceback" not in err


def test_dask_that_is_not_installed_is_named(tmp_path):
    (tmp_path / "distributed.py").write_text("raise ImportError\n")
    err = run(tmp_path, "cube", "--dask", "tcp://localhost:1", status=1, PYTHONPATH=f"{tmp_path}:{os.environ['PYTHONPATH']}")
    assert "apt install python3-distributed" in err and "Traceback" not in err


def test_an_address_that_nobody_answers_is_reported(tmp_path):
    pytest.importorskip("distributed", reason="needs python3-distributed")
    begin = time.monotonic()
    for address in ("tcp://127.0.0.1:9", "nonsense", "tcp://127.0.0.1:http"):
        err = run(tmp_path, "cube", "--dask", address, status=1)
        assert f"no scheduler answers at '{address}'" in err and "Traceback" not in err
    assert time.monotonic() - begin < 60


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """Starts a scheduler and four workers; returns the address and the workers."""
    pytest.importorskip("distributed", reason="needs python3-distributed")
    folder = tmp_path_factory.mktemp("dask")
    file = folder / "scheduler.json"

    def dask(module, *arguments):
        return subprocess.Popen([sys.executable, "-m", f"distributed.cli.{module}", *arguments], cwd=folder,
                                stderr=(folder / "log").open("a"), env={**os.environ, "PYTHONPATH": "", "KEEPOUT_COMMAND": ""})

    begun = [dask("dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(file))]
    while not file.exists():
        assert begun[0].poll() is None, (folder / "log").read_text()
        time.sleep(0.05)
    address = json.loads(file.read_text())["address"]
    workers = [dask("dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--local-directory",
                    str(folder)) for _ in range(4)]
    yield address, workers
    for process in [*workers, *begun]:
        process.kill()
        process.wait()


def programs():
    """Returns the number of `keepout verify --shard` that run."""
    listed = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True, check=True).stdout.splitlines()
    return sum(line.startswith(os.environ["KEEPOUT_COMMAND"]) and "--shard" in line for line in listed)


def test_a_cluster_that_is_stopped_ends_its_programs(tmp_path, cluster):
    process = start(tmp_path, "cube", "--steps", "1e9", "--shards", "8", "--dask", cluster[0])
    before = programs()
    deadline = time.monotonic() + patience
    while programs() < before + 2 and time.monotonic() < deadline:
        time.sleep(0.05)
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=patience)
    assert process.returncode == 130 and "Traceback" not in err
    while programs() > before and time.monotonic() < deadline:
        time.sleep(0.05)
    assert programs() <= before


def test_a_cluster_that_loses_a_worker_makes_the_same_record(tmp_path, cluster):
    address, workers = cluster
    arguments = ["cube", "gear", "--steps", "160000"]
    verify(tmp_path, *arguments, "--json", "whole.json")
    process = start(tmp_path, *arguments, "--shards", "24", "--dask", address, "--json", "r.json")
    deadline = time.monotonic() + patience
    while len(shards_in(tmp_path)) < 4 and time.monotonic() < deadline:
        time.sleep(0.02)
    workers[0].kill()
    out, err = process.communicate(timeout=patience)
    assert process.returncode == 0, out + err
    assert len(shards_in(tmp_path)) == 24
    assert results(tmp_path / "r.json") == results(tmp_path / "whole.json")


def test_a_cluster_runs_instruments(tmp_path, cluster):
    verify(tmp_path, *hostile, "--json", "whole.json")
    run(tmp_path, *hostile, "--shards", "3", "--dask", cluster[0], "--json", "r.json")
    assert results(tmp_path / "r.json") == results(tmp_path / "whole.json")


def test_experiments_run_on_a_cluster(tmp_path, cluster):
    pytest.importorskip("keepout_peers", reason="needs keepout_peers")
    root = Path(__file__).parents[2]
    environment = {name: value for name, value in os.environ.items() if name != "KEEPOUT_COMMAND"}  # makes no page
    for more in ([], ["--dask", cluster[0]]):
        line = [sys.executable, "-m", "experiments", "--only", "e6", "--out", str(tmp_path / str(len(more))), *more]
        subprocess.run(line, cwd=root, env=environment, check=True, capture_output=True,
                       timeout=patience)
    one, other = (tmp_path / name / "e6_counterexamples.csv" for name in "02")
    assert one.read_bytes() == other.read_bytes()
