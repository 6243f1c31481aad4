#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The dialogue on docs/serve.md is what the command answers. Usage: serve_page_test.py PAGE KEEPOUT"""
import fnmatch
import subprocess
import sys


def dialogue_of(page):
    """The arguments of the command, and the lines after it: requests, each with its answer."""
    lines = iter(open(page, encoding="utf-8").read().splitlines())
    prompt = "    $ keepout "
    arguments = next(line for line in lines if line.startswith(prompt))[len(prompt):].split()
    talk = []
    for line in lines:
        if not line.startswith("    "):
            break
        talk.append(line.strip())
    return arguments, talk[0::2], talk[1::2]


def main(page, keepout):
    arguments, requests, expected = dialogue_of(page)
    assert len(requests) == len(expected) > 0
    run = subprocess.run([keepout, *arguments], input="\n".join(requests) + "\n", text=True,
                         stdout=subprocess.PIPE, check=True)
    answers = run.stdout.splitlines()
    assert len(answers) == len(expected), answers
    for answer, printed in zip(answers, expected):
        # "..." on the page stands for what it leaves out; brackets are meant as they are.
        pattern = printed.replace("[", "[[]").replace("...", "*")
        assert fnmatch.fnmatchcase(answer, pattern), f"{answer}\nis not what the page has:\n{printed}"


main(*sys.argv[1:])
