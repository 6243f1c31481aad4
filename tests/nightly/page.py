# SPDX-License-Identifier: BSD-3-Clause
"""The page of a run of ./test --long: a table of parts, and the output of those that failed."""

import html as escaping
import os
import pathlib
import platform
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
LAST_LINES = 80  # of the output of a part that failed

STYLE = """
main { max-width: 68rem; margin: auto; padding: 1rem; background: var(--card); }
html { background: var(--card); }
h1 { font-size: 1.4rem; margin: 0.5rem 0; }
dl { grid-template-columns: max-content 1fr; gap: 0 1rem; overflow-wrap: anywhere; }
dd { margin: 0; }
table { width: 100%; margin: 1rem 0; border-collapse: collapse; }
th, td { padding: 6px 8px; border-top: 1px solid var(--line); text-align: left; vertical-align: top; }
td:nth-child(3) { white-space: nowrap; text-align: right; }
small { display: block; color: var(--soft); }
pre { overflow: auto; max-height: 30rem; padding: 8px; border: 1px solid var(--line); font-size: 13px; }
@media (max-width: 40rem) {
  thead { display: none; }
  tr { display: block; border-top: 1px solid var(--line); padding: 6px 0; }
  td { display: block; border: 0; padding: 2px 0; }
  td:nth-child(3) { text-align: left; }
}
"""


def duration(seconds):
    """Returns a duration in words."""
    minutes, seconds = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {seconds} s" if minutes else f"{seconds} s"


def machine():
    """Returns the machine and the compilers, by name."""
    def first_line(*words):
        try:
            return subprocess.run(words, capture_output=True, text=True, check=True).stdout.partition("\n")[0]
        except (OSError, subprocess.CalledProcessError):
            return "missing"
    names = re.findall(r"^model name\s*: (.*)", pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.M)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return {"processor": f"{(names or [platform.machine()])[0]}, {os.cpu_count()} cores, {memory:.0f} GiB",
            "system": f"{platform.freedesktop_os_release()['PRETTY_NAME']}, Linux {platform.release()}",
            "compilers": f"{first_line('g++', '--version')}; {first_line('clang++', '--version')}"}


def extract(log, status):
    """Returns the notes of a part (figures, or why it was skipped), and the output to show."""
    text = log.read_text(encoding="utf-8", errors="replace")
    notes = [re.sub(r"\d{5,}", lambda number: f"{int(number[0]):,}", figure)
             for figure in re.findall(r"^figure: (.*)", text, re.M)]
    notes += re.findall(r"^\d+% tests passed, \d+ tests failed out of \d+", text, re.M)
    notes += re.findall(r"^\d+ (?:FAILED|SKIPPED) TESTS?", text, re.M)
    if skipped := re.findall(r"^\[  SKIPPED \] (\S+)$|^\s*\d+ - (\S+) \((?:Skipped|Disabled)\)", text, re.M):
        notes.append("skipped in it: " + ", ".join(sorted({one or other for one, other in skipped})))
    if status == "skipped":
        notes += re.findall(r"^skipped: (.*)", text, re.M)[-1:]
    failed = sorted(set(re.findall(r"^\s*\d+ - (\S+) \((?:Failed|Timeout|SEGFAULT|Subprocess\s.*)\)", text, re.M)))
    if failed:
        notes.append("failed: " + ", ".join(failed))
    ends_badly = status in ("failed", "stopped")
    return {"notes": notes, "output": excerpt(text) if ends_badly else ""}


def excerpt(text):
    """Returns the lines around each failure, and the last lines."""
    lines = text.splitlines()
    shown = set(range(max(0, len(lines) - LAST_LINES), len(lines)))
    failures = [k for k, line in enumerate(lines)
                if re.search(r"\*\*\*(Failed|Exception|Timeout)|error: |: Failure$|ERROR: |WARNING: Thread|^FAILED", line)]
    for k in failures[:40]:
        shown.update(range(max(0, k - 2), min(len(lines), k + 25)))
    out, last = [], -1
    for k in sorted(shown):
        if k != last + 1:
            out.append("[...]")
        out.append(lines[k])
        last = k
    return "\n".join(out)


def headline(run, parts):
    """Returns the result of a run in one sentence."""
    statuses = [run["results"].get(part, {}).get("status", "not run") for part in parts]
    counts = [f"{statuses.count(status)} {status}"
              for status in ("failed", "stopped", "passed", "skipped", "not run") if status in statuses]
    return f"{len(parts)} parts: {', '.join(counts)}."


def html(run, parts):
    """Returns the page of a run."""
    def text(words):
        return escaping.escape(str(words))
    base = (ROOT / "apps" / "web" / "src" / "page" / "base.css").read_text(encoding="utf-8")
    rows, outputs = [], []
    for part, title in parts.items():
        result = run["results"].get(part, {"status": "not run", "seconds": 0, "notes": [], "output": ""})
        status = result["status"]
        color = {"passed": "good", "failed": "bad", "stopped": "bad"}.get(status, "")
        shown = f"<a href=\"{part}.log\">{part}</a>" if status != "not run" else part
        time = duration(result["seconds"]) if result["seconds"] else ""
        notes = "<br>".join(map(text, result["notes"]))
        rows.append(f"<tr><td>{shown}<small>{text(title)}</small></td><td class=\"{color}\">{status}</td>"
                    f"<td>{time}</td><td>{notes}</td></tr>")
        if result["output"]:
            outputs.append(f"<h2 id=\"{part}\">{part}: {status}</h2>\n<pre>{text(result['output'])}</pre>")
    facts = {"commit": run["source"], "date": run["date"], **run["machine"]}
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>keepout: tests of a night</title>
<style>{base.replace('@import "./rule_colors.css";', '')}{STYLE}</style></head>
<body><main>
<h1>{text(headline(run, parts))}</h1>
<dl>{''.join(f'<dt>{text(name)}</dt><dd>{text(value)}</dd>' for name, value in facts.items())}</dl>
<table><thead><tr><th>part</th><th>result</th><th>duration</th><th>figures</th></tr></thead>
<tbody>
{chr(10).join(rows)}
</tbody></table>
{chr(10).join(outputs)}
</main></body></html>
"""
