# SPDX-License-Identifier: BSD-3-Clause
"""Writes the record of the experiments, from which `keepout report` makes the page: docs/records.md."""
from __future__ import annotations

import json
import os
import subprocess
import tempfile
from dataclasses import asdict
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import keepout

from .experiment import Findings, Scale

FORMAT = 2  # must match apps/keepout/record/record.cpp
STATED = "e1_validation"  # the experiment whose headline is that of the record; without it, the first one


def write_record(
    path: Path,
    scale: Scale,
    findings: dict[str, tuple[str, Findings]],
    complete: bool,
    command: str,
) -> None:
    """Writes the findings as JSON, by name and with the title.

    `complete`: no experiment was omitted or stopped. `command`: the command line that repeats it.
    """
    extent = "full" if scale.full else "quick"
    record = {
        "keepout_record": "experiments",
        "format": FORMAT,
        "version": keepout.__version__,
        "date": datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "command": command,
        "complete": complete,
        "subject": f"The experiments of Li et al., IROS 2020: {extent}",
        "headline": findings.get(STATED, next(iter(findings.values())))[1].headline,
        "account": [],
        "machine": _machine(),
        "settings": {"scale": extent, "seed": str(scale.seed)},
        "experiments": [
            {"name": name, "title": title, **asdict(found)}
            for name, (title, found) in findings.items()
        ],
    }
    path.write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def _machine() -> dict[str, Any] | None:
    """Returns this machine in the form of other records, from a minimal run of `compare`.

    The command is $KEEPOUT_COMMAND, which ./run experiments sets; without it the result is null.
    """
    program = os.environ.get("KEEPOUT_COMMAND")
    if not program:
        return None
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "record.json")
        least = ["cube", "--poses", "6", "--problems", "10", "--pairs", "10"]
        arguments = ["compare", *least, "--json", str(file)]
        subprocess.run([program, *arguments], check=True, capture_output=True)
        machine: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))["machine"]
    return machine
