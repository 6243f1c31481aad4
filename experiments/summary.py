# SPDX-License-Identifier: BSD-3-Clause
"""Writes the findings as one Markdown page, which needs no browser and is kept with the sources."""
from __future__ import annotations

from .experiment import Findings

_NOTE = (
    "The table calls Li et al. (2020) *the paper*. n is a number of trials. A pooled p is the result of the paper's "
    "test, which treats dependent samples as independent. The p of our evidence is of signed ranks of pairs of trials, "
    "after Holm over the eight primary tests."
)


def text(findings: dict[str, tuple[str, Findings]], command: str, version: str) -> str:
    """Returns the claims of all experiments; then each experiment with its tables and figures."""
    lines = ["# The experiments of Li et al. (2020), repeated", "", f"By `{command}`, keepout {version}.", ""]
    claims = [claim for _, found in findings.values() for claim in found.claims]
    if claims:
        lines += _table(
            ["", "evidence", "paper", "its rule here", "certified", "best here", "why it differs"],
            [
                [c.about, c.sure, c.paper, c.reproduction, c.certified, c.best, c.note]
                for c in claims
            ],
        )
        lines += [_NOTE, ""]
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
