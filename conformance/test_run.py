# SPDX-License-Identifier: Apache-2.0
"""The runner, tested with testees that are wrong in different ways and with suites that are damaged."""
from __future__ import annotations

import contextlib
import hashlib
import io
import json
import random
import shlex
import struct
import sys
import tempfile
import unittest
import zlib
from pathlib import Path
from typing import Optional
from unittest import mock

import decoder
import differential
import run
from client import Device
from conventions import StreamError
from datagram import STATE
from scene import MAGIC, VERSION, Limits, read_declaration
from session import Epoch
from session_server import ServedEpoch

HERE = Path(__file__).resolve().parent


def with_crc(data: bytes) -> bytes:
    return data + struct.pack("<I", zlib.crc32(data))


# An empty scene: 1000 ticks/s, no object, no record. Its state hash is that of no bytes.
BODY = struct.pack("<IBBBBHBB", 1000, 22, 17, 19, 12, 2000, 1, 0)
VALID = with_crc(MAGIC + struct.pack("<BBHI", VERSION, 0, 0, len(BODY)) + BODY)
HEADER_LINE = ('{"header":{"version":2,"profile":0,"tick_rate":1000,"grid":[22,17,19,12],"max_extrapolation":2000,'
               '"baseline_span":1,"objects":[]}}\n')
VALID_REPLY = HEADER_LINE + '{"end":{"complete":false,"packets":0,"state":"cbf29ce484222325"}}\n'
WITH_FLAG = VALID[:7] + b"\x80" + VALID[8:]  # the last that would get a meaning
WITH_UNKNOWN_RECORD = VALID + with_crc(b"\x05\x00")


def mesh_scene(profile: int, parameters: bytes, rest: bytes) -> bytes:
    """The scene with one deformable object of one vertex: `parameters` follow its rings, `rest` its last rest position."""
    body = BODY + bytes([1, profile, 1]) + b"m\0" + parameters + b"\x01\0\0\0\0" + rest
    return with_crc(MAGIC + struct.pack("<BBHI", VERSION, 0, 1, len(body)) + body)


THESIS_SCENE = mesh_scene(0, b"\x08\0", b"")
MAIN_SCENE = mesh_scene(1, struct.pack("<IBHB", 256, 0, 0, 1), b"\0")


class RunnerTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.vectors = self.root / "vectors"
        self.vectors.mkdir()
        self.cases = [self.case("001-empty", VALID, VALID_REPLY), self.case("002-flag", WITH_FLAG, "", "malformed", "R-STR-4"),
                      self.case("003-record", WITH_UNKNOWN_RECORD, HEADER_LINE, "unsupported", "R-FIL-3")]
        self.write_lists(self.cases)

    def case(self, name: str, data: bytes, reply: str, errc: str = "", rule: str = "") -> dict:
        """Adds a case to the pack and the answers, and returns what the stem's list says of it."""
        if errc:
            reply += json.dumps({"error": {"errc": errc, "rule": rule}}, separators=(",", ":")) + "\n"
        fields = {"name": name, "result": "valid", "profile": [], "flags": [], "sha256": hashlib.sha256(data).hexdigest(),
                "input": self.append(".pack", data), "answer": self.append(".answers", reply.encode("ascii"))}
        return {**fields, "result": "invalid", "errc": errc, "rule": rule} if errc else fields

    def append(self, suffix: str, data: bytes) -> list[int]:
        with open(self.vectors / f"scene{suffix}", "ab") as file:
            extent = [file.tell(), len(data)]
            file.write(data)
        return extent

    def write_lists(self, cases: list[dict], of_list: dict = {}, of_manifest: dict = {}) -> None:
        content = json.dumps({**of_list, "cases": cases}).encode("ascii")
        (self.root / "vectors" / "scene.json").write_bytes(content)
        stems = {"scene": {"cases": len(cases), "sha256": hashlib.sha256(content).hexdigest()}} if cases else {}
        (self.root / "manifest.json").write_text(json.dumps({**of_manifest, "stems": stems}), "ascii")

    def run_main(self, *arguments: str) -> tuple[int, str, str]:
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            status = run.main(list(arguments), self.root)
        return status, out.getvalue(), err.getvalue()

    def expect(self, status: int, counts: str, *arguments: str) -> str:
        """Runs the suite, checks exit status and last line, returns what was printed."""
        actual, out, _ = self.run_main(*arguments)
        self.assertEqual((actual, out.splitlines()[-1]), (status, counts), out)
        return out

    def command(self, program: str) -> str:
        """The command line of a testee written in Python."""
        file = self.root / "testee.py"
        file.write_text(program, "utf-8")
        return shlex.join([sys.executable, str(file)])

    # ---- testees ----

    def test_second_decoder_passes(self) -> None:
        self.expect(0, "3 passed, 0 failed, 0 skipped")

    def test_accept_all(self) -> None:
        testee = self.command(f"print({VALID_REPLY!r}, end='')")
        self.expect(1, "1 passed, 2 failed, 0 skipped", "--testee", testee)

    def test_reject_all(self) -> None:
        testee = self.command("""print('{"error":{"errc":"malformed","rule":"R-STR-4"}}'); raise SystemExit(1)""")
        self.expect(1, "1 passed, 2 failed, 0 skipped", "--testee", testee)

    def test_rejection_with_the_wrong_status(self) -> None:
        testee = self.command("""print('{"error":{"errc":"malformed","rule":"R-STR-4"}}')""")
        out = self.expect(1, "0 passed, 1 failed, 0 skipped", "--testee", testee, "--only", "*/002-*")
        self.assertIn("accepted", out)

    def test_bit_flipper(self) -> None:
        testee = self.command(f"""
import subprocess, sys
reply = subprocess.run([sys.executable, {str(HERE / "decoder.py")!r}], stdin=sys.stdin, stdout=subprocess.PIPE)
digit = reply.stdout.rfind(b'"}}') - 1
sys.stdout.write(reply.stdout[:digit].decode() + chr(reply.stdout[digit] ^ 1) + reply.stdout[digit + 1:].decode())
sys.exit(reply.returncode)""")
        self.expect(1, "0 passed, 3 failed, 0 skipped", "--testee", testee)

    def test_program_that_only_prints_its_usage(self) -> None:
        out = self.expect(1, "0 passed, 1 failed, 0 skipped", "--testee", self.command("raise SystemExit(1)"), "--only", "*/001-*")
        self.assertIn("rejected with exit status 1 and no line of JSON; must be accepted", out)

    def test_lines_before_an_error_count(self) -> None:
        testee = self.command("""print('{"error":{"errc":"unsupported","rule":"R-FIL-3"}}'); raise SystemExit(1)""")
        out = self.expect(1, "0 passed, 1 failed, 0 skipped", "--testee", testee, "--only", "*/003-*")
        self.assertIn("0 lines; must be 1", out)

    def test_long_lines_are_shown_about_their_first_difference(self) -> None:
        long = '{"header":{"name":"' + "x" * 5000 + '"}}'
        _, out, _ = self.run_main("--testee", self.command(f"print({long!r})"), "--only", "*/001-*")
        self.assertIn("FAIL scene/001-", out)
        self.assertLess(max(map(len, out.splitlines())), 200)
        with self.assertRaisesRegex(run.Mismatch, "character 4001:\n  is      [.]{3}x+ax+[.]{3}\n  must be [.]{3}x+bx+[.]{3}"), \
                mock.patch.object(run, "expected_lines", lambda case: ["x" * 4000 + "b" + "x" * 4000]):
            run.check_reply(mock.Mock(error=None), 0, ["x" * 4000 + "a" + "x" * 4000])

    def test_one_line_too_many(self) -> None:
        testee = self.command(f"print({VALID_REPLY!r} + '{{}}')")
        self.expect(1, "0 passed, 1 failed, 0 skipped", "--testee", testee, "--only", "*/001-*")

    def test_hanger(self) -> None:
        testee = self.command("import time\nwhile True: time.sleep(60)")
        with mock.patch.object(run, "TIMEOUT", 0.5):
            out = self.expect(1, "0 passed, 3 failed, 0 skipped", "--testee", testee)
        self.assertEqual(out.count("crash: no end within 0.5 s"), 3)

    def test_hanger_that_closed_its_output(self) -> None:
        testee = self.command("import os, time\nos.close(1)\nwhile True: time.sleep(60)")
        with mock.patch.object(run, "TIMEOUT", 0.5):
            self.expect(1, "0 passed, 1 failed, 0 skipped", "--testee", testee, "--only", "*/001-*")

    def test_hanger_in_a_child(self) -> None:
        testee = "sh -c 'sleep 600 & wait'"
        with mock.patch.object(run, "TIMEOUT", 0.5):
            self.expect(1, "0 passed, 1 failed, 0 skipped", "--testee", testee, "--only", "*/001-*")

    def test_crasher(self) -> None:
        testee = self.command("import os, signal\nos.kill(os.getpid(), signal.SIGKILL)")
        out = self.expect(1, "0 passed, 3 failed, 0 skipped", "--testee", testee)
        self.assertEqual(out.count("crash: signal 9"), 3)

    def test_unknown_status(self) -> None:
        testee = self.command(f"print({VALID_REPLY!r}, end='')\nraise SystemExit(3)")
        out = self.expect(1, "0 passed, 3 failed, 0 skipped", "--testee", testee)
        self.assertEqual(out.count("crash: exit status 3"), 3)

    def test_printers_of_garbage(self) -> None:
        for garbage in (r"b'\xff\x00garbage\n'", "b'{}'", "b'[]\\n'", "b'{\\n'", "b'[' * 100000 + b'\\n'"):
            with self.subTest(garbage):
                testee = self.command(f"import os\nos.write(1, {garbage})")
                out = self.expect(1, "0 passed, 1 failed, 0 skipped", "--testee", testee, "--only", "*/001-*")
                self.assertIn("crash: output is not JSON lines", out)

    def test_endless_printer(self) -> None:
        testee = self.command("while True: print('{}')")
        with mock.patch.object(run, "LARGEST_OUTPUT", 100000):
            out = self.expect(1, "0 passed, 1 failed, 0 skipped", "--testee", testee, "--only", "*/001-*")
        self.assertIn("more than 100000 bytes", out)

    def test_testee_that_does_not_exist(self) -> None:
        status, _, err = self.run_main("--testee", str(self.root / "nowhere"))
        self.assertEqual(status, 2)
        self.assertIn("nowhere", err)

    # ---- suites ----

    def test_missing_files(self) -> None:
        for suffix in (".pack", ".answers"):
            with self.subTest(suffix):
                file = self.vectors / f"scene{suffix}"
                content = file.read_bytes()
                file.unlink()
                out = self.expect(1, "0 passed, 4 failed, 0 skipped")
                self.assertIn("scene/001-empty: cannot be read", out)
                file.write_bytes(content)

    def test_short_files(self) -> None:
        for suffix in (".pack", ".answers"):
            with self.subTest(suffix):
                file = self.vectors / f"scene{suffix}"
                content = file.read_bytes()
                file.write_bytes(content[:-1])
                out = self.expect(1, "2 passed, 1 failed, 0 skipped")
                self.assertIn(f"scene{suffix} has no bytes", out)
                file.write_bytes(content)

    def test_bytes_of_no_case(self) -> None:
        for suffix in (".pack", ".answers"):
            with self.subTest(suffix):
                file = self.vectors / f"scene{suffix}"
                content = file.read_bytes()
                file.write_bytes(content + b"\n")
                out = self.expect(1, "3 passed, 1 failed, 0 skipped")
                self.assertIn(f"scene{suffix}: bytes from {len(content)} on belong to no case", out)
                file.write_bytes(content)

    def test_unpack(self) -> None:
        self.write_lists([{**case, "what": "A case."} for case in self.cases], {"stem": "scene", "what": "Scenes."}, {"flags": {}})
        folder = self.root / "files"
        status, out, _ = self.run_main("--unpack", str(folder))
        self.assertEqual((status, out.split()[0]), (0, "3"))
        self.assertEqual((folder / "vectors" / "scene" / "001-empty.tct").read_bytes(), VALID)
        self.assertEqual((folder / "vectors" / "scene" / "001-empty.jsonl").read_text("ascii"), VALID_REPLY)
        listed = (folder / "vectors" / "scene.json").read_bytes()
        self.assertEqual([case["name"] for case in json.loads(listed)["cases"]], [case["name"] for case in self.cases])
        manifest = json.loads((folder / "manifest.json").read_text("ascii"))
        self.assertEqual(manifest["stems"]["scene"], {"cases": 3, "sha256": hashlib.sha256(listed).hexdigest()})

    def test_missing_list(self) -> None:
        (self.root / "vectors" / "scene.json").unlink()
        out = self.expect(1, "0 passed, 2 failed, 0 skipped")
        self.assertIn("vectors/scene.json: cannot be read", out)

    def test_changed_list(self) -> None:
        file = self.root / "vectors" / "scene.json"
        file.write_bytes(file.read_bytes() + b"\n")
        out = self.expect(1, "0 passed, 2 failed, 0 skipped")
        self.assertIn("its SHA-256 is not that of the manifest", out)

    def test_file_that_no_stem_has(self) -> None:
        (self.vectors / "004-more.tct").write_bytes(VALID)
        out = self.expect(1, "3 passed, 1 failed, 0 skipped")
        self.assertIn("004-more.tct", out)

    def test_changed_input(self) -> None:
        file = self.vectors / "scene.pack"
        file.write_bytes(bytes([file.read_bytes()[0] ^ 1]) + file.read_bytes()[1:])
        self.expect(1, "2 passed, 1 failed, 0 skipped")

    def test_no_manifest(self) -> None:
        (self.root / "manifest.json").unlink()
        self.expect(1, "0 passed, 1 failed, 0 skipped")

    def test_case_listed_twice(self) -> None:
        self.write_lists([*self.cases, {**self.cases[0], **{key: self.append(suffix, data) for key, suffix, data in (
            ("input", ".pack", VALID), ("answer", ".answers", VALID_REPLY.encode("ascii")))}}])
        self.expect(1, "4 passed, 1 failed, 0 skipped")

    def test_no_stem(self) -> None:
        self.write_lists([])
        for path in self.vectors.iterdir():
            path.unlink()
        self.expect(1, "0 passed, 1 failed, 0 skipped")

    def test_repeated_bytes(self) -> None:
        record = b"\x80\xe8\x07" + bytes(1000)
        whole = VALID + with_crc(record)
        case = self.case("004-repeat", VALID + with_crc(record)[:3] + whole[-4:], VALID_REPLY)
        case["sha256"] = hashlib.sha256(whole).hexdigest()
        case["repeat"] = {"at": len(VALID) + 3, "bytes": "0000", "times": 500}
        self.write_lists([*self.cases, case])
        self.expect(0, "4 passed, 0 failed, 0 skipped")

    def test_only_that_matches_nothing(self) -> None:
        self.expect(1, "0 passed, 1 failed, 0 skipped", "--only", "rigid/*")

    def test_without_a_flag_or_a_profile(self) -> None:
        self.cases[1]["flags"] = ["order"]
        self.cases[2]["profile"] = ["main"]
        self.write_lists(self.cases)
        self.expect(0, "2 passed, 0 failed, 0 skipped", "--without", "order")
        self.expect(0, "1 passed, 0 failed, 0 skipped", "--without", "order", "--without", "main")
        self.expect(1, "3 passed, 1 failed, 0 skipped", "--without", "other")

    def test_without_component_thesis(self) -> None:
        """What needs it is left out, but its valid scenes: to those the answer must be R-DEF-2."""
        def reply(data: bytes, mode: Optional[str] = None) -> str:
            return "".join(json.dumps(line, separators=(",", ":")) + "\n" for line in decoder.lines(data, mode))

        self.cases += [{**self.case("004-thesis", THESIS_SCENE, reply(THESIS_SCENE)), "profile": ["thesis"]},
                       {**self.case("005-main", MAIN_SCENE, reply(MAIN_SCENE)), "profile": ["main"]},
                       {**self.case("006-cut", THESIS_SCENE[:-1], "", "truncated", "R-STR-5"), "profile": ["thesis"]},
                       {**self.case("007-linear", VALID, reply(VALID, "linear")), "args": ["--replica", "linear"]},
                       {**self.case("008-none", VALID, reply(VALID, "none")), "args": ["--replica", "none"]}]
        self.write_lists(self.cases)
        whole = shlex.join([sys.executable, str(HERE / "decoder.py")])
        self.expect(0, "8 passed, 0 failed, 0 skipped")
        self.expect(0, "6 passed, 0 failed, 0 skipped", "--without", "thesis")
        self.expect(0, "6 passed, 0 failed, 0 skipped", "--without", "thesis", "--testee", f"{whole} --without thesis")
        out = self.expect(1, "5 passed, 1 failed, 0 skipped", "--without", "thesis", "--testee", whole)
        self.assertIn("scene/004-thesis: accepted; must be rejected with unsupported R-DEF-2", out)
        self.expect(0, "4 passed, 0 failed, 0 skipped", "--without", "thesis", "--without", "main", "--testee", whole)
        with contextlib.redirect_stderr(io.StringIO()) as err, self.assertRaises(SystemExit) as usage:
            decoder.main(["--without", "thesis", "--replica", "linear"])
        self.assertEqual(usage.exception.code, 2)
        self.assertIn("--replica linear needs component thesis", err.getvalue())

    def test_vectors_without_component_thesis(self) -> None:
        """Of the published vectors: what the runner asks of a decoder that lacks it, and what the second decoder answers."""
        cases, faults = run.load_cases(HERE)
        self.assertEqual(faults, [])
        needing = [case for case in cases if "thesis" in run.needed(case)]
        asked = [asked for case in needing if (asked := run.lacking(case, {"thesis"}))]
        self.assertEqual({case.id.split("/")[0] for case in needing}, {"thesis", "deformable", "packet", "load", "scene"})
        self.assertTrue({case.id for case in cases if case.id.startswith("thesis/")} <= {case.id for case in needing})
        self.assertGreater(len(asked), 20)
        for case in asked:
            with self.assertRaises(StreamError) as refused:
                decoder.File(run.read_input(case), Limits(thesis=False))
            self.assertEqual({"errc": refused.exception.errc, "rule": refused.exception.rule}, case.error, case.id)
            self.assertEqual(run.expected_lines(case), [])

    def test_known_failures(self) -> None:
        accept_all = self.command(f"print({VALID_REPLY!r}, end='')")
        known = self.root / "known-failures.txt"
        known.write_text("scene/002-flag\nscene/003-record\n")
        self.expect(0, "1 passed, 0 failed, 2 skipped", "--testee", accept_all)
        self.expect(1, "1 passed, 2 failed, 0 skipped")
        known.write_text("scene/009-none\n")
        self.expect(1, "3 passed, 1 failed, 0 skipped")

    def test_json(self) -> None:
        status, out, err = self.run_main("--json", "--only", "*/001-*")
        report = json.loads(out)
        self.assertEqual((status, report["passed"], report["failed"], report["skipped"]), (0, 1, 0, 0))
        self.assertEqual(report["cases"], [{"id": "scene/001-empty", "result": "pass", "detail": ""}])
        self.assertEqual(err, "1 passed, 0 failed, 0 skipped\n")


class DifferentialTest(unittest.TestCase):
    def compare(self, testee: str, *more: str) -> tuple[int, str]:
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            status = differential.main(["--testee", testee, "--cases", "12", *more], HERE)
        return status, out.getvalue().splitlines()[-1]

    def test_a_decoder_does_not_differ_from_itself(self) -> None:
        for more in ([], ["--sessions"]):
            status, counts = self.compare(shlex.join([sys.executable, str(HERE / "decoder.py")]), *more)
            self.assertEqual((status, counts.split(", ")[-1]), (0, "0 differences"))

    def test_decoders_without_component_thesis(self) -> None:
        lacks = shlex.join([sys.executable, str(HERE / "decoder.py"), "--without", "thesis"])
        for more in ([], ["--sessions"]):
            self.assertEqual(self.compare(lacks, "--without", "thesis", *more)[0], 0)
        self.assertEqual(self.compare(lacks, "--only", "thesis/*")[0], 1)

    def test_wrong_words_are_seen(self) -> None:
        wrong = "import sys, decoder; write = sys.stdout.write; " \
                "sys.stdout.write = lambda text: write(text.replace('R-', 'R_').replace('true', 'True')); sys.exit(decoder.main())"
        for more in ([], ["--sessions"]):
            status, counts = self.compare(f"env PYTHONPATH={shlex.quote(str(HERE))} {shlex.join([sys.executable, '-c', wrong])}", *more)
            self.assertEqual(status, 1)
            self.assertNotEqual(counts.split(", ")[-1], "0 differences")

    def test_vectors_of_one_stem(self) -> None:
        chosen = differential.Vectors(HERE, "rigid/*")
        self.assertIn(len(chosen.every), range(1, len(differential.Vectors(HERE, "*").every)))
        with contextlib.redirect_stderr(io.StringIO()) as err:
            self.assertEqual(differential.main(["--testee", "true", "--only", "rigid"], HERE), 2)
        self.assertEqual(err.getvalue(), "differential.py: rigid: matches no valid case\n")

    def test_repaired_damage_passes_the_check_values(self) -> None:
        damaged = bytearray(VALID)
        damaged[13] ^= 1
        self.assertEqual(len(differential.sections(VALID)), 1)
        self.assertEqual(differential.repaired(VALID), VALID)
        self.assertEqual(differential.expected(bytes(damaged), None)[0], 1)
        self.assertEqual(differential.expected(differential.repaired(bytes(damaged)), None)[0], 0)


class DevicePathTest(unittest.TestCase):
    """65, section 4: a client and a server over a network that delays and loses datagrams of the device. A tick is 1 ms."""

    TICKS, EVERY = 2000, 5

    def setUp(self) -> None:
        cube = b"\x01\x3f\x01a" + struct.pack("<7i", 0, 0, 0, 1 << 30, 0, 0, 0)
        body = struct.pack("<IBBBBHBB", 1000, 22, 17, 19, 12, 2000, 64, 1) + cube + struct.pack("<5I2H", 1000, 0, 1, 1, 1, 0, 0)
        self.scene, _ = read_declaration(with_crc(MAGIC + struct.pack("<BBHI", VERSION, 0, 16, len(body)) + body))
        self.client, self.server = Epoch(1, 0, 0, 0, 0, 0), ServedEpoch(1, 0, 0, 0, 0, 0)
        self.client.scene = self.server.scene = self.scene
        self.client.drives()
        self.server.offer(b"", True)
        self.server.take_received(STATE, (1,))
        self.rng = random.Random(65)
        self.device = Device(self.scene.position_exp, self.scene.tick_rate, 0.0)
        self.in_flight: list[tuple] = []                    # when, to whom, datagram

    def send(self, tick: int, to: Epoch, datagram: bytes) -> None:
        self.in_flight.append((tick + self.rng.randrange(5, 25), len(self.in_flight), to, datagram))

    def step(self, tick: int, moves: bool) -> None:
        now = 1000 * tick
        if moves and tick % self.EVERY == 0:
            packet = self.device.packet(tick / 1000)
            self.client.keep_device(self.client.next, packet)
            datagram = self.client.write(now, [], packet)
            if self.rng.random() > 0.1:
                self.send(tick, self.server, datagram)
        for end, other in ((self.client, self.server), (self.server, self.client)):
            if end.ack_due is not None and now >= end.ack_due:
                self.send(tick, other, end.write(now, []))
        for item in sorted(item for item in self.in_flight if item[0] == tick):
            item[2].take(now, item[3])

    def test_both_ends_know_the_same_path(self) -> None:
        self.server.simulate(0)
        offset, acted = 12, []
        for tick in range(self.TICKS):
            if tick % 200 == 30:
                self.send(tick, self.client, self.server.write(1000 * tick, [self.server.begin_mapping(tick, offset)]))
                offset = self.rng.randrange(5, 40)
            self.step(tick, True)
            self.server.simulate(tick)
            acted.append(self.server.path.position(tick))
        for tick in range(self.TICKS, self.TICKS + 200):
            self.step(tick, False)
        self.assertEqual([self.server.path.position(t) for t in range(self.TICKS)], acted, "the past has changed")
        self.assertEqual([self.client.path.position(t) for t in range(self.TICKS)], acted)
        self.assertEqual(acted[:31].count(None), 30, "a position before any tick mapping")
        decoded = set(self.server.decoders.substreams[0].receiver.kept)
        self.assertTrue(decoded - set(self.server.path.states), "no packet came too late")
        self.assertGreater(len({self.server.path.device_tick(t + 1) - self.server.path.device_tick(t) for t in range(30, 1900)}), 2)


if __name__ == "__main__":
    unittest.main()
