# SPDX-License-Identifier: Apache-2.0
"""The writer of vectors: texts and streams into each other, and what it says of texts that are wrong."""
from __future__ import annotations

import random
import unittest
import zlib
from pathlib import Path

import write_vectors
from case_stream import Earlier, blocks_of, stream_of
from case_text import Block, Case, CaseError, bytes_of, digits, parse, words
from declaration_syntax import given_declaration, taken_declaration
from run import load_cases, read_input

HERE = Path(__file__).resolve().parent
SCENE = ("flags 0 tick_rate 1000 position_exp 22 velocity_exp 17 rotation_exp 20 angular_exp 12 max_extrapolation 2000 baseline_span 1 "
         'object_count 1 kind 1 dof 1 name "slider" position 0*3 rotation 1073741824 0*3')
FIRST = "key 1 tick 0 reason 2 level 5 pose -1326 motion 0"


def made(*blocks: tuple[str, str]) -> bytes:
    return stream_of([Block("scene", SCENE), *(Block(*b) for b in blocks)], "one", Earlier({}, {}))


def vector(name: str) -> bytes:
    return next(read_input(case) for case in load_cases(HERE)[0] if case.id == name)


class TextTest(unittest.TestCase):
    def test_elements_come_back(self) -> None:
        rng = random.Random(1)
        for _ in range(300):
            names = rng.choices("abc", k=rng.randrange(60))
            elements = [(name, rng.randrange(3)) for name in names] * rng.randrange(1, 5)
            self.assertEqual(parse(" ".join(words(elements))), elements)

    def test_repetitions_are_short(self) -> None:
        self.assertEqual(" ".join(words([("a", 0)] * 1000)), "a 0*1000")
        self.assertEqual(" ".join(words([("a", 1), ("b", 2)] * 1000)), "( a 1 b 2 )*1000")

    def test_digits_come_back(self) -> None:
        for data in (b"", b"\1\2", bytes(1000), b"\1" + bytes(100) + b"\2"):
            self.assertEqual(bytes_of(digits(data)), data)
        self.assertEqual(digits(b"\1" + bytes(100)), "#01+00*100")

    def test_digits_that_are_none(self) -> None:
        for text in ("12", "#1", "#xy", "#00*"):
            with self.assertRaises(CaseError):
                bytes_of(text)


class StreamTest(unittest.TestCase):
    def test_a_published_packet(self) -> None:
        """91, section 1, has these bytes."""
        self.assertEqual(made(("packet", FIRST)), vector("rigid/001-one-axis")[:len(made(("packet", FIRST)))])

    def test_a_symbol_changes_the_bytes(self) -> None:
        self.assertNotEqual(made(("packet", FIRST)), made(("packet", FIRST.replace("-1326", "-1327"))))

    def test_vectors_come_back(self) -> None:
        """Streams of every kind, as text and back."""
        for name in ("rigid/010-half-circles", "load/001", "range/005", "packet/003-rigid-large-numbers", "packet/076-substream-late",
                     "file/020", "file/040", "file/047", "scene/029-cut-body",
                     "deformable/060-one-triangle", "thesis/007-sheet"):
            data = next(read_input(case) for case in load_cases(HERE)[0] if case.id.startswith(name))
            with self.subTest(name):
                self.assertEqual(stream_of(blocks_of(data, "one", Earlier({}, {}))[0], "one", Earlier({}, {})), data)

    def test_damaged_vectors_come_back(self) -> None:
        rng = random.Random(2)
        for name in ("rigid/001-one-axis", "deformable/060-one-triangle"):
            whole = vector(name)
            for _ in range(20):
                at = rng.randrange(len(whole))
                data = whole[:at] + bytes([whole[at] ^ 1 << rng.randrange(8)]) + whole[at + 1:rng.randrange(at + 1, len(whole) + 1)]
                self.assertEqual(stream_of(blocks_of(data, "one", Earlier({}, {}))[0], "one", Earlier({}, {})), data)

    def test_declarations_in_pieces_come_back(self) -> None:
        data = vector("deformable/060-one-triangle")
        for size in range(200):
            elements, end = taken_declaration(data[:size])
            self.assertEqual(given_declaration(elements), data[:end] if end <= size else data[:size])

    def test_edits(self) -> None:
        plain = made(("packet", FIRST))
        head = len(made())
        self.assertEqual(made(("packet", FIRST + " crc #00000000")), plain[:-4] + bytes(4))
        longer = made(("packet", FIRST + " append #0100"))
        self.assertEqual(longer[head + 2:-4], plain[head + 2:-4] + b"\1\0")
        self.assertEqual(zlib.crc32(longer[head:-4]).to_bytes(4, "little"), longer[-4:])
        self.assertEqual(made(("packet", FIRST), ("packet", "again 0"))[len(plain):][2:-4], plain[head + 2:-4])


class FaultTest(unittest.TestCase):
    def refused(self, word: str, *blocks: tuple[str, str]) -> None:
        with self.assertRaises(CaseError) as context:
            made(*blocks)
        self.assertIn(word, str(context.exception))

    def test_elements_that_are_missing_wrong_or_too_many(self) -> None:
        self.refused("must be motion", ("packet", FIRST.replace(" motion 0", "")))
        self.refused("must be tick", ("packet", FIRST.replace("tick 0 ", "")))
        self.refused("level 16 is not in 0..15", ("packet", FIRST.replace("level 5", "level 16")))
        self.refused("the packet ends before element", ("packet", FIRST + " motion 1"))
        self.refused("there is no block", ("pocket", FIRST))

    def test_a_case_that_expects_otherwise(self) -> None:
        fields = {"result": "valid", "profile": [], "flags": []}
        blocks = [Block("scene", SCENE), Block("packet", FIRST)]
        entry = write_vectors.entry_of(Case("001-one", "One.", fields, blocks), Earlier({}, {}), 0)
        self.assertEqual(len(entry.answer.splitlines()), 3)
        for wrong in ({**fields, "result": "invalid", "errc": "invalid", "rule": "R-RIG-1"}, {**fields, "flags": ["fast"]}):
            with self.assertRaises(CaseError):
                write_vectors.entry_of(Case("001-one", "One.", wrong, blocks), Earlier({}, {}), 0)
        with self.assertRaises(CaseError):
            write_vectors.entry_of(Case("001-one", "One.", fields, [*blocks, Block("expect", '{"end":{}}')]), Earlier({}, {}), 0)
        self.assertEqual(write_vectors.entry_of(Case("004-one", "One.", fields, blocks), Earlier({}, {}), 2).answer, entry.answer)
        for name in ("002-one", "001-one", "3-one", "one"):
            with self.assertRaises(CaseError):
                write_vectors.entry_of(Case(name, "One.", fields, blocks), Earlier({}, {}), 2)


if __name__ == "__main__":
    unittest.main()
