# SPDX-License-Identifier: BSD-3-Clause
"""Runs the parts of ./test --long one after the other, and shows their results on one page."""

import argparse
import datetime
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import threading
import time

sys.dont_write_bytecode = True  # the source tree stays clean

import page

ROOT = pathlib.Path(__file__).resolve().parents[2]
PARTS = ROOT / "tests" / "nightly" / "parts.sh"
RUNS = ROOT / "out" / "nightly"
OURS = {"--without", "--minutes", "--resume", "-h", "--help"}
SKIPPED = 77  # the exit status of a part that lacks what it needs
STOP = threading.Event()  # set by Ctrl-C and SIGTERM


def titles():
    """Returns the title of each part by its name, in the order of parts.sh."""
    return dict(re.findall(r"^# part (\w+): (.+)\npart_\1\(\)", PARTS.read_text(encoding="utf-8"), re.M))


def parse_arguments(words, parts):
    """Returns the arguments, the names of the parts to run, and the options for ctest."""
    parser = argparse.ArgumentParser(
        prog="./test --long", formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Runs the tests of a night, part by part. Writes one page of results: out/nightly/DATE/index.html",
        epilog="parts:\n" + "\n".join(f"  {name:22}{title}" for name, title in parts.items()) + """

Ctrl-C ends the part that runs. The page then has the results so far.
Options of ctest, such as -R PATTERN, stand last. With them, the default is the parts release and asan.
The exit status is 0 if all parts passed or were skipped.""")
    parser.add_argument("parts", nargs="*", metavar="PART", help="the parts to run; default: all")
    parser.add_argument("--without", action="append", default=[], metavar="PART", help="do not run this part")
    parser.add_argument("--minutes", type=int, default=30, metavar="N",
                        help="duration of each campaign, of fuzzing and of mutations; default: 30")
    parser.add_argument("--resume", action="store_true",
                        help="continue the last run; parts that passed on this commit are not repeated")
    end = next((k for k, word in enumerate(words) if word.startswith("-") and word.partition("=")[0] not in OURS),
               len(words))
    arguments = parser.parse_args(words[:end])
    if unknown := sorted({*arguments.parts, *arguments.without} - {*parts}):
        parser.error(f"unknown part {', '.join(unknown)}; the parts are {', '.join(parts)}")
    if arguments.minutes < 1:
        parser.error("--minutes must be at least 1")
    wanted = arguments.parts or (["release", "asan"] if words[end:] else parts)
    return arguments, [part for part in parts if part in wanted and part not in arguments.without], words[end:]


def in_bash(words, environment=None, **options):
    """Starts a function of parts.sh."""
    script = '. "$root/cmake/set_up.sh"; . "$root/tests/nightly/parts.sh"; "$@"'
    return subprocess.Popen(["bash", "-euo", "pipefail", "-c", script, "bash", *words], cwd=ROOT,
                            env={**os.environ, "root": str(ROOT), "length": "long", **(environment or {})}, **options)


def source():
    """Returns the commit of the tree, and says if files differ from it."""
    def git(*words):
        return subprocess.run(["git", "-C", ROOT, *words], capture_output=True, text=True, check=False).stdout.strip()
    return git("rev-parse", "HEAD") + (" with changes" if git("status", "--porcelain", "-uno") else "")


def open_run(resume):
    """Returns the directory of this run, and its results so far by part."""
    last = max(RUNS.glob("*/results.json"), default=None) if resume else None
    if last:
        run = json.loads(last.read_text(encoding="utf-8"))
        if run["source"] == source():
            return last.parent, run
    folder = RUNS / datetime.datetime.now().strftime("%Y-%m-%d_%H%M%S")
    folder.mkdir(parents=True)
    return folder, {"source": source(), "date": datetime.datetime.now().astimezone().isoformat(timespec="minutes"),
                    "machine": page.machine(), "results": {}}


def run_part(part, folder, minutes, of_ctest):
    """Runs a part until its end, or until Ctrl-C. Returns its result."""
    log, files = folder / f"{part}.log", folder / part
    files.mkdir(exist_ok=True)
    began, status = time.monotonic(), "stopped"
    with open(log, "wb") as out:
        process = in_bash([f"part_{part}", *of_ctest], {"minutes": str(minutes), "results": str(files)}, stdout=out,
                          stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, start_new_session=True)
        while process.poll() is None and not STOP.wait(0.5):
            show_progress(log, time.monotonic() - began)
        if process.poll() is None:
            end(process)
        else:
            status = {0: "passed", SKIPPED: "skipped"}.get(process.returncode, "failed")
    if not any(files.iterdir()):
        files.rmdir()
    return {"status": status, "seconds": round(time.monotonic() - began), **page.extract(log, status)}


def end(process):
    """Ends a part with all its children: as Ctrl-C does, then by force."""
    for how in (signal.SIGINT, signal.SIGKILL):
        try:
            os.killpg(process.pid, how)
            process.wait(timeout=20)
        except (ProcessLookupError, subprocess.TimeoutExpired):
            pass


def show_progress(log, seconds):
    """Shows the duration and the last line of the log, if stderr is a terminal."""
    if sys.stderr.isatty():
        with open(log, "rb") as lines:
            lines.seek(max(0, os.path.getsize(log) - 400))
            last = lines.read().decode(errors="replace").strip().rpartition("\n")[2]
        line = f"{page.duration(seconds)}  {last}"[:os.get_terminal_size(sys.stderr.fileno()).columns - 1]
        print(f"\r\033[K{line}\r", end="", file=sys.stderr, flush=True)


def main():
    parts = titles()
    arguments, chosen, of_ctest = parse_arguments(sys.argv[1:], parts)
    if in_bash(["require_options_of_ctest", *of_ctest]).wait() != 0:
        return 1
    folder, run = open_run(arguments.resume)
    results = run["results"]
    for name in (signal.SIGINT, signal.SIGTERM):
        signal.signal(name, lambda *_: STOP.set())
    for part in chosen:
        if arguments.resume and results.get(part, {}).get("status") == "passed":
            continue
        if STOP.is_set():
            break
        print(f"==> {part}: {parts[part]} (log: {folder / part}.log)", file=sys.stderr, flush=True)
        results[part] = run_part(part, folder, arguments.minutes, of_ctest)
        result = results[part]
        show = " ".join([result["status"], "in", page.duration(result["seconds"]), *result["notes"][:3]])
        print(f"    {show}", file=sys.stderr, flush=True)
        (folder / "results.json").write_text(json.dumps(run, indent=1), encoding="utf-8")
        (folder / "index.html").write_text(page.html(run, parts), encoding="utf-8")
    bad = [part for part, result in results.items() if result["status"] in ("failed", "stopped")]
    print(f"==> {page.headline(run, parts)} {folder}/index.html", file=sys.stderr)
    return 1 if bad or STOP.is_set() or not results else 0


if __name__ == "__main__":
    sys.exit(main())
