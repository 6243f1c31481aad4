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

FORMAT = 1  # must match apps/keepout/record/record.cpp


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
    compared = sum(claim.paper != "-" for _, found in findings.values() for claim in found.claims)
    numbers = "1 number" if compared == 1 else f"{compared} numbers"
    record = {
        "keepout_record": "experiments",
        "format": FORMAT,
        "version": keepout.__version__,
        "date": datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "command": command,
        "complete": complete,
        "subject": f"The experiments of Li et al., IROS 2020: {extent}",
        "headline": f"{numbers} of the paper, beside the results of its rule, of the certified rule "
        "and of the best mode here",
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
