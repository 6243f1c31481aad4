# SPDX-License-Identifier: BSD-3-Clause
"""The tables of the record, in Markdown."""

from runner import CLASSES, read_record, results_of
from table import read_table


def outcome(done):
    """Returns the class that killed a mutant, 'survived' if the short tests did not, or 'not run'."""
    for kind in CLASSES:
        if kind in done and done[kind]["killed_by"]:
            return kind
    return "survived" if "short" in done else "not run"


def report():
    """Returns the report."""
    mutants = read_table()
    results = results_of(mutants, read_record())
    outcomes = {m.name: outcome(results.get(m.name, {})) for m in mutants}
    columns = [*CLASSES, "survived", "not run"]
    lines = ["| folder | mutants | " + " | ".join(columns) + " |", "|---|--:|" + "--:|" * len(columns)]

    def row(title, group):
        counts = [sum(outcomes[m.name] == c for m in group) for c in columns]
        lines.append(f"| {title} | {len(group)} | " + " | ".join(str(c) for c in counts) + " |")

    for folder in sorted({m.folder() for m in mutants}):
        row(folder, [m for m in mutants if m.folder() == folder])
    for effect in ("promise", "time", "equivalent"):
        row(f"all that are `{effect}`", [m for m in mutants if m.effect == effect])
    row("all", mutants)
    run = [m for m in mutants if m.effect == "promise" and outcomes[m.name] != "not run"]
    if run:
        killed = sum(outcomes[m.name] in ("short", "steps") for m in run)
        lines += ["", f"Of {len(run)} mutants that can break a promise and were run, `./test` kills {killed}: "
                  f"{100 * killed / len(run):.1f} %."]
    for title, of in (("Survivors that may break a promise", "promise"), ("Other survivors", None)):
        chosen = [m for m in mutants if outcomes[m.name] == "survived" and (m.effect == "promise") == (of is not None)]
        lines += ["", f"### {title}", "", "| mutant | file | change | evaluated by | reason |", "|---|---|---|--:|---|"]
        for m in chosen:
            change = f"`{' '.join(m.old.split())}` → `{' '.join(m.new.split())}`".replace("|", "\\|")
            ran = results[m.name]["short"]["evaluated"]
            lines.append(f"| {m.name} | {m.file.split('/')[-1]} | {change} | {ran} | {m.reason} |")
    return "\n".join(lines)
