#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs every command that README.md shows: readme_commands_test.py ROOT FOLDER KEEPOUT

Runs them in an empty FOLDER, one after another, as a reader would after ./run. Missing files are prepared.
Only the sizes are smaller, so that the test takes a minute. The commands are the lines of indented blocks
that begin with ./run or echo, and code in the text that begins with "./run ".
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

BLOCK = re.compile(r"^    ((?:\./run|echo)\b.*)$", re.M)
INLINE = re.compile(r"(?<!`)`(\./run [^`]+)`(?!`)")

# The options of each command for a short run that still shows that the command works.
SMALL = {
    "simulate": {"--strokes": "1", "--cycles": "100"},
    "verify": {"--steps": "2000"},
    "verify --scenario": {"--cycles": "100"},
    "bench": {"--triangles": "20000", "--queries": "5", "--seconds": "0.01"},
    "bench --speed": {"--quick": None, "--steps": "1000"},
    "compare": {"--poses": "6", "--problems": "30", "--pairs": "10"},
    "live": {"--no-open": None},
    "plan": {"--problems": "1", "--seconds": "2"},
    "experiments": {"--only": "e6", "--out": "experiments"},
}


def commands_of(text):
    """Returns the commands in the order of the page, each once."""
    found = [(match.start(), match[1]) for rule in (BLOCK, INLINE) for match in rule.finditer(text)]
    words = [re.sub(r"\s+", " ", re.sub(r"\s#\s.*", "", command)).strip() for _, command in sorted(found)]
    return [command for command in dict.fromkeys(words) if command not in ("./run", "./run ARGS...")]


def made_small(command):
    name = next((n for n in sorted(SMALL, key=len, reverse=True)
                 if re.search(rf"\./run {n}\b", command)), None)
    for option, value in SMALL.get(name, {}).items():
        wanted = option if value is None else f"{option} {value}"
        command, replaced = re.subn(rf"{option}(?: [^-\s]\S*)?(?=\s|$)", wanted, command)
        if not replaced:
            command += " " + wanted
    return command


def web_page(root, folder):
    """Returns the folder of the front end that ./run uses for pages. If it is not built, makes empty pages."""
    made = root / "build/web"
    places = {"live": "keepout live: the anatomy", "report": "keepout report: the record",
              "report_with_anatomy": "keepout report: the record"}
    if all((made / f"{page}.html").exists() for page in places):
        return made
    bare = folder / "web"
    bare.mkdir()
    for page, place in places.items():
        (bare / f"{page}.html").write_text(f"<!-- {place} goes here -->\n")
    return bare


def main():
    root, folder, keepout = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    # Does the same as the end of ./run after the build.
    run = folder / "run"
    run.write_text(
        '#!/bin/bash\n'
        f'[ "$1" != experiments ] || exec /usr/bin/python3 -m experiments "${{@:2}}"\n'
        f'exec -a ./run "{keepout}" "$@"\n')
    run.chmod(0o755)
    environment = dict(os.environ, KEEPOUT_PREPARE=str(root / "fixtures/prepare"),
                       KEEPOUT_WEB=str(web_page(root, folder)), KEEPOUT_COMMAND=str(keepout),
                       PYTHONPATH=f"{keepout.parents[2] / 'python'}:{root}")
    commands = commands_of((root / "README.md").read_text(encoding="utf-8"))
    missing = [n for n in ("inspect", "convert", "replay", "simulate", "serve", "verify", "bench", "compare", "live", "plan",
                           "register", "report", "experiments")
               if not any(c.startswith(f"./run {n}") for c in commands)]
    if missing:
        sys.exit(f"README.md does not show {', '.join(missing)}: has the page changed its form?")
    faults = 0
    for command in commands:
        small = made_small(command)
        done = subprocess.run(["bash", "-euc", small], cwd=folder, env=environment,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=600)
        print(f"{'ok' if done.returncode == 0 else 'FAILED'}: {small}", flush=True)
        if done.returncode != 0:
            faults += 1
            print(f"README.md says: {command}\nended with {done.returncode}:\n{done.stdout[-3000:]}")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
