# SPDX-License-Identifier: BSD-3-Clause
"""The committed records: docs/records/NAME.json.gz, the source of every measured figure of the pages.

A record contains what a command wrote with --json, without its traces, or the output of a program (kind "output"). It
also has its commit, its sources (the directories whose change makes it stale), and the fingerprint of the steps at
that time (docs/records/steps.txt).
"""

import collections
import datetime
import gzip
import json
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
RECORDS = ROOT / "docs" / "records"

# A record is stale if its sources changed by more than this after its commit.
MOST_DAYS = 30
MOST_LINES = 5000

# Records without printed times. They are valid as long as all steps are bitwise the same.
RESULTS = {"certified_excess", "moving_meshes", "simulate_physics", "simulate_psm",
           "simulate_psm_20", "verify_guides",
           "verify_linearized", "verify_psm", "verify_scenarios", "verify_tip"}

TIP = ["engine", "solvers", "factory"]
INSTRUMENT = TIP + ["robot"]
# `apps/keepout/NAME` is the former directory of `benchmarks/NAME`.
SOURCES = {
    "simulate": TIP + ["apps/keepout/operators", "apps/keepout/simulate"],
    "simulate_robot": INSTRUMENT + ["apps/keepout/operators", "apps/keepout/simulate", "oracle", "monitor"],
    "bench": TIP + ["adapters", "benchmarks/bench", "apps/keepout/bench"],
    "speed": TIP + ["adapters", "benchmarks/bench", "apps/keepout/bench"],
    "compare": TIP + ["adapters", "benchmarks/compare", "apps/keepout/compare"],
    "plan": TIP + ["adapters/ompl", "benchmarks/plan", "apps/keepout/plan"],
    "plan_robot": INSTRUMENT + ["adapters/ompl", "benchmarks/plan", "apps/keepout/plan"],
    "verify": TIP + ["apps/keepout/operators", "apps/keepout/verify", "oracle", "monitor"],
    "verify_robot": INSTRUMENT + ["apps/keepout/operators", "apps/keepout/verify", "oracle", "monitor"],
    "output": INSTRUMENT + ["adapters"],
}

# Traces of single cycles, paths, pictures: the parts that make a record large.
TRACES = {"strokes", "hand", "drawn", "crossings", "path", "too_near", "bins", "hashes_of_first", "svg",
          "anomalies", "base_position", "base_rotation"}


def git(*arguments):
    return subprocess.run(["git", "-C", ROOT, *arguments], check=True, capture_output=True, text=True).stdout


def without_traces(value):
    """Returns a record without its traces, and with numbers of at most nine digits."""
    if isinstance(value, dict):
        return {key: without_traces(item) for key, item in value.items()
                if key not in TRACES or isinstance(item, (int, float))}
    if isinstance(value, list):
        return [without_traces(item) for item in value]
    return float(f"{value:.9g}") if isinstance(value, float) else value


def merged(found):
    """Returns one record of several of the same kind that have rows and a total."""
    first = found[0]
    for other in found[1:]:
        first["rows"] += other["rows"]
        for key, value in other.get("total", {}).items():
            if isinstance(value, (int, float)):
                first["total"][key] = (min if key.startswith("least") else max if key.startswith("deepest")
                                       else int.__add__)(first["total"][key], value)
    first["command"] = "; ".join(one["command"] for one in found)
    return first


def keep(name, paths, commit, output_of=None):
    """Stores the record of a file, or of several with rows, as docs/records/NAME.json.gz.

    With `output_of`, the files contain the output of this command; a line "machine: ..." names the machine. Raises
    ValueError if a run was interrupted.
    """
    if output_of:
        text = "".join(pathlib.Path(path).read_text(encoding="utf-8") for path in paths)
        record = {"keepout_record": "output", "command": output_of, "text": text,
                  "date": datetime.date.today().isoformat()}
        if machine := re.search(r"^machine: (.*)", text, re.M):
            record["machine"] = machine[1]
    else:
        found = [json.loads(pathlib.Path(path).read_text(encoding="utf-8")) for path in paths]
        for path, one in zip(paths, found):
            one["command"] = re.sub(r" --(json|out) \S+", "", one["command"])  # the user's file
            if not one.get("complete", True):
                raise ValueError(f"{path}: the run was interrupted: run it to its end")
        record = without_traces(merged(found))
        if record["keepout_record"] in ("plan", "plan_robot"):
            del record["runs"]  # the summaries contain their figures
    kept = {"steps": steps(), "commit": git("rev-parse", "--short=10", commit).strip(),
            "sources": SOURCES[record["keepout_record"]], "record": record}
    RECORDS.mkdir(exist_ok=True)
    packed = gzip.compress(json.dumps(kept, indent=1, ensure_ascii=False).encode(), mtime=0)
    (RECORDS / f"{name}.json.gz").write_bytes(packed)


def read_all():
    """Returns the kept records by name, with the names that version 0.3 has for what they name."""
    records = {}
    for path in sorted(RECORDS.glob("*.json.gz")):
        text = gzip.decompress(path.read_bytes()).decode()
        for former, name in (("fallback", "truncated"), ("yielding", "degraded"), ("linearised", "linearized"),
                             ("held back by the surface", "limited by the surface"),
                             ("that are held back", "that the surface limits"),
                             ("looks of a step | us | looks of a polytope | us", "work of a step | µs | work of a polytope | µs")):
            text = re.sub(rf"\b{re.escape(former)}\b", name, text)
        text = re.sub(r'(\d |"unit": ")us\b', r"\1µs", text)
        records[path.name.removesuffix(".json.gz")] = json.loads(text)
    return records


def steps():
    """Returns the fingerprint of the tree's steps, which tests/accuracy/same_steps_test.cpp checks."""
    return (RECORDS / "steps.txt").read_text(encoding="utf-8")


def is_in_history(commit):
    """Returns true if this is a git checkout with full history that contains the commit."""
    try:
        git("merge-base", "--is-ancestor", commit, "HEAD")
        return git("rev-parse", "--is-shallow-repository").strip() == "false"
    except (subprocess.CalledProcessError, OSError):
        return False


def changed_code(diff):
    """Returns the number of lines of C++ code that a diff adds and removes.

    Comments, includes and lines that only moved, or whose comment alone changed, do not count.
    """
    changed, is_code = {"+": collections.Counter(), "-": collections.Counter()}, False
    for line in diff.splitlines():
        if line.startswith(("--- ", "+++ ")):
            is_code = line.endswith((".cpp", ".h")) or (line[0] == "+" and is_code)
        elif is_code and line.startswith(("+", "-")):
            code = line[1:].split("//")[0].strip()
            if code and not code.startswith("#include"):
                changed[line[0]][code] += 1
    return sum(((changed["+"] - changed["-"]) + (changed["-"] - changed["+"])).values())


def staleness(name, kept):
    """Returns why a record is stale, or an empty text. Precondition: is_in_history(its commit)."""
    if name in RESULTS and kept.get("steps") == steps():
        return ""
    commit, sources = kept["commit"], kept["sources"]
    measured = int(git("show", "-s", "--format=%ct", commit))
    changed = git("log", "-1", "--format=%ct", "--", *sources).strip()
    days = (int(changed or measured) - measured) / 86400.0
    if days > MOST_DAYS:
        return f"its sources changed {days:.0f} days later, more than {MOST_DAYS}: measure it again"
    lines = changed_code(git("diff", "-w", "--unified=0", commit, "HEAD", "--", *sources))
    if lines > MOST_LINES:
        return f"{lines} lines of its code changed since, more than {MOST_LINES}: measure it again"
    return ""
