#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the commands and files of a page of docs/ exactly as written, so that the page stays correct.

    follow_page.py PAGE FOLDER [--keepout COMMAND] [--prefix INSTALLED] [--python PATH] [--sources ROOT]

A comment above each block of code, invisible to readers, states what to do with the block:

    <!-- file: NAME -->      Write it to this file. The text before the block must name the file.
    <!-- run -->             Run it in a new shell, as a reader would; compile it if it is C++. It must succeed.
    <!-- run fails -->       Run it. It must fail.
    <!-- run python -->      Run it if there is a Python module (--python). It must succeed.
    <!-- output -->          The last run must have printed exactly this.
    <!-- by hand: WHY -->    Skip it. WHY states why a test cannot do it.

A block without such a comment is an error. FOLDER is emptied first. `keepout` runs COMMAND. find_package
searches INSTALLED, and Python searches PATH. With ROOT, `~/keepout` leads to ROOT.
"""

import argparse
import difflib
import os
import pathlib
import re
import shutil
import subprocess
import sys

BLOCK = re.compile(r"^(?P<fence>`{3,})(?P<language>\w*)\n(?P<text>.*?)^(?P=fence) *$", re.M | re.S)
ORDER = re.compile(r"<!-- (?P<what>file|run fails|run python|run|output|by hand)(: (?P<name>.*))? -->\n$")


class Reader:
    def __init__(self, page, folder, keepout, prefix, python, sources=None):
        self.page, self.folder, self.python = page, folder, python
        self.environment = dict(os.environ, LC_ALL="C.UTF-8")
        folder.mkdir(parents=True, exist_ok=True)
        commands = folder / "commands"
        commands.mkdir()
        if keepout:
            (commands / "keepout").symlink_to(keepout)
        self.environment["PATH"] = f"{commands}:{self.environment['PATH']}"
        if prefix:
            self.environment["CMAKE_PREFIX_PATH"] = str(prefix)
        if python:
            # Debian's Python, for which the module was built.
            (commands / "python3").symlink_to("/usr/bin/python3")
            self.environment["PYTHONPATH"] = str(python)
        if sources:
            home = folder / "home"
            home.mkdir()
            (home / "keepout").symlink_to(sources.resolve())
            self.environment["HOME"] = str(home)
        self.printed = None  # by the last run
        self.was_left_out = False

    def fail(self, line, why):
        sys.exit(f"{self.page}:{line}: {why}")

    def follow(self):
        text = self.page.read_text(encoding="utf-8")
        count = 0
        for block in BLOCK.finditer(text):
            line = text.count("\n", 0, block.start()) + 1
            order = ORDER.search(text, 0, block.start())
            if order is None:
                self.fail(line, "no comment states what to do with this block: see tests/docs/follow_page.py")
            self.obey(order["what"], (order["name"] or "").strip(), block["language"], block["text"], line,
                      text[max(0, block.start() - 400):order.start()])
            count += 1
        if count == 0:
            self.fail(1, "there is no block of code: has the page changed its form?")
        print(f"{self.page.name}: {count} blocks")

    def obey(self, what, name, language, text, line, before):
        if what == "file":
            if f"`{name}`" not in before:
                self.fail(line, f"the text before this block does not name `{name}`")
            path = self.folder / name
            if self.folder not in path.resolve().parents:
                self.fail(line, f"{name} is not in the folder")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        elif what == "output":
            if self.printed is None and not self.was_left_out:
                self.fail(line, "nothing was run before")
            if self.printed is not None and self.printed != text:
                difference = difflib.unified_diff(text.splitlines(), self.printed.splitlines(),
                                                  "the page", "the run", lineterm="")
                self.fail(line, "the output differs:\n" + "\n".join(difference))
        elif what == "by hand":
            if not name:
                self.fail(line, "state why it is not tested")
        elif what == "run python" and not self.python:
            self.printed, self.was_left_out = None, True
        else:
            self.run(self.command(language, text), what == "run fails", line)

    def command(self, language, text):
        if language == "python":
            return ["python3", "-c", text]
        if language == "cpp":
            (self.folder / "listing.cpp").write_text(text, encoding="utf-8")
            folders = [f"{self.environment['CMAKE_PREFIX_PATH']}/include", "/usr/include/eigen3"]
            return ["g++", "-std=c++20", "-fsyntax-only", *(f"-I{folder}" for folder in folders), "listing.cpp"]
        return ["bash", "-euc", text]

    def run(self, command, fails, line):
        done = subprocess.run(command, cwd=self.folder, env=self.environment,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=600)
        self.printed, self.was_left_out = done.stdout, False
        if (done.returncode != 0) != fails:
            self.fail(line, f"ended with {done.returncode}:\n{done.stdout}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--keepout", type=pathlib.Path)
    parser.add_argument("--prefix", type=pathlib.Path)
    parser.add_argument("--python", type=pathlib.Path)
    parser.add_argument("--sources", type=pathlib.Path)
    given = parser.parse_args()
    folder = given.folder.resolve()
    shutil.rmtree(folder, ignore_errors=True)
    Reader(given.page, folder, given.keepout, given.prefix, given.python, given.sources).follow()


if __name__ == "__main__":
    main()
