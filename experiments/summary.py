# SPDX-License-Identifier: BSD-3-Clause
"""What was found as one Markdown page: to be read without a browser, and kept with the sources."""
from __future__ import annotations

from .experiment import Findings


def text(findings: dict[str, tuple[str, Findings]], command: str, version: str) -> str:
    """Claims first, all experiments together; then each with its tables and figures."""
    lines = ["# The paper's experiments, redone", "", f"By `{command}`, keepout {version}.", ""]
    claims = [claim for _, found in findings.values() for claim in found.claims]
    if claims:
        lines += _table(
            ["", "paper", "its rule here", "certified", "best here", "how sure", "why it differs"],
            [
                [c.about, c.paper, c.reproduction, c.certified, c.best, c.sure, c.note]
                for c in claims
            ],
        )
    for title, found in findings.values():
        lines += [f"## {title}", "", found.headline, ""]
        for table in found.tables:
            lines += [f"**{table.title}.** {table.note}".rstrip(), ""]
            lines += _table(table.columns, table.rows)
        for figure in found.figures:
            lines += [f"![{figure.title}](figures/{figure.name}.svg)", "", figure.caption, ""]
    return "\n".join(lines).rstrip() + "\n"


def _table(columns: list[str], rows: list[list[str]]) -> list[str]:
    def line(cells: list[str]) -> str:
        return "| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |"

    return [line(columns), "|" + "---|" * len(columns), *map(line, rows), ""]
