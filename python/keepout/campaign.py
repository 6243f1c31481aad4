# SPDX-License-Identifier: BSD-3-Clause
"""Runs a campaign of `keepout verify` in shards, on this machine or on a Dask cluster.

    python3 -m keepout.campaign skull --steps 1e9 --shards 200 --dask tcp://HOST:8786 --json r.json

The arguments are those of `keepout verify`, and those below. Each shard is a record in FOLDER/shards. A shard that is
finished is not run again: the same command continues a campaign that was stopped. `keepout verify --merge` adds up the
records: its numbers are those of one machine, bit for bit, except for measured times. See docs/campaigns.md.
"""

from __future__ import annotations

import argparse
import concurrent.futures
import hashlib
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from ._workers import WorkersError, by_value, cluster, processes, run_program, stop_on_signals

TRIES = 4  # for a shard whose program is killed


class CampaignError(RuntimeError):
    """Says why a campaign cannot go on. The records of finished shards are kept."""


def _parser() -> argparse.ArgumentParser:
    of = argparse.ArgumentParser(
        prog="python3 -m keepout.campaign", allow_abbrev=False,
        usage="%(prog)s [arguments of keepout verify] [--shards N] [--dask ADDRESS] [...]",
        description="Runs a campaign of 'keepout verify' in shards, on this machine or on a Dask cluster. What is "
        "finished is kept: the same command continues a campaign that was stopped.")
    of.add_argument("--shards", type=int, default=64, metavar="N", help="number of shards (default: 64)")
    of.add_argument("--dask", metavar="ADDRESS", help="scheduler of a Dask cluster, such as tcp://HOST:8786; default: "
                    "processes on this machine")
    of.add_argument("--jobs", type=int, metavar="N", help="processes on this machine (default: one a processor)")
    of.add_argument("--folder", type=Path, default=Path("keepout-campaign"), metavar="FOLDER",
                    help="where to keep the records of shards and a log (default: %(default)s)")
    of.add_argument("--json", metavar="FILE", help="where to write the record of all (default: FOLDER/campaign.json)")
    of.add_argument("--out", metavar="REPORT.html", help="where to write a report")
    of.add_argument("-q", "--quiet", action="store_true", help="print no progress")
    return of


def _digest(file: str | Path) -> str:
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()[:16]


class Campaign:
    """A campaign whose shards are in a folder."""

    def __init__(self, folder: Path, program: str, arguments: list[str], shards: int) -> None:
        """Raises CampaignError if the folder has another campaign."""
        self.folder = folder
        self.program = program
        self.arguments = arguments
        self.shards = shards
        made_of: dict[str, Any] = {
            "arguments": arguments, "shards": shards, "program": _digest(program),
            "files": {name: _digest(name) for name in arguments if Path(name).is_file()}}
        (folder / "shards").mkdir(parents=True, exist_ok=True)
        file = folder / "settings.json"
        if not file.exists():
            _write(file, json.dumps(made_of, indent=1) + "\n")
        before = json.loads(file.read_text())
        other = [key for key in made_of if before.get(key) != made_of[key]]
        if other:
            raise CampaignError(f"{folder} has the shards of another campaign: its {', '.join(other)} differ. Name "
                                "another one with --folder, or remove it")

    def file(self, shard: int) -> Path:
        return self.folder / "shards" / f"{shard:05}.json"

    def command(self, shard: int) -> list[str]:
        return [self.program, "verify", *self.arguments, "--shard", f"{shard}/{self.shards}", "--json", "/dev/stdout"]

    def is_done(self, shard: int) -> bool:
        try:
            return _is_whole(self.file(shard).read_text(), shard, self.shards)
        except OSError:
            return False

    def log(self, text: str) -> None:
        with (self.folder / "log.txt").open("a") as out:
            out.write(time.strftime("%Y-%m-%d %H:%M:%S ") + text + "\n")


def _write(file: Path, text: str) -> None:
    part = file.with_suffix(".part")
    part.write_text(text)
    part.replace(file)


def _record_in(printed: str) -> str:
    """Returns the record in the output of a shard, which begins with its table."""
    begin = printed.find('{\n"keepout_record"')
    return printed[begin:] if begin >= 0 else ""


def _is_whole(record: str, shard: int, shards: int) -> bool:
    try:
        read = json.loads(record)
        return (read["shard_count"], [(s["index"], s["complete"]) for s in read["shards"]]) == (shards, [(shard, True)])
    except (ValueError, KeyError, TypeError):
        return False


def run_shards(campaign: Campaign, pool: concurrent.futures.Executor, task: Any, quiet: bool) -> None:
    """Runs the shards that are not finished. A program that a signal killed is run again on any worker."""
    environment = {name: value for name, value in os.environ.items() if name.startswith("KEEPOUT_")}
    tries: dict[int, int] = {}
    running: dict[concurrent.futures.Future[tuple[int, str, str]], int] = {}

    def begin(shard: int) -> None:
        tries[shard] = tries.get(shard, 0) + 1
        running[pool.submit(task, campaign.command(shard), os.getcwd(), environment, "")] = shard

    left = [shard for shard in range(1, campaign.shards + 1) if not campaign.is_done(shard)]
    kept = campaign.shards - len(left)
    campaign.log(f"{kept} of {campaign.shards} shards are finished; running the others")
    for shard in left:
        begin(shard)
    on_terminal = sys.stderr.isatty()
    started = shown = time.monotonic()
    done = breaches = 0
    while running:
        finished, _ = concurrent.futures.wait(running, timeout=10, return_when=concurrent.futures.FIRST_COMPLETED)
        for future in finished:
            shard = running.pop(future)
            try:
                status, printed, errors = future.result()
            except Exception as fault:  # such as a worker that was lost several times
                campaign.log(f"shard {shard}: {fault!r}")
                raise CampaignError(f"shard {shard}/{campaign.shards}: {fault!r:.500}") from fault
            record = _record_in(printed)
            if _is_whole(record, shard, campaign.shards):
                _write(campaign.file(shard), record)
                done += 1
                headline = json.loads(record)["headline"]
                breaches += not headline.startswith(("No breach", "Nothing"))
                campaign.log(f"shard {shard}: {headline}")
            elif (status < 0 or status in (130, 137, 143)) and tries[shard] < TRIES:
                campaign.log(f"shard {shard}: its program was ended (status {status}); running it again")
                begin(shard)
            else:
                said = errors.strip() or printed.strip() or f"exit status {status}"
                campaign.log(f"shard {shard}: {said}")
                raise CampaignError(f"shard {shard}/{campaign.shards}: {said}")
        if not quiet and (on_terminal or not running or time.monotonic() - shown >= 10):
            shown = time.monotonic()
            rest = (shown - started) / done * (len(left) - done) if done else 0
            line = f"{kept + done} of {campaign.shards} shards" + (
                f", {rest / 60:.0f} min left" if rest >= 60 else f", {rest:.0f} s left" if rest else "") + (
                f", {breaches} with a breach" if breaches else "")
            print(f"\r\033[K{line}" if on_terminal else line, end="" if on_terminal and running else "\n",
                  file=sys.stderr, flush=True)


def main(arguments: list[str]) -> int:
    told, of_verify = _parser().parse_known_args(arguments)
    stop_on_signals()
    wrong = [name for name in ("--shard", "--merge") if any(a.split("=")[0] == name for a in of_verify)]
    if wrong:
        raise CampaignError(f"{wrong[0]}: this command makes the shards and adds them up; say --shards N")
    if told.shards < 1 or (told.jobs is not None and told.jobs < 1):
        raise CampaignError("--shards, --jobs: give 1 or more")
    program = os.environ.get("KEEPOUT_COMMAND") or shutil.which("keepout")
    if not program:
        raise CampaignError("the program 'keepout' is not found: install it, or name it in KEEPOUT_COMMAND")
    campaign = Campaign(told.folder, str(Path(program).resolve()), of_verify, told.shards)
    try:
        if told.dask:
            with cluster(told.dask) as pool:
                run_shards(campaign, pool, by_value(run_program), told.quiet)
        else:
            with processes(told.jobs or len(os.sched_getaffinity(0))) as pool:
                run_shards(campaign, pool, run_program, told.quiet)
    except KeyboardInterrupt:
        print(f"keepout: stopped. Finished shards are kept in {told.folder}; the same command continues from there.",
              file=sys.stderr)
        return 130
    merged = [campaign.program, "verify", "--merge", str(campaign.folder / "shards"),
              "--json", told.json or str(campaign.folder / "campaign.json")]
    return subprocess.run(merged + (["--out", told.out] if told.out else []), check=False).returncode


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except (CampaignError, WorkersError, OSError) as error:
        print(f"keepout: {error}", file=sys.stderr)
        sys.exit(1)
