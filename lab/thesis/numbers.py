# SPDX-License-Identifier: Apache-2.0
"""Every number of the JSON report of a figure as a row: what it is of, its quantity, its value.

A member of a list is named by its texts ("pushed"), or by its first number ("deadband=0.01") where it has none.
"""
HEAD = ["figure", "setting", "quantity", "value"]


def _is_number(value):
    return isinstance(value, (int, float, bool))


def _name(member):
    if not isinstance(member, dict):
        return ""
    texts = [value for value in member.values() if isinstance(value, str)]
    first = next(((key, value) for key, value in member.items() if _is_number(value)), None)
    return ", ".join(texts) if texts or first is None else f"{first[0]}={first[1]:.6g}"


def _walk(value, settings, quantity):
    if _is_number(value):
        yield [" | ".join(settings), ".".join(quantity), f"{value:.6g}"]
    elif isinstance(value, dict):
        for key, inner in value.items():
            yield from _walk(inner, settings, [*quantity, key])
    elif isinstance(value, list) and all(isinstance(one, dict) for one in value):
        for one in value:
            yield from _walk(one, [*settings, _name(one)], quantity[:-1])
    elif isinstance(value, list):
        for number, one in enumerate(value):
            yield from _walk(one, settings, [*quantity, str(number)])


def rows(name, report):
    return [[name.removeprefix("fig"), *row] for row in _walk(report, [], [])]
