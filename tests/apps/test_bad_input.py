# SPDX-License-Identifier: BSD-3-Clause
"""Typos, broken meshes, broken robots, bad requests and full disks, as a clumsy user gives them to the command.

Each case has the texts of the message and the exit status: 2 for a wrong command line, 1 for a failure. In every case the
command ends without a signal, prints one message that names the input, and leaves all files unchanged.
"""

import gzip
import json
import os
import random
import re
import struct
import subprocess
import time
from pathlib import Path

import pytest

keepout = os.environ["KEEPOUT_COMMAND"]
root = Path(__file__).parents[2]
is_sanitized = bool(os.environ.get("KEEPOUT_SANITIZE"))
patience = 60 if is_sanitized else 20  # for a command with little work, on a busy machine [s]
to_s = "replay cube.off --poses poses.txt --out s.csv"  # tests append the mistake
simulate = "simulate cube --strokes 1 --cycles 20 --activation paper"

length = "expected a number from 1e-15 to 1e15, not "
zero_or_length = "expected 0 or a number from 1e-15 to 1e15, not "
above_0 = "expected a number above 0 and at most 1e30, not "

# Wrong names and options, and how the message begins.
wrong_lines = [
    ("", "a command is missing; there are inspect, "),
    ("cube.off", "there is no command 'cube.off'; there are inspect, "),
    ("inspec cube", "there is no command 'inspec'; did you mean 'inspect'?"),
    ("regsiter cube", "there is no command 'regsiter'; did you mean 'register'?"),
    ("replya cube", "there is no command 'replya'; did you mean 'replay'?"),
    ("simulat cube", "there is no command 'simulat'; did you mean 'simulate'?"),
    ("liev cube", "there is no command 'liev'; did you mean 'live'?"),
    ("server cube", "there is no command 'server'; did you mean 'serve'?"),
    ("verfiy cube", "there is no command 'verfiy'; did you mean 'verify'?"),
    ("reprot a.json", "there is no command 'reprot'; did you mean 'report'?"),
    ("bnech cube", "there is no command 'bnech'; did you mean 'bench'?"),
    ("compair cube", "there is no command 'compair'; did you mean 'compare'?"),
    ("plann cube", "there is no command 'plann'; did you mean 'plan'?"),
    ("--versoin", "there is no option --versoin; did you mean '--version'?"),
    ("inspect cube --jsno", "there is no option --jsno; did you mean '--json'?"),
    ("inspect cube --colour", "there is no option --colour\n"),
    ("register f.csv --taget 1 2 3", "there is no option --taget; did you mean '--target'?"),
    ("replay cube --pose p --out s.csv", "there is no option --pose; did you mean '--poses'?"),
    (f"{to_s} --raduis 3", "there is no option --raduis; did you mean '--radius'?"),
    ("simulate cube --raduis=1", "there is no option --raduis; did you mean '--radius'?"),
    ("bench --tool sphere:1", "there is no option --tool"),
    ("live cube --no-opne", "there is no option --no-opne; did you mean '--no-open'?"),
    ("serve cube --joint 3", "there is no option --joint; did you mean '--joints'?"),
    ("verify cube --step 10", "there is no option --step; did you mean '--steps'?"),
    ("report a.json --otu a.html", "there is no option --otu; did you mean '--out'?"),
    (f"{simulate} --out r.pdf", "--out: expected a name that ends with .html, as it is an HTML page, not 'r.pdf'"),
    ("simulate cube.off --out cube.off", "--out: expected a name that ends with .html"),
    ("bench --spead", "there is no option --spead; did you mean '--speed'?"),
    ("compare --pair 3", "there is no option --pair; did you mean '--pairs'?"),
    ("plan --planer RRT", "there is no option --planer; did you mean '--planner'?"),
    ("verify cube.off --unit m", "there is no option --unit: convert the mesh first, 'keepout convert IN OUT --unit ...'"),
    ("plan cube.off --scale=9", "there is no option --scale: convert the mesh first, 'keepout convert IN OUT --scale ...'"),
    ("plan cube.off --flip", "there is no option --flip: convert the mesh first, 'keepout convert IN OUT --flip', and"),
    ("bench --unit m", "--unit can only be used together with --mesh"),
    # Missing, superfluous and incompatible arguments.
    *((command, "an argument is missing: MESH is required") for command in ("inspect", "simulate", "serve")),
    *((command, "an argument is missing: FILE is required") for command in ("register", "report")),
    ("replay cube --out s.csv", "an argument is missing: --poses is required"),
    ("replay cube --poses poses.txt", "an argument is missing: --out is required"),
    ("inspect cube gear", "'gear' is one argument too many for inspect"),
    ("simulate cube gear", "MESH: "),
    ("simulate cube --radius", "--radius: a value is missing"),
    ("register f.csv --target 1 2", "--target: a value is missing"),
    ("verify --merge", "--merge: a value is missing"),
    (f"{to_s} --max-step 1", "--max-step can only be used together with --closed-loop"),
    (f"{to_s} --narrow-phase exact", "--narrow-phase can only be used together with --tool"),
    ("serve cube --max-clients 3", "--max-clients can only be used together with --socket"),
    ("simulate cube --speed 1", "--speed can only be used together with --robot"),
    ("simulate cube --robot psm --radius 1", "--radius and --robot cannot be given together"),
    (f"{to_s} --unit m --scale 2", "--unit and --scale cannot be given together"),
    ("verify --merge a.json --steps 3", "--steps and --merge cannot be given together"),
    ("verify cube --robot psm --steps 3", "--robot and --steps cannot be given together"),
    (f"{to_s} --tool sphere:1 --tool-radius 1", "--tool"),
    ("bench --simd SCALAR", "--simd must precede the command: 'keepout --simd ... bench'"),
    # Names of parts.
    ("--simd AVX22 inspect cube", "--simd: there is no 'AVX22'; "),
    ("inspect cube --space lsp", "--space: there is no 'lsp'; did you mean 'lps'?"),
    ("register f.csv --measured-in cm", "--measured-in: there is no 'cm'; there are: mm, m"),
    ("inspect cube.off --unit inch", "--unit: there is no 'inch'; "),
    ("simulate cube --index wide_bhv", "--index: there is no 'wide_bhv'; did you mean 'wide_bvh'? There are: "),
    ("simulate cube --solver activeset", "--solver: there is no 'activeset'; did you mean 'active_set'?"),
    ("simulate cube --activation certifed,paper", "--activation: there is no 'certifed'; did you mean 'certified'?"),
    ("simulate cube --query spere", "--query: there is no 'spere'; did you mean 'sphere'?"),
    ("simulate cube --robot pms", "--robot: there is no 'pms'; did you mean 'psm'?"),
    (f"{to_s} --activation best", "--activation: there is no 'best'; there are: all_faces, paper, certified\n"),
    (f"{to_s} --index pd-tree", "--index: there is no 'pd-tree'; did you mean 'pd_tree'?"),
    (f"{to_s} --inside kept", "--inside: there is no 'kept'; there are: "),
    ("live cube --activation nun", "--activation: there is no 'nun'; there are: "),
    ("verify cube --scenario aproach", "--scenario: there is no 'aproach'; did you mean 'approach'?"),
    ("verify cube --robot psn", "--robot: there is no 'psn'; did you mean 'psm'?"),
    ("verify cube --motion lineal", "--motion: there is no 'lineal'; there are: "),
    ("bench --index embre", "--index: there is no 'embre'; did you mean 'embree'?"),
    ("bench --poses kontact", "--poses: there is no 'kontact'; did you mean 'contact'?"),
    ("plan --planner RTT", "--planner: there is no 'RTT'; did you mean 'RRT'?"),
    # Values that an option rejects.
    *((f"{to_s} --radius {value}", f"--radius: {length}'{value}'") for value in ("nan", "inf", "0", "-3", "2e30", "5mm", "three")),
    *((f"{to_s} --margin {value}", f"--margin: {zero_or_length}'{value}'") for value in ("-1", "nan", "1e-16", "0,2")),
    (f"{to_s} --margin=-1", f"--margin: {zero_or_length}'-1'"),
    (f"{to_s} --tool-radius -1", f"--tool-radius: {zero_or_length}'-1'"),
    (f"{to_s} --deepest -1", f"--deepest: {zero_or_length}'-1'"),
    (f"{to_s} --damping -1", "--damping: expected a number from 0 to 1e30, not '-1'"),
    *((f"{to_s} --refine {value}", f"--refine: expected a whole number from 0 to 1000, not '{value}'")
      for value in ("some", "1e4", "1.5e0")),
    *((line, f"{option}: expected a value, not ''") for line, option in (
        ("inspect ''", "MESH"), ("simulate cube --out ''", "--out"), ("replay cube --poses '' --out s", "--poses"),
        ("bench --csv ''", "--csv"), ("serve cube --socket ''", "--socket"))),
    ("simulate cube --strokes 1.5e0", "--strokes: expected a whole number from 1 to 100000, not '1.5e0'"),
    (f"{to_s} --branches 99999999", "--branches: expected a whole number from 0 to 65536, not '99999999'"),
    (f"{to_s} --closed-loop --max-step nan", f"--max-step: {above_0}'nan'"),
    (f"{to_s} --tool ball:1", "--tool: the tool 'ball': there is no such form; write sphere:R or"),
    (f"{to_s} --tool sphere:-1", "--tool: the tool 'sphere': the radius of a convex tool must be a number from 0 to 1e30, not -1"),
    (f"{to_s} --tool hull:none.stl", "--tool: the tool 'hull': there is no file 'none.stl'"),
    (f"{to_s} --guide bal:0,0,0:1", "--guide: the guide 'bal:0,0,0:1': there is no such guide or region; write "),
    (f"{to_s} --guide ball:0,0,0:-1", f"--guide: the guide 'ball:0,0,0:-1': radius: {length[:-6]}, got -1"),
    ("simulate cube --seed -1", "--seed: expected a whole number from 0 to 9223372036854775807"),
    ("simulate cube --seed 123456789012345678901", "--seed: expected a whole number"),
    ("simulate cube --strokes 0", "--strokes: expected a whole number from 1 to 100000"),
    ("simulate cube --cycles 9", "--cycles: expected a whole number from 10 to 1000000"),
    ("simulate cube --robot psm --speed 0", "--speed: expected a multiple from 0.001 to 1000, not '0'"),
    *((f"{to_s} --scale {value}", f"--scale: expected a number from 1e-30 to 1e30, not '{value}'")
      for value in ("0", "-1", "nan", "inf", "x", "0x10")),
    ("inspect cube --json=many", "--json: "),
    ("register f.csv --target 1 2 x", "--target: expected a number from -1e6 to 1e6, not 'x'"),
    ("register f.csv --confidence 1", "--confidence: expected a probability from 0.01 to 0.9999, not '1'"),
    ("register f.csv --fle -1", f"--fle: {above_0}'-1'"),
    ("serve cube --joints 0", "--joints: expected a whole number from 1 to 64, not '0'"),
    ("serve cube --max-line 10", "--max-line: expected a whole number from 256 to 16777216, not '10'"),
    ("igtl cube --port 65536", "--port: expected a whole number from 0 to 65535, not '65536'"),
    ("igtl cube --rate 5", "--rate: expected a whole number from 10 to 2000, not '5'"),
    ("igtl cube --silence 0", "--silence: expected a number from 0.001 to 60, not '0'"),
    ("igtl cube --max-body 100", "--max-body: expected a whole number from 4096 to 1073741824, not '100'"),
    ("verify cube --steps 1.5", "--steps: expected a whole number from 1 to 1"),
    ("verify cube --shard 3/2", "--shard: expected I/N, part I of N, "),
    ("bench --seconds soon", f"--seconds: {above_0}'soon'"),
    ("bench --radius 1,x", f"--radius: {above_0}'x'"),
    *((line, f"{line.split()[-2]}: expected a value before and behind each comma, not '{line.split()[-1]}'") for line in (
        "bench --radius 1,,2", "bench --index wide_bvh,", "simulate cube --activation ,paper", "verify --scenario guides,,moving",
        "simulate cube --robot psm --speed 1,,5", "plan --resolution 0.1,,0.01")),
    ("bench --radius=1,,2 --seed 3", "--radius: expected a value before and behind each comma, not '1,,2'"),
    ("bench --queries 0", "--queries: expected a whole number from 5 to 10000000, not '0'"),
    ("bench --triangles 0", "--triangles: expected a whole number from 1000 to 200000000, not '0'"),
    ("compare cube --pairs 0", "--pairs: expected a whole number from 10 to 1000000, not '0'"),
    ("plan --seconds soon", "--seconds: expected seconds above 0 and not above 86400, not 'soon'"),
    ("plan --problems 0", "--problems: expected a whole number from 1 to 10000, not '0'"),
    ("plan --resolution 2", "--resolution: expected a fraction of the extent from 0.000001 to 1, not '2'"),
]

# Files that are missing, not regular or of another kind; outputs that cannot be written. The message has all of the texts.
files = [
    ("inspect none.stl", "none.stl: there is no such file, and no sample mesh of that name"),
    ("inspect skul", "did you mean 'skull'?"),
    ("inspect folder", "folder: is a directory"),
    ("inspect loop.stl", "loop.stl: cannot be reached (Too many levels of symbolic links)"),
    ("inspect cube.off/mesh.stl", "cube.off/mesh.stl: cannot be reached (Not a directory)"),
    ("live none.stl", "none.stl: there is no such file, and no sample mesh of that name"),
    ("live broken.stl", "broken.stl: line 6: "),
    ("convert far.obj q.stl", "far.obj: rounded to the single precision of STL", "write .ply, which keeps all digits"),
    ("convert line.off q.stl", "line.off: all of its triangles are degenerate", "check the export"),
    *((f"{command} line.off", "line.off: none of its triangles has an area") for command in (
        "simulate", "simulate --robot psm", "verify --steps 200", "verify --robot psm --cycles 10")),
    ("register none.csv", "none.csv: cannot be read", "FILE"),
    ("register folder", "folder: cannot be read"),
    ("register cube.off", "cube.off:2: has fewer than six numbers"),
    ("replay cube.off --poses none.txt --out s.csv", "none.txt: cannot be read", "--poses"),
    ("replay cube.off --poses folder --out s.csv", "folder: cannot be read", "--poses"),
    ("replay cube.off --poses nan.txt --out s.csv", "nan.txt:2: "),
    ("replay cube.off --poses cube.off --out s.csv", "cube.off:1: 'OFF' is not a number"),
    ("replay cube.off --poses /dev/null --out s.csv", "/dev/null: holds no pose"),
    ("replay cube.off --poses /dev/zero --out s.csv", "/dev/zero:1: is longer than 65535 bytes"),
    ("replay cube.off --poses nan.txt --out old.csv", "nan.txt:2: "),
    ("report none.json", "none.json: cannot be read"),
    (f"{to_s} --index pd_tree --index-cache store", "index_cache: only the index wide_bvh can be stored, not 'pd_tree'"),
    ("report folder", "folder: is a folder; name a record in it"),
    ("report poses.txt", "poses.txt: is no whole record"),
    ("report cut.json", "cut.json: is no whole record"),
    ("report /dev/zero", "/dev/zero: is no whole record"),
    ("verify --merge none.json", "none.json: cannot be read"),
    ("verify --merge folder", "folder: the folder has no record"),
    ("verify --merge poses.txt", "poses.txt: is not a whole result"),
    *((line, "margin 0 and tool_radius 0 together must be well above") for line in (
        f"{to_s} --margin 0", "replay cube --poses poses.txt --out s.csv --margin 0", "serve cube --margin 0")),
    (f"{to_s} --margin 1e14 --radius 1e-3", "radius: expected more than 1e-9 of tool_radius plus margin", "got 0.001"),
    (f"{to_s} --closed-loop --max-step 9", "--max-step"),
    ("igtl cube --address localhost", "--address 'localhost': expected the IPv4 address of this machine"),
    ("igtl cube --port 0 --address 192.0.2.1", "cannot listen at 192.0.2.1:0: "),
    # Outputs.
    ("replay cube.off --poses poses.txt --out no/s.csv", "no/s.csv: cannot write here (No such file or directory)"),
    ("replay cube.off --poses poses.txt --out folder", "folder: is a folder; results are written to a regular file"),
    ("replay cube.off --poses poses.txt --out /dev/full", "/dev/full: is a pipe, a socket or a device"),
    ("replay cube.off --poses poses.txt --out loop.csv", "loop.csv: its links lead in a circle"),
    (f"replay cube.off --poses poses.txt --out {'y' * 300}.csv", "yyy.csv: cannot write here (File name too long)"),
    ("replay cube.off --poses poses.txt --out poses.txt", "--out 'poses.txt' is the same file as --poses 'poses.txt'"),
    ("replay cube.off --poses poses.txt --out link.off", "--out 'link.off' is the same file as MESH"),
    ("replay cube.off --poses poses.txt --out s.csv --planes cube.off", "--planes 'cube.off' is the same file as MESH"),
    ("replay cube.off --poses poses.txt --out s.csv --planes ./s.csv", "--planes './s.csv' is the same file as --out"),
    (f"{simulate} --out r.html --json r.html", "--json 'r.html' is the same file as --out"),
    (f"{simulate} --out - --json /dev/fd/1", "--json '/dev/fd/1' is the same file as --out '-'"),
    ("replay cube.off --poses poses.txt --out - >> poses.txt", "--out '-' is the same file as --poses"),
    ("register f.csv --json - >&-", "stdout: is not open for writing"),
    ("register f.csv --json /dev/fd/77", "/dev/fd/77: is not open for writing (Bad file descriptor)"),
    ("inspect cube.off --out no/page.html", "no/page.html: cannot write here"),
    ("simulate broken.stl --out no/r.html", "no/r.html", "cannot write here"),  # reported before the mesh is read
    ("simulate broken.stl --out folder", "folder: is a folder"),
    (f"{simulate} --out old.html --json no/r.json", "no/r.json: cannot write here"),
    ("register f.csv --json f.csv", "--json 'f.csv' is the same file as FILE 'f.csv'"),
    ("register f.csv --json /dev/full", "/dev/full: is a pipe, a socket or a device"),
    ("verify cube --steps 10 --json no/v.json", "no/v.json: cannot write here"),
    ("bench --mesh cube --csv no/b.csv", "no/b.csv: cannot write here"),
    ("compare cube --json no/c.json", "no/c.json: cannot write here"),
    ("plan cube --json no/p.json", "no/p.json: cannot write here"),
    # Full disks and closed pipes. A limit on the size of files stands for a full disk.
    ("replay cube.off --poses many.txt --out old.csv", "old.csv: could not be written to the end", "ulimit -f 8;"),
    ("verify cube --steps 100 --json v.json", "v.json: could not be written to the end", "ulimit -f 1;"),
    ("verify cube --steps 100 --json old.json", "old.json: could not be written to the end", "ulimit -f 1;"),
    *((line, "stdout: could not be written to the end") for line in (
        "inspect cube.off > /dev/full", "inspect cube.off >&-", "--help > /dev/full", "--version > /dev/full",
        "simulate --help > /dev/full")),
    *((f"serve cube.off {closed}", "stdin or stdout is closed") for closed in ("<&-", ">&-")),
]


def binary_stl(triangles, count=None, corners=(0.0, 0, 0, 1, 0, 0, 0, 1, 0)):
    one = struct.pack("<12fH", 0, 0, 1, *corners, 0)
    return bytes(80) + struct.pack("<I", triangles if count is None else count) + triangles * one


def binary_ply(points, faces):
    head = ply.partition("end_header\n")[0].replace("ascii", "binary_little_endian")
    return (head + "end_header\n").encode() + struct.pack("<9f", *points) + faces


formats = "stl", "ply", "obj", "off", "vtk", "vtp"
facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
stl = f"solid a\n{facet}endsolid a\n"
ply = ("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
vtk = ("# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0\n1 0 0\n0 1 0\n"
       "POLYGONS 1 4\n3 0 1 2\n")
nan, infinity = float("nan"), float("inf")
flat = (0, 0, 0, 1, 0, 0, 0, 1, 0)
garbage = random.Random(1).randbytes(3000)
damaged = "damaged"
cut_short = "cut short"
not_finite = "not finite"
# name: content, and what the message contains beside the name
meshes = {
    "cut.stl": (stl[:70], cut_short),
    "no_end.stl": (stl.replace("endsolid a\n", ""), "ends without 'endsolid'"),
    "nan.stl": (stl.replace("1 0 0", "nan 0 0"), not_finite),
    "large.stl": (stl.replace("1 0 0", "1e400 0 0"), not_finite),
    "word.stl": (stl.replace("1 0 0", "one 0 0"), "expected a number, found 'one'"),
    "two_numbers.stl": (stl.replace("1 0 0", "1 0"), "expected a number, found 'vertex'"),
    "four_corners.stl": (stl.replace("endloop", "vertex 1 1 0\nendloop"), "more than three corners"),
    "typo.stl": (stl.replace("outer loop", "outer lop"), "expected 'loop', found 'lop'"),
    "no_facet.stl": ("solid a\nendsolid a\n", "no faces"),
    "binary_cut.stl": (binary_stl(4)[:200], "declares 4 triangles"),
    "binary_huge.stl": (binary_stl(1, 2**32 - 1), "declares 4294967295 triangles"),
    "binary_more.stl": (binary_stl(2, 1), "something follows the mesh"),
    "binary_none.stl": (binary_stl(0), "no triangles"),
    "binary_head.stl": (bytes(80), "too short"),
    "binary_nan.stl": (binary_stl(1, corners=(nan, *flat[1:])), not_finite),
    "binary_infinite.stl": (binary_stl(3, corners=(infinity, *flat[1:])), not_finite),
    "page.stl": ("<!DOCTYPE html><html>404</html>", "expected 'solid'"),
    "other.stl": (ply, "its content is .ply"),
    "fewer.ply": (ply.replace("vertex 3", "vertex 5"), "line 13"),
    "more.ply": (ply.replace("vertex 3", "vertex 2"), "line 12"),
    "huge.ply": (ply.replace("face 1", "face 4000000000"), "declares 4000000000 'face'"),
    "beyond.ply": (ply.replace("3 0 1 2", "3 0 1 7"), "names vertex 7"),
    "negative.ply": (ply.replace("3 0 1 2", "3 0 1 -1"), "found '-1'"),
    "nan.ply": (ply.replace("1 0 0", "nan 0 0"), not_finite),
    "cut.ply": (ply.partition("end_header")[0], "within its header"),
    "points.ply": (ply.replace("element face 1\nproperty list uchar int vertex_indices\n", "").replace("3 0 1 2\n", ""), "no faces"),
    "type.ply": (ply.replace("float x", "quaternion x"), "unknown type 'quaternion'"),
    "format.ply": (ply.replace("ascii 1.0", "ascii 2.0"), "expected 'format ascii 1.0'"),
    "binary_cut.ply": (binary_ply(flat, b"\3" + struct.pack("<2i", 0, 1)), cut_short),
    "binary_list.ply": (binary_ply(flat, b"\xff" + struct.pack("<3i", 0, 1, 2)), cut_short),
    "binary_beyond.ply": (binary_ply(flat, b"\3" + struct.pack("<3i", 0, 1, 9)), "names vertex 9"),
    "binary_nan.ply": (binary_ply((nan,) * 9, b"\3" + struct.pack("<3i", 0, 1, 2)), not_finite),
    "no_face.obj": (obj.replace("f 1 2 3\n", ""), "no faces"),
    "zero.obj": (obj.replace("f 1", "f 0"), "names vertex '0'"),
    "beyond.obj": (obj.replace("2 3", "2 9"), "names vertex '9'"),
    "two_corners.obj": (obj.replace("f 1 2 3", "f 1 2"), "needs three corners"),
    "two_numbers.obj": (obj.replace("v 1 0 0", "v 1 0"), "needs three coordinates"),
    "nan.obj": (obj.replace("v 1 0 0", "v nan 0 0"), not_finite),
    "word.obj": (obj.replace("v 1 0 0", "v one 0 0"), "found 'one'"),
    "curve.obj": (obj + "cstype bspline\nsurf 0 1 0 1 1\n", "free-form"),
    "other.obj": (stl, "its content is .stl"),
    "cut.off": (off[:20], "needs three coordinates"),
    "more.off": (off.replace("3 1 0", "3 9 0"), cut_short),
    "huge.off": (off.replace("3 1 0", "4000000000 1 0"), cut_short),
    "beyond.off": (off.replace("3 0 1 2", "3 0 1 3"), "names vertex 3"),
    "nan.off": (off.replace("1 0 0", "nan 0 0"), not_finite),
    "words.off": (off.replace("3 1 0", "three one"), "found 'three'"),
    "binary.off": (off.replace("OFF", "OFF BINARY"), "binary OFF is not read"),
    "head.off": (off.replace("OFF", "OF"), "expected 'OFF', found 'OF'"),
    "cut.vtk": (vtk[:80], cut_short),
    "more.vtk": (vtk.replace("POINTS 3", "POINTS 5"), "has only 9"),
    "huge.vtk": (vtk.replace("POINTS 3", "POINTS 4000000000"), cut_short),
    "beyond.vtk": (vtk.replace("3 0 1 2", "3 0 1 7"), "names vertex 7"),
    "nan.vtk": (vtk.replace("1 0 0", "nan 0 0"), not_finite),
    "volume.vtk": (vtk.replace("POLYDATA", "STRUCTURED_POINTS"), "only POLYDATA is a surface"),
    "cut.vtp": ('<VTKFile type="PolyData"><PolyData>', cut_short),
    "page.vtp": ("<html/>", "expected 'VTKFile'"),
    "order.vtp": ('<VTKFile type="PolyData" byte_order="MiddleEndian"><PolyData>', "BigEndian, not 'MiddleEndian'"),
    **{f"empty.{kind}": ("", "is empty") for kind in formats},
    **{f"zipped.{kind}": (gzip.compress(stl.encode()), "is compressed; unpack it first") for kind in formats},
    **{f"garbage.{kind}": (garbage, f"garbage.{kind}") for kind in formats},
    **{f"zeros.{kind}": (bytes(1000), f"zeros.{kind}") for kind in formats},
    "part.step": ("ISO-10303-21;", "its extension is none of .stl, .ply, .obj, .off"),
    "no_extension": (stl, "its extension is none of .stl, .ply, .obj, .off"),
    # Not regular files.
    "folder.stl": (None, "is a directory"),
    **{name: (None, "is not a regular file") for name in ("pipe.stl", "/dev/zero", "/dev/full")},
    "loop.stl": (None, "its links lead in a circle"),
    "x" * 300 + ".stl": (None, "cannot be reached (File name too long)"),
}


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    """A folder with all files of the cases. No case may change it."""
    folder = tmp_path_factory.mktemp("world")
    corners = [(x, y, z) for z in (-50, 50) for y in (-50, 50) for x in (-50, 50)]
    triangles = ("0 2 1", "1 2 3", "4 5 6", "5 7 6", "0 1 4", "1 5 4", "2 6 3", "3 6 7", "0 4 2", "2 4 6", "1 3 5", "3 7 5")
    cube = "OFF\n8 12 0\n" + "".join("%d %d %d\n" % c for c in corners) + "".join(f"3 {t}\n" for t in triangles)
    contents = {
        "cube.off": cube, "poses.txt": "0 0 60 1 2 -3\n", "many.txt": 3000 * "0 0 60 1 2 -3\n",
        "far.obj": "".join("v 1e9 1e9 %d\n" % (1e9 + z) for z in range(3)) + "v 1000000001 1e9 1e9\nf 1 2 4\nf 2 3 4\n",
        "line.off": "OFF\n3 2 0\n0 0 0\n50 0 0\n100 0 0\n3 0 1 2\n3 0 2 1\n",  # closed, so that it gets no warning
        "nan.txt": "0 0 60 1 2 -3\n0 0 nan 0 0 0\n", "f.csv": "0,0,0,10,20,30\n0,0,40,10,20,70\n50,0,0,10,70,30\n",
        "broken.stl": stl[:70], "cut.json": '{"keepout_record": "verify", "format"', "old.csv": "precious\n",
        "old.html": "precious\n", "old.json": "precious\n", **{name: content for name, (content, _) in meshes.items() if content is not None}}
    for name, content in contents.items():
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    for name in ("folder", "folder.stl"):
        (folder / name).mkdir()
    os.mkfifo(folder / "pipe.stl")
    for name, to in (("link.off", "cube.off"), ("loop.csv", "loop.csv"), ("loop.stl", "loop.stl")):
        (folder / name).symlink_to(to)
    return folder


def files_in(folder):
    """Returns the content of all files of a folder, and the kind of everything else."""
    return {path.name: path.read_bytes() if path.is_file() and os.access(path, os.R_OK) else path.lstat().st_mode
            for path in sorted(folder.iterdir())}


def run(folder, line, before=""):
    """Runs a command line, as it is typed after 'keepout', and returns the result. `before`: what the shell does first."""
    environment = {**os.environ, "KEEPOUT_WEB": "web", "KEEPOUT_CACHE": "cache", "LC_ALL": "C"}
    began = time.monotonic()
    ended = subprocess.run(["bash", "-c", f'{before} exec "$KEEPOUT_COMMAND" {line}'], cwd=folder, env=environment,
                           stdin=subprocess.DEVNULL, capture_output=True, timeout=patience)
    assert time.monotonic() - began < patience
    ended.stdout, ended.stderr = (text.decode(errors="surrogateescape") for text in (ended.stdout, ended.stderr))
    return ended


def judge(folder, line, status, says, before=""):
    """Fails unless the command rejects a line with this status and these texts, and changes no file. Returns the message."""
    kept = files_in(folder)
    ended = run(folder, line, before)
    text = ended.stderr
    assert ended.returncode == status, (ended.returncode, text)
    assert text.startswith("keepout: ") and text.count("keepout: ") == 1, text
    for word in ("unexpected: ", "terminate", "Traceback", "runtime error", "Sanitizer", "what()", str(root), str(Path(keepout).parent)):
        assert word not in text, text
    lines = text.splitlines()
    assert len(lines) == (2 if status == 2 else 1), text
    assert status != 2 or re.fullmatch(r"See 'keepout( \w+)? --help'\.", lines[1]), text
    for word in says:
        assert word in text, text
    assert files_in(folder) == kept
    return text


def is_of_bench(line):
    return line.split(" ")[0] in ("bench", "compare", "plan")


def needs_bench(line):
    if is_of_bench(line) and is_sanitized:
        pytest.skip("OMPL is not built under sanitizers")


@pytest.mark.parametrize("line, says", wrong_lines)
def test_a_wrong_command_line_is_told_with_the_option_and_the_remedy(world, line, says):
    needs_bench(line)
    text = judge(world, line, 2, [says])
    assert text.startswith(f"keepout: {says}"), text
    assert run(world, line).stdout == ""


@pytest.mark.parametrize("line, says", [(line, says) for line, *says in files])
def test_files_that_cannot_be_read_or_written_are_named(world, line, says):
    needs_bench(line)
    before = says.pop() if says[-1].startswith("ulimit") else ""
    if is_sanitized and before:
        pytest.skip("the limit holds for the files of the sanitizers too")
    judge(world, line, 1, says, before)


@pytest.mark.parametrize("name, says", [(name, says) for name, (_, says) in meshes.items()], ids=lambda text: text[-30:])
def test_a_broken_mesh_is_named_and_leaves_an_earlier_result_as_it_was(world, name, says):
    judge(world, f"replay {name} --poses poses.txt --out old.csv", 1, [f"{name}: ", says])


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read and write everything")
def test_files_without_permission_are_named(world):
    for name in ("locked.off", "locked.csv"):
        (world / name).write_text(off)
        (world / name).chmod(0)
    (world / "locked").mkdir(mode=0o500)
    (world / "shut").mkdir(mode=0)
    try:
        judge(world, "inspect shut/cube.off", 1, ["shut/cube.off: cannot be reached (Permission denied)"])
        judge(world, "inspect locked.off", 1, ["locked.off: "])
        judge(world, "register locked.csv", 1, ["locked.csv: cannot be read"])
        judge(world, "replay cube.off --poses poses.txt --out locked/s.csv", 1, ["locked/s.csv: cannot write here"])
    finally:
        (world / "locked").rmdir()
        (world / "shut").rmdir()
        for name in ("locked.off", "locked.csv"):
            (world / name).unlink()


@pytest.mark.parametrize("command", ["inspect", "simulate", "verify --steps 10", "serve", "compare", "plan", "bench --mesh",
                                     "simulate --robot psm", "verify --scenario approach --cycles 10"])
def test_every_command_names_a_broken_mesh(world, command):
    needs_bench(command)
    out = "" if command in ("inspect", "serve") else "--json old.json"
    judge(world, f"{command} broken.stl {out}", 1, ["broken.stl: line 6: ", cut_short])


@pytest.mark.skipif(is_sanitized, reason="the commands of keepout-bench are not built under sanitizers")
@pytest.mark.parametrize("command", ["compare meters.off --poses 6 --problems 10 --pairs 10",
                                     "bench --mesh meters.off --index wide_bvh --radius 1 --queries 20 --seconds 0.1"])
def test_a_mesh_in_meters_is_scaled_on_request(world, tmp_path, command):
    cube = (world / "cube.off").read_text()
    (tmp_path / "meters.off").write_text(cube.replace("50", "0.05"))
    done = run(tmp_path, f"{command} --unit m --out r.html")
    assert done.returncode == 0, done.stderr
    assert "meters.off: scaled by 1000, from m to mm" in done.stderr


def test_a_closed_stdout_does_not_end_up_in_a_result(tmp_path):
    for closed in (">&-", ">&- 2>&-", "<&- >&- 2>&-"):
        assert run(tmp_path, f"{simulate} --json r.json --out r.html {closed}").returncode == 1
        assert json.loads((tmp_path / "r.json").read_text())["keepout_record"] == "simulate"
        assert (tmp_path / "r.html").read_text().rstrip().endswith("</html>")
        assert sorted(path.name for path in tmp_path.iterdir()) == ["r.html", "r.json"]


# Requests to `keepout serve`.
psm = (root / "fixtures/robots/psm.urdf").read_text()
capsules = '"capsules":[[5,9.1,0,0,6,0,10.2,0,1]]'
identity = "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"
far_away = "[[1,0,0,0],[0,1,0,0],[0,0,1,900],[0,0,0,1]]"
doubled = "[[2,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"


def psm_with(pattern, text):
    changed = re.sub(pattern, text, psm, count=1)
    assert changed != psm, pattern
    return changed


# name: content, and what the message contains beside the name
robots = {
    "empty": ("", "it is empty"),
    "cut": (psm[:len(psm) // 2], "not XML"),
    "words": ("robot", "not XML"),
    "zeros": (bytes(100), "not XML"),
    "garbage": (garbage, "not XML"),
    "page": ("<html/>", "<robot>"),
    "no_links": ('<robot name="a"/>', "No link"),
    "xacro": ('<robot name="a"><xacro:macro name="m"/></robot>', "expand it first: xacro FILE > robot.urdf"),
    "xacro_in_numbers": (psm_with('<robot', '<robot xmlns:xacro="http://ros.org/wiki/xacro"').replace(
        'velocity="', 'velocity="${2}'), "expand it first: xacro FILE > robot.urdf"),
    "speed": (psm_with(r'velocity="[^"]*"', 'velocity="0"'), "velocity limit"),
    "limits": (psm_with(r'lower="[^"]*"', 'lower="9e9"'), "lower above upper"),
    "nan": (psm_with(r'xyz="[^"]*"', 'xyz="nan 0 0"'), "[nan]"),
    "words_as_numbers": (psm_with(r'xyz="[^"]*"', 'xyz="a b c"'), "[a]"),
    "axis": (psm_with(r'<axis xyz="[^"]*"', '<axis xyz="0 0 0"'), "zero axis"),
    "floating": (psm_with('type="revolute"', 'type="floating"'), "is floating"),
    "parent": (psm_with(r'<parent link="[^"]*"', '<parent link="nowhere"'), "[nowhere]"),
    "twice": (re.sub(r'<joint name="[^"]*"', '<joint name="a"', psm), "two joints are called 'a'"),
    "deep": (5000 * "<a>", "nested too deep"),
    "entities": ('<!DOCTYPE r [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><robot name="&b;"/>', "not XML"),
}


def instrument(more, bodies=capsules):
    return '{"do":"instrument","urdf":"psm.urdf",%s%s}' % (more + "," if more else "", bodies)


def body(numbers):
    return instrument("", f'"capsules":[[{numbers}]]')


def asked(do, more):
    return '{"do":"%s",%s}' % (do, more)


# Requests, the kind of the error, and texts of its message. tests/apps/serve/client_test.cpp has requests of other shapes.
not_a_request = "not_a_request"
requests = [
    *((asked("instrument", f'"urdf":"{name}.urdf",{capsules}'), "no_instrument", f"{name}.urdf: ", says)
      for name, (_, says) in robots.items()),
    *((asked("instrument", f'"urdf":"{name}",{capsules}'), "no_instrument", "'urdf' must name a file", f"'{name}'")
      for name in ("none.urdf", ".", "", "/dev/zero")),
    (instrument('"tip_link":"tol0"'), "no_instrument", "there is no link 'tol0'"),
    (instrument('"base_link":"tip","tip_link":"base"'), "no_instrument", "link 'base' is not below 'tip'"),
    (instrument('"scale":-1'), "no_instrument", "the scale must be finite and above zero, not -1"),
    (instrument('"margin":-1'), "no_instrument", "margin: expected a number from 1e-15 to 1e15, got -1"),
    (instrument('"band":5'), "no_instrument", "band: expected less than the margin of each mesh", "got 5"),
    (instrument('"period":0'), "no_instrument", "period: expected a number above 0 and at most 1e9, got 0"),
    (instrument('"certified":"actul"'), "no_instrument", "certified: expected 'actual' or 'linearized', got 'actul'"),
    (instrument('"refinements":-1'), "no_instrument", "refinements: expected a whole number from 0", "got -1"),
    (instrument(f'"frame":{doubled}'), "no_instrument", "the base of the chain is not a pose"),
    (instrument('"frame":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,1,1]]'), "no_instrument", "last row of 'frame'"),
    (instrument("", '"capsules":[]'), not_a_request, "'capsules' must be", "at least one, and at most 16"),
    (instrument('"index":"wide_bhv"'), "no_instrument", "there is no", "wide_bhv"),
    (instrument('"solver":"activeset"'), "no_instrument", "there is no", "activeset"),
    (body("9,0,0,0,6,0,0,0,1"), "no_instrument", "a link of 'capsules' must be a number from 0", "not 9"),
    (body("1.5,0,0,0,6,0,0,0,1"), "no_instrument", "not 1.5"),
    (body("5,0,0,0,6,0,0,0,-1"), "no_instrument", "the radius of body 1 must be a length", "not -1"),
    (body("5,1e300,0,0,6,0,0,0,1"), "no_instrument", "body 1 has a point that is not finite, or too far away"),
    (asked("joint_step", '"q":[0,0,60,0,0,0],"increment":[1,2]'), not_a_request, "'increment' must have 6 numbers"),
    (asked("joint_step", '"q":[0],"increment":[0,0,0,0,0,0]'), not_a_request, "'q' must have 6 numbers"),
    (asked("tool", '"tool":"sphere"'), "no_tool", "the tool 'sphere': '' is not a number; write sphere:R"),
    (asked("tool", '"tool":"ball:1"'), "no_tool", "there is no such form"),
    (asked("tool", '"tool":"sphere:nan"'), "no_tool", "'nan' is not a number"),
    (asked("tool", '"tool":"hull:broken.stl"'), "no_tool", "broken.stl: line 6: "),
    (asked("tool", '"tool":"sphere:1","narrow_phase":"exat"'), "no_tool", "did you mean 'exact'?"),
    (asked("guides", '"guides":["ball:0,0,0"]'), "no_guide", "the guide 'ball:0,0,0': 'ball' has too few or too many fields"),
    (asked("guides", '"guides":["tube:0,0,0:1,0,0:-1"]'), "no_guide", "radius: expected a number from 1e-15 to 1e15, got -1"),
    (asked("guides", '"guides":["slab:0,0,0:0,0,0:1"]'), "no_guide", "has no length"),
    (asked("guides", '"guides":["point:6:0,0,0:ball:0,0,0:1"]'), "no_guide", "link"),
    (asked("guides", '"guides":[""]'), "no_guide", "its name is empty"),
    (asked("guides", '"guides":[%s]' % ",".join(17 * ['"ball:0,0,0:1"'])), not_a_request, "'guides' must be", "at most 16"),
    (asked("anatomy", '"file":"none.stl"'), "no_anatomy", "'file' must name a file", "'none.stl'"),
    (asked("anatomy", '"file":"/dev/zero"'), "no_anatomy", "'file' must name a file"),
    (asked("anatomy", '"file":"broken.stl"'), "no_anatomy", "broken.stl: line 6: "),
    (asked("anatomy", '"file":"cube.off","margin":-1'), "no_anatomy", "margin: expected", "got -1"),
    (asked("place", f'"mesh":7,"frame":{identity}'), "no_anatomy", "'mesh' must be the number of a mesh, 0 to 0, not 7"),
    (asked("place", f'"mesh":0.5,"frame":{identity}'), "no_anatomy", "not 0.5"),
    (asked("place", f'"mesh":0,"frame":{doubled}'), "no_anatomy", "'frame', 'linear' or 'angular' is implausible"),
    # Lines that are not requests.
    ("nonsense", "not_json", "the line is not JSON"),
    ('{"do":"step","tip":[0,0,NaN],"desired":[0,0,0]}', "not_json", "column"),
    ('{"do":"step","tip":[0,0,60],"tip":[0,0,61],"desired":[0,0,0]}', not_a_request, "'tip' is given twice"),
    ('{"do":"ping","tpi":1}', not_a_request, "there is no key 'tpi'"),
    ('{"do":"pnig"}', not_a_request, "'pnig'"),
    ('{"do":"step","tip":[0,0],"desired":[0,0,0]}', not_a_request, "'tip' must be an array of three numbers"),
    ('{"do":"step"', "not_json", "column"),
    (100_000 * "[", not_a_request, "nested more deeply"),
    ('{"do":"ping","id":"' + 300_000 * "x" + '"}', "line_too_long", "more than 262144 bytes"),
    (garbage.replace(b"\n", b"").replace(b"\r", b"").decode("latin-1"), "not_json", "the line is not JSON"),
]
# Requests that can be carried out, and members of their answers.
zero = 'q":[0,0,60,0,0,0]'
answered = [
    (instrument(f'"index":"pd_tree","solver":"active_set","frame":{far_away}'), {"ok": True}),
    (asked("place", f'"mesh":0,"frame":{identity}'), {"ok": True}),  # the last one was refused
    (asked("joint_step", f'"{zero},"increment":[1e300,0,0,0,0,0]'), {"ok": False, "status": "invalid_input"}),
    (asked("joint_step", f'"{zero},"increment":[0,0,0,0,0,0],"weights":[0,1,1,1,1,1]'), {"ok": False, "status": "invalid_input"}),
    # Far from the mesh, a joint limits the motion, and not the mesh.
    (asked("joint_step", f'"{zero},"increment":[1,1,1,1,1,1]'), {"status": "limited", "limits": ["joint_velocity"]}),
    (asked("joint_step", f'"{zero},"linear":[50,0,0]'), {"status": "limited", "limits": ["joint_velocity"]}),
    (asked("joint_step", '"q":[9,9,9,9,9,9],"increment":[0,0,0,0,0,0]'), {"status": "free", "limits": ["joints_outside"]}),
    (asked("step", '"tip":[0,0,1e300],"desired":[0,0,1]'), {"ok": False, "status": "invalid_input", "motion": [0, 0, 0]}),
    (asked("step", '"tip":[0,0,60],"desired":[0,0,99]'), {"ok": False, "status": "beyond_reach", "motion": [0, 0, 0]}),
]


def test_bad_requests_are_answered_once_each_and_end_nothing(world):
    for name, (content, _) in robots.items():
        (world / f"{name}.urdf").write_bytes(content if isinstance(content, bytes) else content.encode())
    (world / "psm.urdf").write_text(psm)
    kept = files_in(world)
    far = instrument(f'"frame":{far_away}')
    lines = [far, *(line for line, *_ in requests), *(line for line, _ in answered), '{"id":7,"do":"ping"}']
    ended = subprocess.run([keepout, "serve", "cube.off"], cwd=world, input="\n".join(lines).encode("latin-1"),
                           capture_output=True, timeout=3 * patience)
    assert ended.returncode == 0, ended.stderr
    assert ended.stderr.count(b"\n") == 1, ended.stderr
    answers = [json.loads(answer) for answer in ended.stdout.decode().splitlines()]
    assert len(answers) == len(lines)
    assert answers[0].get("ok") and answers[-1] == {"id": 7, "ok": True}
    wrong = []
    for (line, kind, *says), answer in zip(requests, answers[1:]):
        error = answer.get("error", {"kind": None, "message": json.dumps(answer)})
        is_right = error["kind"] == kind and all(word in error["message"] for word in says)
        if not is_right or len(error["message"]) > 400 or "unexpected: " in error["message"] or str(root) in error["message"]:
            wrong.append((line[:100], error))
    for (line, members), answer in zip(answered, answers[1 + len(requests):]):
        if {name: answer.get(name) for name in members} != members:
            wrong.append((line[:100], answer))
    assert not wrong
    assert files_in(world) == kept
