# SPDX-License-Identifier: BSD-3-Clause
"""'keepout serve', as other programs use it: a process at the end of a pipe or a socket."""

import csv
import fnmatch
import json
import os
import random
import signal
import socket
import stat
import subprocess
import time
from pathlib import Path

import pytest

keepout = os.environ["KEEPOUT_COMMAND"]
root = Path(__file__).parents[3]
# The sanitizers keep freed memory for a while.
memory_is_plain = not os.environ.get("KEEPOUT_SANITIZE")
patience = 120  # for an action of the server on a busy machine [s]

ping = '{"id":1,"do":"ping"}\n'
pong = '{"id":1,"ok":true}\n'
corners = [(x, y, z) for z in (-50, 50) for y in (-50, 50) for x in (-50, 50)]
triangles = ["0 2 1", "1 2 3", "4 5 6", "5 7 6", "0 1 4", "1 5 4", "2 6 3", "3 6 7", "0 4 2", "2 4 6", "1 3 5", "3 7 5"]
cube = "OFF\n8 12 0\n" + "".join("%d %d %d\n" % c for c in corners) + "".join(f"3 {t}\n" for t in triangles)


class Talk:
    """One end of a conversation: files, or both ends of a socket."""

    def __init__(self, source, sink):
        self.source, self.sink = source, sink

    def send(self, text):
        self.sink.write(text.encode())
        self.sink.flush()

    def line(self):
        """Returns the next line that arrives; "" at the end."""
        return self.source.readline().decode()

    def ask(self, text):
        self.send(text)
        return self.line()


class Servers:
    """Starts servers in a folder; their messages to people go into the file "log"."""

    def __init__(self, folder):
        self.folder, self.process, self.sockets = folder, None, []

    def start(self, *options, mesh="cube.off"):
        with open(self.folder / "log", "w") as log:
            self.process = subprocess.Popen([keepout, "serve", mesh, *options], cwd=self.folder, stderr=log,
                                            stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        return Talk(self.process.stdout, self.process.stdin)

    def connected(self):
        """Returns a socket connected to the server at "s", as soon as the server listens."""
        while True:
            self.sockets.append(socket.socket(socket.AF_UNIX))
            try:
                self.sockets[-1].connect(str(self.folder / "s"))
                return self.sockets[-1]
            except (FileNotFoundError, ConnectionRefusedError):
                time.sleep(0.01)

    def connect(self):
        files = self.connected().makefile("rwb", buffering=0)
        return Talk(files, files)

    def end(self, number=None):
        """Sends a signal, if one is given. Returns the exit status, or minus the signal that ended the server."""
        if number:
            self.process.send_signal(number)
        return self.process.wait()

    def run(self, arguments):
        """Returns the exit status and the output of a command line."""
        ended = subprocess.run(f"'{keepout}' {arguments}", shell=True, cwd=self.folder, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        return ended.returncode, ended.stdout

    def resident(self):
        """Returns the memory that the server occupies. [KiB]"""
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(status.split("VmRSS:")[1].split()[0])


@pytest.fixture
def servers(tmp_path):
    def give_up(*_):
        raise TimeoutError("the server does not answer")

    signal.signal(signal.SIGALRM, give_up)
    signal.alarm(patience)
    (tmp_path / "cube.off").write_text(cube)
    servers = Servers(tmp_path)
    yield servers
    signal.alarm(0)
    if servers.process:
        servers.process.kill()
        servers.process.wait()
    for client in servers.sockets:
        client.close()


def test_a_pipe_is_served_until_it_ends(servers):
    talk = servers.start()
    assert talk.ask(ping) == pong
    assert talk.ask('{"id":2,"do":"step","tip":[0,0,60],"desired":[0,0,-0.5]}\n') == (
        '{"id":2,"ok":true,"status":"free","motion":[0,0,-0.5],"triangles":0,"planes":0,"distance":10}\n')
    assert "not_json" in talk.ask("nonsense\n")
    assert talk.ask("\r\n\n  \n" + ping.replace("\n", "\r\n") + ping[:-1]) == pong
    talk.sink.close()
    assert talk.line() == pong  # the last line, which has no line end
    assert talk.line() == ""
    assert servers.end() == 0
    assert "keepout: serving cube.off (12 triangles) on stdin and stdout" in (servers.folder / "log").read_text()


def test_a_line_too_long_is_skipped_to_its_end(servers):
    talk = servers.start("--max-line", "256")
    assert "line_too_long" in talk.ask("[" * 1_000_000 + "\n" + ping)
    assert talk.line() == pong


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_signals_end_it_cleanly(servers, number):
    assert servers.start().ask(ping) == pong
    assert servers.end(number) == 0
    servers.start("--socket", "s")
    assert servers.connect().ask(ping) == pong
    assert servers.end(number) == 0
    assert not (servers.folder / "s").exists()


def test_a_reader_who_has_gone_ends_it(servers):
    talk = servers.start()
    assert talk.ask(ping) == pong
    talk.source.close()
    assert servers.end() == 0  # although it had nothing to send


def test_a_client_who_never_reads_holds_up_himself_alone(servers):
    servers.start("--socket", "s")
    greedy = servers.connected()
    greedy.setblocking(False)
    other = servers.connect()

    def flood():
        for _ in range(200):
            try:
                greedy.send(b'{"do":"statuses"}\n' * 1000)
            except BlockingIOError:
                pass
            assert other.ask(ping) == pong

    flood()
    before = servers.resident()
    flood()
    assert servers.resident() < before + 512 or not memory_is_plain
    assert servers.end(signal.SIGTERM) == 0


def test_clients_come_and_go_as_they_like(servers):
    servers.start("--socket", "s", "--max-clients", "3")
    talks = [servers.connect() for _ in range(3)]
    assert stat.S_IMODE((servers.folder / "s").stat().st_mode) == 0o600
    assert [talk.ask(ping) for talk in talks] == 3 * [pong]
    fourth = servers.connect()
    assert "too_many_clients" in fourth.line()
    assert fourth.line() == ""
    talks[1].send('{"id":5')  # and disconnects
    for client in servers.sockets[-3:-1]:
        client.shutdown(socket.SHUT_RDWR)
    for _ in range(200):
        # A client that sends a request and disconnects at once may still count when the next one connects.
        with servers.connected() as hasty:
            try:
                hasty.sendall(2 * ping.encode())
            except BrokenPipeError:
                pass
    assert talks[0].ask(ping) == pong

    def answered():
        try:
            return servers.connect().ask(ping)
        except ConnectionError:
            return ""

    assert any(answered() == pong for _ in range(1000))
    half = servers.connect()
    assert half.ask(ping) == pong
    half.send(ping + ping[:-1])
    servers.sockets[-1].shutdown(socket.SHUT_WR)
    assert [half.line(), half.line(), half.line()] == [pong, pong, ""]
    assert servers.end(signal.SIGTERM) == 0


def test_a_socket_that_is_left_behind_is_replaced_and_a_live_one_is_not(servers):
    servers.start("--socket", "s")
    assert servers.connect().ask(ping) == pong
    status, words = servers.run("serve cube.off --socket s < /dev/null")
    assert status == 1 and "another server answers there" in words
    assert servers.connect().ask(ping) == pong
    assert servers.end(signal.SIGKILL) == -signal.SIGKILL
    assert (servers.folder / "s").exists()
    servers.start("--socket", "s")
    assert servers.connect().ask(ping) == pong
    # A file that has replaced the socket stays.
    (servers.folder / "s").unlink()
    (servers.folder / "s").write_text("mine")
    assert servers.end(signal.SIGTERM) == 0
    assert (servers.folder / "s").exists()


@pytest.mark.parametrize("path, words", [
    ("cube.off", "something else than a socket is there"),
    (".", "something else than a socket is there"),
    ("no/such/s", "its folder no/such cannot be used"),
    (108 * "x", "the path has 108 bytes; a Unix socket's has at most 107")])
def test_where_no_socket_can_be_it_says_so(servers, path, words):
    status, output = servers.run(f"serve cube.off --socket {path}")
    assert status == 1 and words in output
    assert (servers.folder / "cube.off").read_text() == cube


def test_without_stdin_or_stdout_it_says_so(servers):
    assert "stdin or stdout is closed" in servers.run("serve cube.off <&-")[1]
    status, words = servers.run("serve cube.off < .")
    assert status == 1 and "stdin: Is a directory" in words
    (servers.folder / "in").write_text(ping)
    status, words = servers.run("serve cube.off < in")
    assert status == 0 and words.endswith("\n" + pong)
    assert servers.run("serve cube.off < in > /dev/full")[0] == 1


def test_its_answers_are_those_of_replay_bit_for_bit(servers):
    talk = servers.start("--radius", "1", mesh="cortex")
    draw = random.Random(5)

    def direction():
        point = [draw.gauss(0, 1) for _ in range(3)]
        return [x / sum(y * y for y in point) ** 0.5 for x in point]

    motions = []
    for _ in range(100):  # from far away to the surface, and along it
        inwards = direction()
        tip = [-100 * x for x in inwards]
        status = "free"
        while status == "free":
            step = json.loads(talk.ask(json.dumps(
                {"do": "step", "tip": tip, "desired": [0.9 * x for x in inwards]}) + "\n"))
            tip = [x + dx for x, dx in zip(tip, step["motion"])]
            status = step["status"]
        motions += [tip + [0.9 * x for x in direction()] for _ in range(5)]
    (servers.folder / "poses").write_text("".join(" ".join(map(repr, m)) + "\n" for m in motions))
    assert servers.run("replay cortex --poses poses --out steps.csv --radius 1")[0] == 0
    steps = json.loads(talk.ask(json.dumps({"do": "steps", "motions": motions}) + "\n"))["steps"]
    limited = 0
    with open(servers.folder / "steps.csv") as table:
        for step, row in zip(steps, csv.DictReader(table), strict=True):
            is_limited = row["status"] == "limited" or (row["status"] == "recovering" and row["planes"] != "0")
            numbers = [*step["motion"], step["distance"]]
            expected = [float(row[name]) for name in ("ux", "uy", "uz", "distance")]
            assert [float(x).hex() for x in numbers] == [x.hex() for x in expected]
            assert step == {"ok": True, "status": row["status"], **({"limits": ["mesh"]} if is_limited else {}),
                            "motion": step["motion"], "triangles": int(row["triangles"]),
                            "planes": int(row["planes"]), "distance": step["distance"]}
            limited += row["status"] == "limited"
    assert limited > 100


@pytest.mark.skipif(not memory_is_plain, reason="not under sanitizers")
def test_its_memory_does_not_grow_with_what_it_is_asked(servers):
    talk = servers.start()
    lines = ['{"id":2,"do":"step","tip":[0,0,50.4],"desired":[0.1,0,-0.5]}\n',
             '{"id":"three","do":"polytope","tip":[0,0,50.4],"radius":2}\n',
             '{"id":4,"do":"steps","motions":[[0,0,60,0,0,-0.5],[0,0,50.4,0,0,-0.5]]}\n',
             '{"id":5,"do":"step","tip":[0,0,NaN]}\n', '{"id":6,"do":"step","tip":[0,0,1],"tip":2}\n']

    def ask(times):
        for _ in range(times // (10 * len(lines))):
            talk.send(10 * "".join(lines))
            for _ in range(10 * len(lines)):
                assert len(talk.line()) > 10

    ask(10_000)
    early = servers.resident()
    ask(100_000)
    assert servers.resident() - early < 64  # less than a byte for each request


@pytest.mark.parametrize("client", ["python3 python/serve_client.py", "./serve_client.sh"])
def test_the_clients_on_the_page_are_answered(servers, client):
    text = subprocess.run([*client.split(), keepout, servers.folder / "cube.off"], cwd=root / "examples", check=True,
                          stdout=subprocess.PIPE, text=True).stdout
    if "python" in client:  # it stops at the margin
        words = text.split()
        assert words[:2] == ["limited", "at"]
        assert float(words[4]) == pytest.approx(50.5, abs=1e-3)
    else:
        assert text.startswith(pong + '{"id":2,"ok":true')
        assert "'desired' is missing" in text


def test_the_dialogue_on_the_page_is_what_the_command_answers(servers):
    _, _, dialogue = (root / "docs/serve.md").read_text().partition("    $ keepout serve cube\n")
    lines = dialogue.partition("\n\n")[0].splitlines()
    talk = servers.start(mesh="cube")
    assert len(lines) >= 8
    for request, printed in zip(lines[0::2], lines[1::2], strict=True):
        # "..." on the page stands for text that it omits; brackets are literal.
        pattern = printed.strip().replace("[", "[[]").replace("...", "*")
        assert fnmatch.fnmatchcase(talk.ask(request + "\n").strip(), pattern), printed
