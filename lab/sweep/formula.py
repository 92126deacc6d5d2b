# SPDX-License-Identifier: Apache-2.0
"""Formulas over named numbers: + - * / and parentheses. "force_rms_N / force_mean_N * 100"

Names begin with a letter and have letters, digits, '_' and '.'. A division by zero is infinite, and no error.
"""
import math
import re

TOKEN = re.compile(r" *(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|(?P<name>[A-Za-z][A-Za-z0-9_.]*)|(?P<sign>[-+*/()]))")
LEADING = re.compile(r"-?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
DEEPEST = 32  # parentheses and signs inside each other


class NotAFormula(Exception):
    pass


def leading_number(cell):
    """The number that a cell begins with: 2.5 of "2.5%", 5 of "5mm,4deg"; NaN without one."""
    found = LEADING.match(cell)
    return float(found[0]) if found else math.nan


def divide(a, b):
    if b != 0:
        return a / b
    return math.nan if a == 0 or math.isnan(a) else math.copysign(math.inf, a) * math.copysign(1, b)


class Formula:
    """A formula that was read. `names`: what it uses."""

    def __init__(self, text):
        self.names, self._text, self._at = [], text, 0
        self._tree = self._sum(0)
        if self._text[self._at:].strip():
            self._fail("an operator")

    def value(self, numbers):
        """In   numbers   {name: number}"""
        return self._tree(numbers)

    def _fail(self, wanted):
        blanks = len(self._text[self._at:]) - len(self._text[self._at:].lstrip(" "))
        raise NotAFormula(f"{wanted} is wanted at character {self._at + blanks + 1}")

    def _next(self, signs):
        """The sign that comes next, if it is one of these: it is taken."""
        found = TOKEN.match(self._text, self._at)
        if not found or not found["sign"] or found["sign"] not in signs:
            return None
        self._at = found.end()
        return found["sign"]

    def _chain(self, part, signs, depth):
        left = part(depth)
        while sign := self._next(signs):
            left = self._joined(sign, left, part(depth))
        return left

    @staticmethod
    def _joined(sign, left, right):
        act = {"+": lambda a, b: a + b, "-": lambda a, b: a - b, "*": lambda a, b: a * b, "/": divide}[sign]
        return lambda numbers: act(left(numbers), right(numbers))

    def _sum(self, depth):
        return self._chain(self._product, "+-", depth)

    def _product(self, depth):
        return self._chain(self._factor, "*/", depth)

    def _factor(self, depth):
        if depth == DEEPEST:
            self._fail("an end of the parentheses")
        if self._next("-"):
            inner = self._factor(depth + 1)
            return lambda numbers: -inner(numbers)
        if self._next("("):
            inner = self._sum(depth + 1)
            if not self._next(")"):
                self._fail("a )")
            return inner
        found = TOKEN.match(self._text, self._at)
        if not found or found["sign"]:
            self._fail("a number or the name of a column")
        self._at = found.end()
        if name := found["name"]:
            self.names.append(name)
            return lambda numbers: numbers[name]
        number = float(found["number"])
        return lambda numbers: number
