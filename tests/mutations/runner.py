# SPDX-License-Identifier: BSD-3-Clause
"""Runs programs against mutants, and stores each result in a record that a later run continues."""

import concurrent.futures
import configparser
import json
import os
import re
import resource
import signal
import subprocess
import tempfile
import threading
import time

from build import BUILD, OUT, built
from table import FOLDER, ROOT, TableError, read_table

RECORD = FOLDER / "results.jsonl"
BASE = BUILD / "base.json"
CLASSES = "short steps long campaign".split()
MEMORY = 8 << 30  # bytes of a program


def read_programs():
    """Returns the programs of programs.ini by name."""
    parser = configparser.ConfigParser()
    parser.read(FOLDER / "programs.ini")
    programs = {}
    for name in parser.sections():
        section = parser[name]
        command = section.get("command", f"tests/{name} --gtest_fail_fast --gtest_brief=1").split()
        programs[name] = {"class": section["class"], "command": command, "after": section.get("after", "").split()}
    return programs


def read_record():
    """Returns the lines of the record. An interrupted last line is left out."""
    lines = []
    for line in RECORD.read_text().splitlines() if RECORD.is_file() else []:
        try:
            lines.append(json.loads(line))
        except ValueError:
            continue
    return lines


def results_of(mutants, lines):
    """Returns the latest valid result of each mutant and class: {name: {class: line}}."""
    digests = {m.name: m.digest() for m in mutants}
    found = {}
    for line in lines:
        if digests.get(line["mutant"]) == line["digest"]:
            found.setdefault(line["mutant"], {})[line["class"]] = line
    return found


class Runner:
    """Runs programs, at most `jobs` at once. stop() ends all that are running."""

    def __init__(self, jobs, minutes):
        self.jobs, self.minutes = jobs, minutes
        self.programs = read_programs()
        self.lock = threading.Lock()
        self.running = set()
        self.is_stopped = False

    def start(self, command, environment, cpu_seconds, wall_seconds):
        """Runs a command. Returns (exit status or None if it took too long, output, seconds of the processor)."""
        environment = {**os.environ, "KEEPOUT_CACHE": os.environ.get("KEEPOUT_CACHE", str(ROOT / ".cache")),
                       **environment}

        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (int(cpu_seconds), int(cpu_seconds) + 5))
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile() as output:
            environment["TMPDIR"] = folder
            process = subprocess.Popen([str(OUT / command[0]), *command[1:]], cwd=folder, env=environment,
                                       stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT,
                                       start_new_session=True, preexec_fn=limit)
            with self.lock:
                self.running.add(process.pid)
            is_late, began = False, time.monotonic()
            while True:
                pid, status, usage = os.wait4(process.pid, os.WNOHANG)
                if pid != 0:
                    break
                if self.is_stopped or time.monotonic() - began > wall_seconds:
                    is_late = True
                    self.end(process.pid)
                time.sleep(0.02)
            process.returncode = os.waitstatus_to_exitcode(status)
            with self.lock:
                self.running.discard(process.pid)
            self.end(process.pid)  # what it has left behind
            is_late = is_late or process.returncode in (-signal.SIGXCPU, -signal.SIGKILL)
            output.seek(0)
            return (None if is_late else process.returncode, output.read().decode(errors="replace"),
                    usage.ru_utime + usage.ru_stime)

    @staticmethod
    def end(group):
        try:
            os.killpg(group, signal.SIGKILL)
        except ProcessLookupError:
            pass

    def stop(self):
        self.is_stopped = True

    def measure(self, names):
        """Runs programs without a mutant. Stores the time of each, and the mutants whose place it evaluates."""
        base = read_base(needed=False)
        for name in names:
            program = self.programs[name]
            reached = BUILD / "reached.txt"
            reached.unlink(missing_ok=True)
            environment = {"KEEPOUT_MUTANT": "-1", "KEEPOUT_MUTANTS_REACHED": str(reached)}
            command = [word.format(seed=1) for word in program["command"]]
            status, output, _ = self.start(command, environment, 7200, 36000)
            if status != 0:
                raise TableError(f"{name} fails without a mutant:\n{output[-3000:]}")
            numbers = {int(line) for line in reached.read_text().split()} if reached.is_file() else set()
            status, _, seconds = self.start(command, {"KEEPOUT_MUTANT": "0"}, 7200, 36000)
            base[name] = {"seconds": seconds,
                          "reaches": sorted(m.name for m in built(read_table()) if m.number in numbers)}
            BASE.write_text(json.dumps(base))
            print(f"{name}: {seconds:.1f} s, evaluates {len(base[name]['reaches'])} mutants", flush=True)

    def kill(self, mutant, name, base, seed=1):
        """Runs a program against a mutant. Returns (how it was killed or None, test, seconds)."""
        limit = 10 * base[name]["seconds"] + 30
        command = [word.format(seed=seed) for word in self.programs[name]["command"]]
        status, output, seconds = self.start(command, {"KEEPOUT_MUTANT": str(mutant.number)}, limit, 60 * limit)
        failed = re.search(r"^\[  FAILED  \] ([^\s,]+)", output, re.MULTILINE)
        test = failed[1] if failed else ""
        if status == 0:
            return None, "", seconds
        if not test:
            lines = [line for line in output.splitlines() if line.strip()]
            test = lines[-1][:120] if lines and name.startswith("verify") else ""
        how = "too slow" if status is None else "failed" if status > 0 else f"signal {-status}"
        return how, test, seconds

    def try_class(self, mutant, kind, base, kills):
        """Runs the programs of a class until one kills the mutant. Returns the line of the record."""
        order = [n for n, p in self.programs.items() if p["class"] == kind and n in base]
        evaluating = [n for n in order if mutant.name in base[n]["reaches"]]
        line = {"mutant": mutant.name, "digest": mutant.digest(), "class": kind, "killed_by": None,
                "evaluated": len(evaluating), "seconds": 0.0}
        if kind == "campaign":
            return self.try_campaign(mutant, evaluating, base, line)
        likely = {n: (0.05 + kills.get((mutant.file, n), 0) + 0.2 * kills.get((mutant.folder(), n), 0)) /
                  (0.5 + base[n]["seconds"]) for n in evaluating}
        for name in sorted(evaluating, key=lambda n: -likely[n]):
            how, test, seconds = self.kill(mutant, name, base)
            if self.is_stopped:
                return None
            line["seconds"] = round(line["seconds"] + seconds, 1)
            if how:
                return {**line, "killed_by": name, "how": how, "test": test}
        return line

    def try_campaign(self, mutant, names, base, line):
        names = [n for n in names if not self.programs[n]["after"] or
                 mutant.file.split("/")[0] in self.programs[n]["after"]]
        seed = 0
        while names and max(line["seconds"], seed) < 60 * self.minutes:
            seed += 1
            for name in names:
                how, test, seconds = self.kill(mutant, name, base, seed)
                if self.is_stopped:
                    return None
                line["seconds"] = round(line["seconds"] + seconds, 1)
                if how:
                    return {**line, "killed_by": name, "how": how, "test": test}
        return line


def read_base(needed=True):
    if BASE.is_file():
        return json.loads(BASE.read_text())
    if needed:
        raise TableError("no base: call `tests/mutations/run base` first")
    return {}


def next_class(mutant, results, classes):
    """Returns the next class to run against a mutant, or None if it is killed or finished."""
    done = results.get(mutant.name, {})
    if any(line["killed_by"] for line in done.values()):
        return None
    for kind in classes:
        if kind in done:
            continue
        if kind in ("long", "campaign") and mutant.effect != "promise":
            return None
        return kind
    return None


def run(mutants, classes, jobs, minutes):
    """Runs the classes against the mutants. Appends to the record, and prints the progress."""
    base = read_base()
    mutants = built(mutants)
    runner = Runner(jobs, minutes)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    known = read_table()
    lines = read_record()
    results = results_of(known, lines)
    files = {m.name: m for m in known}
    kills = {}

    def learn(line):
        mutant = files.get(line["mutant"])
        if mutant and line["killed_by"]:
            for key in (mutant.file, mutant.folder()):
                kills[key, line["killed_by"]] = kills.get((key, line["killed_by"]), 0) + 1

    for line in lines:
        learn(line)
    began, finished, spent = time.monotonic(), 0, 0
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool, open(RECORD, "a", encoding="utf-8") as record:
        for kind in classes:
            todo = [m for m in mutants if next_class(m, results, classes) == kind]
            pending = {pool.submit(runner.try_class, m, kind, base, kills): m for m in todo}
            try:
                for future in concurrent.futures.as_completed(pending):
                    line = future.result()
                    if line is None:
                        continue
                    record.write(json.dumps(line) + "\n")
                    record.flush()
                    os.fsync(record.fileno())
                    learn(line)
                    results.setdefault(line["mutant"], {})[kind] = line
                    finished += 1
                    spent = time.monotonic() - began
                    left = spent / finished * (len(todo) - finished)
                    print(f"{kind} {finished}/{len(todo)}, {left / 60:.0f} min left: {line['mutant']}: "
                          f"{line['killed_by'] or 'survives'} {line.get('test', '')}", flush=True)
            except KeyboardInterrupt:
                runner.stop()
                for future in pending:
                    future.cancel()
                print("interrupted: the same command goes on", flush=True)
                return False
            began, finished = time.monotonic(), 0
    return True
