# SPDX-License-Identifier: Apache-2.0
"""Every number of the JSON report of a figure as a row: what it is of, its quantity, its value.

A member of a list is named by its texts ("pushed"), and by its first number ("deadband=0.01") where it has none or another has the same.
"""
HEAD = ["figure", "setting", "quantity", "value"]


def _is_number(value):
    return isinstance(value, (int, float, bool))


def _names(members):
    texts = [", ".join(value for value in one.values() if isinstance(value, str)) for one in members]
    firsts = [next((f"{key}={value:.6g}" for key, value in one.items() if _is_number(value)), "") for one in members]
    return [", ".join(filter(None, (text, first))) if not text or texts.count(text) > 1 else text for text, first in zip(texts, firsts)]


def _walk(value, settings, quantity):
    if _is_number(value):
        yield [" / ".join(settings), ".".join(quantity), f"{value:.6g}"]
    elif isinstance(value, dict):
        for key, inner in value.items():
            yield from _walk(inner, settings, [*quantity, key])
    elif isinstance(value, list) and all(isinstance(one, dict) for one in value):
        for name, one in zip(_names(value), value):
            yield from _walk(one, [*settings, name], quantity[:-1])
    elif isinstance(value, list):
        for number, one in enumerate(value):
            yield from _walk(one, settings, [*quantity, str(number)])


def rows(name, report):
    return [[name.removeprefix("fig"), *row] for row in _walk(report, [], [])]
