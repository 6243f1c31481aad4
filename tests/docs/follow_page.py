#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Follows a page of docs/ word for word, so that it cannot rot.

    follow_page.py PAGE FOLDER [--keepout COMMAND] [--prefix INSTALLED] [--python PATH]

Above each block of code a comment that readers do not see says what is to be done with it:

    <!-- file: NAME -->      write it to this file, which the text before it must name, too
    <!-- run -->             run it, as a reader would, in one shell after the other; it must succeed
    <!-- run fails -->       the same; it must fail
    <!-- run python -->      the same, if there is a Python module (--python)
    <!-- output -->          what the last run must have printed, to the letter
    <!-- part of: PATH -->   lines of this file of the sources, which another test builds and runs
    <!-- by hand: WHY -->    nothing: WHY says what keeps a test from doing it

A block without such a comment is an error. FOLDER is emptied first. COMMAND is what `keepout` runs;
find_package looks into INSTALLED; Python looks into PATH.
"""

import argparse
import difflib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import textwrap

BLOCK = re.compile(r"^(?P<fence>`{3,})(?P<language>\w*)\n(?P<text>.*?)^(?P=fence) *$", re.M | re.S)
ORDER = re.compile(r"<!-- (?P<what>file|part of|run fails|run python|run|output|by hand)(: (?P<name>.*))? -->\n$")


class Reader:
    def __init__(self, page, folder, keepout, prefix, python):
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
            # Debian's, which the module was built for.
            (commands / "python3").symlink_to("/usr/bin/python3")
            self.environment["PYTHONPATH"] = str(python)
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
                self.fail(line, "what is to be done with this block? See tests/docs/follow_page.py")
            self.obey(order["what"], (order["name"] or "").strip(), block["text"], line,
                      text[max(0, block.start() - 400):order.start()])
            count += 1
        if count == 0:
            self.fail(1, "there is no block of code: has the page changed its form?")
        print(f"{self.page.name}: {count} blocks")

    def obey(self, what, name, text, line, before):
        if what == "file":
            if f"`{name}`" not in before:
                self.fail(line, f"nothing tells the reader that this is `{name}`")
            path = self.folder / name
            if self.folder not in path.resolve().parents:
                self.fail(line, f"{name} is not in the folder")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        elif what == "part of":
            source = (self.page.resolve().parents[1] / name).read_text(encoding="utf-8")
            if not any(textwrap.indent(text, " " * indent) in source for indent in (0, 2, 4, 6, 8)):
                self.fail(line, f"{name} does not have these lines")
        elif what == "output":
            if self.printed is None and not self.was_left_out:
                self.fail(line, "nothing was run before")
            if self.printed is not None and self.printed != text:
                difference = difflib.unified_diff(text.splitlines(), self.printed.splitlines(),
                                                  "the page", "the run", lineterm="")
                self.fail(line, "prints something else:\n" + "\n".join(difference))
        elif what == "by hand":
            if not name:
                self.fail(line, "say why it is not tested")
        elif what == "run python" and not self.python:
            self.printed, self.was_left_out = None, True
        else:
            self.run(text, what == "run fails", line)

    def run(self, text, fails, line):
        done = subprocess.run(["bash", "-euc", text], cwd=self.folder, env=self.environment,
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
    given = parser.parse_args()
    folder = given.folder.resolve()
    shutil.rmtree(folder, ignore_errors=True)
    Reader(given.page, folder, given.keepout, given.prefix, given.python).follow()


if __name__ == "__main__":
    main()
