# SPDX-License-Identifier: BSD-3-Clause
"""The JSON Schemas in docs/schemas: records of each kind and requests of keepout serve are valid, wrong ones are not."""

import base64
import copy
import gzip
import json
import os
import re
import subprocess
from pathlib import Path

import pytest

jsonschema = pytest.importorskip("jsonschema", reason="needs python3-jsonschema")

keepout = os.environ["KEEPOUT_COMMAND"]
root = Path(__file__).parents[2]
schemas = {path.stem: json.loads(path.read_text()) for path in (root / "docs/schemas").glob("*.json")}
records = jsonschema.Draft202012Validator(schemas["record"])
requests = jsonschema.Draft202012Validator(schemas["serve_request"])

# Short runs of each command that writes records, by kind of record.
runs = {
    "simulate": "simulate cube --strokes 1 --cycles 20 --guide ball:0,0,60:30",
    "simulate_robot": "simulate cube --robot psm --strokes 1 --cycles 20",
    "verify": "verify cube --steps 500",
    "verify_robot": "verify --scenario guides --cycles 200",
    "bench": "bench --mesh cube --index wide_bvh,pd_tree --queries 20 --seconds 0.1 --radius 1",
    "speed": "bench --speed --quick --triangles 4000 --steps 3000",
    "compare": "compare cube --poses 6 --problems 20 --pairs 10",
    "plan": "plan cube --problems 1 --seconds 0.2",
    "plan_robot": "plan cube --robot psm --problems 1 --seeds 1 --seconds 0.2",
}


def faults(validator, instance):
    """Returns the errors of validation as text."""
    return [f"{error.json_path}: {error.message[:200]}" for error in validator.iter_errors(instance)]


def run(arguments, folder, expected=(0,)):
    done = subprocess.run([keepout, *arguments.split()], cwd=folder, capture_output=True, text=True,
                          env={**os.environ, "LC_ALL": "C.UTF-8"})
    if "there is no command" in done.stderr or "needs OMPL" in done.stderr:
        pytest.skip(f"this build has no '{arguments.split()[0]}'")
    assert done.returncode in expected, done.stderr
    return done.stdout


@pytest.mark.parametrize("name", schemas)
def test_schemas_are_schemas(name):
    jsonschema.Draft202012Validator.check_schema(schemas[name])


def test_every_committed_record_is_valid():
    paths = sorted((root / "docs/records").glob("*.json.gz"))
    assert len(paths) > 20
    for path in paths:
        assert faults(records, json.loads(gzip.decompress(path.read_bytes()))["record"]) == [], path.name


def refuses_changes(record):
    """Fails unless the schema refuses the record without each member that it requires, and with wrong types."""
    kind = record["keepout_record"]
    required = schemas["record"]["$defs"][kind]["required"] + schemas["record"]["$defs"]["head"]["required"]
    for name in required:
        changed = copy.deepcopy(record)
        del changed[name]
        assert faults(records, changed), f"{kind} without {name}"
        if record[name] is not None:
            changed[name] = {"other": 1.5} if isinstance(record[name], list) else [[]]
            assert faults(records, changed), f"{kind} with another {name}"
    assert faults(records, {**record, "keepout_record": "other"})
    assert faults(records, {**record, "format": 3})
    assert faults(records, {**record, "date": "yesterday"})


@pytest.mark.parametrize("kind", runs)
def test_a_fresh_record_is_valid_and_a_changed_one_is_not(kind, tmp_path):
    run(f"{runs[kind]} --json record.json", tmp_path, expected=(0, 1))  # 1: a demand of --speed is not met
    record = json.loads((tmp_path / "record.json").read_text())
    assert record["keepout_record"] == kind
    assert faults(records, record) == []
    refuses_changes(record)


def test_the_record_of_an_inspection_is_valid(tmp_path):
    (tmp_path / "open.off").write_text("OFF\n5 2 0\n0 0 0\n90 0 0\n0 90 0\n0 0 90\n9 9 9\n3 0 1 2\n3 0 1 3\n")
    run("inspect open.off --self-intersections --out page.html", tmp_path)
    page = (tmp_path / "page.html").read_text()
    found = re.search(r'<script type="application/octet-stream" id="record">(.*?)</script>', page, re.DOTALL)
    if not found:
        pytest.skip("the front end of pages is not built: a plain page has no record")
    record = json.loads(gzip.decompress(base64.b64decode(found[1])))
    assert record["inspection"]["findings"]
    assert faults(records, record) == []
    refuses_changes(record)


def names_of(schema):
    """Yields the names of all members that a schema describes."""
    if isinstance(schema, dict):
        properties = schema.get("properties")
        if isinstance(properties, dict):
            yield from properties
        for member in schema.values():
            yield from names_of(member)
    elif isinstance(schema, list):
        for member in schema:
            yield from names_of(member)


def test_records_md_describes_each_member():
    page = (root / "docs/records.md").read_text()
    words = set(re.findall(r"`(\w+)`", page))
    # The page leaves the rows of a comparison to compare.h, and names the members of shaft, wrist and jaw once.
    others = set(re.findall(r"\w+", (root / "benchmarks/compare/compare.cpp").read_text()))
    names = set(names_of(schemas["record"]))
    assert len(names) > 200
    missing = {re.sub("^(wrist|jaw)_", "shaft_", name) for name in names - words - others}
    assert missing - words == set()


def test_the_schema_of_requests_is_that_of_the_command():
    assert json.loads(run("serve --schema", root)) == schemas["serve_request"], \
        "run: keepout serve --schema > docs/schemas/serve_request.json"
    narrow = json.loads(run("serve --joints 3 --rows 0 --schema", root))
    assert narrow["$defs"]["bounds"]["maxItems"] == 0


def test_the_examples_in_the_documentation_are_valid():
    valid = wrong = 0
    for page in ("docs/serve.md", "docs/guides.md", "docs/convex_tools.md", "examples/serve_client.sh"):
        lines = (root / page).read_text().splitlines()
        for line, following in zip(lines, [*lines[1:], ""]):
            found = re.search(r"""^(?: *|.*[`'])(\{("id":\d+,)?"do":.*\})['`]?""", line)
            if not found or "..." in found[1]:
                continue
            request = json.loads(found[1].split("`")[0])
            if '"error"' in following or page.endswith(".sh") and request.get("id") == 3:
                assert faults(requests, request), line
                wrong += 1
            else:
                assert faults(requests, request) == [], line
                valid += 1
    assert valid > 6 and wrong == 2


def test_wrong_requests_are_refused():
    step = {"id": 1, "do": "step", "tip": [0, 0, 60], "desired": [0, 0, -0.5]}
    assert faults(requests, step) == []
    for change in ({"id": 1.5}, {"id": "a" * 129}, {"id": [1]}, {"do": "fly"}, {"tip": [0, 0]}, {"tip": [0, 0, "0"]},
                   {"tip": None}, {"margn": 1}, {"margin": 1}, {"jacobian": [[1]]}, {"rows": [[1] * 8], "bounds": [0]}):
        assert faults(requests, {**step, **change}), change
    assert faults(requests, {"id": 1, "do": "step", "tip": [0, 0, 60]})
    assert faults(requests, [step])


def test_the_schema_agrees_with_the_server_on_garbled_requests(tmp_path):
    """The fuzz test of the server writes its requests. The schema must accept those that the server carries out."""
    program = os.environ.get("KEEPOUT_INPUT_TEST")
    if not program:
        pytest.skip("KEEPOUT_INPUT_TEST does not name the fuzz test")
    lines = tmp_path / "lines"
    subprocess.run([program, "--gtest_filter=ServeFuzz.WritesRequestsForTheTestOfTheSchema"], check=True,
                   capture_output=True, env={**os.environ, "KEEPOUT_LINES": str(lines)})
    schema, *answered = map(json.loads, lines.read_text(encoding="utf-8").splitlines())
    validator = jsonschema.Draft202012Validator(schema)
    accepted = refused = unexplained = 0
    for answer in answered:
        try:
            found = faults(validator, json.loads(answer["request"]))
        except ValueError:  # a number that Python does not read
            continue
        if answer["error"] is None:
            assert found == [], answer["request"]
            accepted += 1
        elif answer["error"] == "not_a_request":
            refused += bool(found)
            unexplained += not found
    # The rest has sizes that do not agree, or members given twice, which a schema cannot see.
    assert accepted > 500 and refused > 500 and unexplained < refused / 2, (accepted, refused, unexplained)
