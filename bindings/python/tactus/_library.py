# SPDX-License-Identifier: Apache-2.0
"""The C libraries: where they are, their functions, and their errors as exceptions."""
from __future__ import annotations

import ctypes
import operator
import os
import pathlib
from typing import Any

from . import _abi

# What the library says in words of the command line, for those rules that arrays and options of Python break.
_REMEDIES = {
    "R-API-5": "Check that the inputs belong together, that times increase, and that packets have the numbers of their sender.",
    "R-API-4": "Give weber_fraction above 0 and at most 1, which is 100 % (haptic=HAPTIC_OFF for no bound of force), visual_position and "
               "fixed_position of at least 2e-6 m, and angles of 4e-5 to pi rad.",
    "R-CSV-4": "Give finite numbers in at least one row; a row of NaN is a missing sample.",
    "R-CSV-5": "Sort the rows by time, and make a trace for each recording.",
    "R-CSV-7": "Give time in seconds as floats (whole numbers are nanoseconds), or time_unit as it is, such as 'ms'; or tick_rate in Hz.",
    "R-CSV-8": "Give each array one row per time: 3 columns of a position or force, 7 of a position and a rotation, or a pair of both.",
}

OK, NOTHING, BUFFER_TOO_SMALL = _abi.TACTUS_OK, _abi.TACTUS_NOTHING, _abi.TACTUS_BUFFER_TOO_SMALL
PACKET_TICK = -(1 << 63)


class Error(Exception):
    """What a call, a stream or a trace did wrong.

    name        class of the error as the specification writes it, such as "checksum"
    code        its number (spec/registry.md)
    rule        rule that was broken, such as "R-FIL-5" (spec/rules.csv)
    bit_offset  position in the input [bits]; 0: none
    remedy      a sentence on how to fix it; may be empty
    advice      how a receiver reacts: "none", "drop", "request_key" or "close"
    subject     file or object that it concerns; may be empty
    detail      figures of this particular case; may be empty
    words       what is wrong in this particular case: file, topic or row, time, value, remedy; may be empty
    """

    def __init__(self, error: Any, subject: str = "", words: str = "", detail: str = "") -> None:
        self._of = (error.status, error.rule, error.bit_offset, subject, words, detail)
        self.name: str = error.name.decode()
        self.code: int = error.status
        self.rule: str = (error.rule or b"").decode()
        self.bit_offset: int = error.bit_offset
        self.remedy: str = _REMEDIES.get(self.rule) or error.remedy.decode()
        self.advice: str = ("none", "drop", "request_key", "close")[error.advice]
        self.subject, self.words, self.detail = subject, words, detail
        position = f" at byte {self.bit_offset // 8}" if self.bit_offset else ""
        text = error.text.decode()
        subject = f"{subject}: " if subject else ""
        figures = f": {detail}" if detail else ""
        super().__init__(words or f"{subject}{text}{position} ({self.name}, {self.rule}){figures}. {self.remedy}".rstrip())

    def __reduce__(self) -> Any:  # workers of multiprocessing send it to their parent
        return _error_of, self._of


def _error_of(status: int, rule: bytes | None, bit_offset: int, subject: str, words: str, detail: str) -> Error:
    error = described(status, rule)
    error.bit_offset = bit_offset
    return Error(error, subject, words, detail)


def described(status: int, rule: bytes | None) -> Any:
    """The error of one who breaks a rule, with its texts."""
    error = _abi.tactus_error()
    core().tactus_describe(status, rule, error)
    return error


def refusal(rule: str, subject: str, name: str = "TACTUS_INVALID_ARGUMENT") -> Error:
    """An error that Python finds."""
    return refusal_for(described(getattr(_abi, name), rule.encode()), subject)


def refusal_for(error: Any, finding: str) -> Error:
    """An error whose finding says all: the text of its rule, which covers other cases too, is left out."""
    plain = Error(error, finding)
    return Error(error, finding, f"{finding} ({plain.name}, {plain.rule}). {plain.remedy}".rstrip())


def _whole(kind: Any) -> Any:
    """A type of arguments that takes what `kind` can hold, integers of NumPy too; ctypes alone would wrap."""

    class Whole(kind):  # type: ignore[misc]
        @classmethod
        def from_param(cls, value: Any) -> Any:
            number = operator.index(value)
            out = kind(number)
            if out.value != number:
                raise OverflowError(f"{number} is out of range")
            return out

    return Whole


_WHOLE = {kind: _whole(kind) for kind in (ctypes.c_int32, ctypes.c_uint32, ctypes.c_int64, ctypes.c_uint64)}


def text_of(text: bytes) -> bytes:
    """For C, where a text ends at its first null byte."""
    if b"\0" in text:
        raise ValueError(f"{text!r} has a null byte")
    return text


def bytes_of(data: Any) -> bytes:
    """Of bytes and whatever else holds some, in one row."""
    return data if isinstance(data, bytes) else bytes(memoryview(data).cast("B"))


def path_of(file: str | os.PathLike[Any] | bytes) -> str | None:
    """The path that is meant; None: these are the bytes of a file. Bytes that name a file are its path, as for open()."""
    if isinstance(file, (bytearray, memoryview)) or (isinstance(file, bytes) and (len(file) > 4096 or not os.path.isfile(file))):
        return None
    return os.fsdecode(file)


class _Library:
    """A shared library whose functions are attributes; those with a tactus_error raise Error."""

    def __init__(self, name: str, parts: tuple[str, ...], needs: str) -> None:
        here = pathlib.Path(__file__).resolve().parent
        # beside, as in a wheel; lib/ above lib/python3/dist-packages/tactus, as an installation has it; else where the system looks
        found = next((path for path in (here / name, *(folder / name for folder in here.parents[1:3])) if path.exists()), name)
        try:
            library = ctypes.CDLL(str(found))
        except OSError as why:
            raise ImportError(f"{name} cannot be loaded: {why}. {needs} Where it is installed, name its folder in LD_LIBRARY_PATH.") from why
        for part in parts:
            for function, (result, arguments) in _abi.FUNCTIONS[part].items():
                entry = getattr(library, function)
                entry.restype, entry.argtypes = result, [_WHOLE.get(kind, kind) for kind in arguments]
                setattr(self, function, entry)

    def __getattr__(self, name: str) -> Any:  # for type checkers: __init__ sets all of them
        raise AttributeError(name)


_loaded: dict[str, _Library] = {}


def core() -> _Library:
    """libtactus."""
    if "core" not in _loaded:
        library = _loaded["core"] = _Library("libtactus.so.0", ("decoder", "encoder"), "Install Tactus with its component C.")
        ours, theirs = _abi.TACTUS_VERSION, library.tactus_version()
        if theirs >> 8 != ours >> 8:
            del _loaded["core"]
            raise ImportError(f"libtactus has version {theirs >> 16}.{theirs >> 8 & 255}, this package {ours >> 16}.{ours >> 8 & 255}. "
                              "Install both from the same build.")
    return _loaded["core"]


def traces() -> _Library:
    """libtactus-trace."""
    if "traces" not in _loaded:
        _loaded["traces"] = _Library("libtactus-trace.so.0", ("trace",), "Install Tactus with its components C and TRACE.")
    return _loaded["traces"]


def call(function: Any, *arguments: Any, subject: str = "", says_all: bool = False) -> bool:
    """Call a function whose last argument is the error. True: done; False: nothing is there.   raises  Error
    says_all: the detail of its error does"""
    error = _abi.tactus_error()
    status = function(*arguments, error)
    if status == OK:
        return True
    if status == NOTHING:
        return False
    detail = error.detail.decode()
    raise Error(error, error.object.decode() or subject, *((detail, "") if says_all else ("", detail)))


def read_bytes(function: Any, *arguments: Any, subject: str = "") -> bytes:
    """All bytes that a function writes into the caller's buffer."""
    size, error = ctypes.c_size_t(), _abi.tactus_error()
    status = function(*arguments, None, 0, ctypes.byref(size), error)
    if status not in (OK, BUFFER_TOO_SMALL):
        raise Error(error, subject)
    buffer = (ctypes.c_uint8 * size.value)()
    call(function, *arguments, buffer, size.value, ctypes.byref(size), subject=subject)
    return bytes(buffer)


class Handle:
    """An object of the library, destroyed by close(), at the end of a `with` block, or with the Python object."""

    _destroy = ""  # name of its function
    _library = staticmethod(core)

    def __init__(self) -> None:
        self._handle = ctypes.c_void_p()

    @property
    def handle(self) -> ctypes.c_void_p:
        """For calls of the library.   raises  ValueError  closed"""
        if not self._handle:
            raise ValueError(f"this {type(self).__name__} is closed")
        return self._handle

    def __reduce_ex__(self, _: Any) -> Any:  # two owners of one handle would both destroy it
        raise TypeError(f"a {type(self).__name__} cannot be copied or pickled")

    def close(self) -> None:
        """Give the memory back; the object is of no use then."""
        if getattr(self, "_handle", None):
            getattr(self._library(), self._destroy)(self._handle)
            self._handle = ctypes.c_void_p()

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()


def handle_of(value: Any, kind: type[Handle]) -> ctypes.c_void_p:
    """The handle of an object of this class; for C all handles are alike."""
    if not isinstance(value, kind):
        raise TypeError(f"a {kind.__name__} is wanted, not a {type(value).__name__}")
    return value.handle


def answer(structure: Any) -> Any:
    """An empty struct for an answer, which knows its size."""
    out = structure()
    out.size = ctypes.sizeof(structure)
    return out
