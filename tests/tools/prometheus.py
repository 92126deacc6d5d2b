# SPDX-License-Identifier: Apache-2.0
"""The text format 0.0.4 of Prometheus, read strictly: from its description, not from what writes it."""
import math
import re

NAME = re.compile(r"[a-zA-Z_:][a-zA-Z0-9_:]*")
SAMPLE = re.compile(r"([a-zA-Z_:][a-zA-Z0-9_:]*)(?:\{(.*)\})? (\S+)")
LABEL = re.compile(r'([a-zA-Z_][a-zA-Z0-9_]*)="((?:[^"\\\n]|\\["\\n])*)"(,|$)')


class Family:
    def __init__(self, name, text):
        self.name, self.help, self.type, self.samples = name, text, None, {}

    def suffixes(self):
        return ("_bucket", "_sum", "_count") if self.type == "histogram" else ("",)


def labels_of(text):
    out, at = {}, 0
    while text is not None and at < len(text):
        label = LABEL.match(text, at)
        assert label and label[1] not in out, f"labels {text!r}"
        out[label[1]] = re.sub(r"\\(.)", lambda m: "\n" if m[1] == "n" else m[1], label[2])
        at = label.end()
    return out


def number_of(text):
    if text in ("NaN", "+Inf", "-Inf"):
        return float(text)
    assert re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", text), f"value {text!r}"
    return float(text)


def check_histogram(family):
    rows = {}
    for (name, labels), value in family.samples.items():
        labels = dict(labels)
        bound = labels.pop("le", None)
        assert (bound is not None) == name.endswith("_bucket"), name
        rows.setdefault(tuple(sorted(labels.items())), {})[name[len(family.name):] if bound is None else number_of(bound)] = value
    for row in rows.values():
        buckets = [(bound, count) for bound, count in row.items() if isinstance(bound, float)]
        assert buckets == sorted(buckets) and buckets[-1][0] == math.inf, f"{family.name}: bounds do not rise to +Inf"
        assert all(a[1] <= b[1] for a, b in zip(buckets, buckets[1:])), f"{family.name}: counts do not rise"
        assert buckets[-1][1] == row["_count"], f"{family.name}: _count is not that of +Inf"
        assert row["_count"] > 0 or row["_sum"] == 0, family.name


def parse(text):
    """Families by name. Every line must be HELP, TYPE or a sample, in that order, and a family must stand in one piece."""
    families, current = {}, None
    assert text.endswith("\n"), "the last line does not end"
    for line in text[:-1].split("\n"):
        if line.startswith("# HELP "):
            name, words = line[7:].split(" ", 1)
            assert NAME.fullmatch(name) and name not in families and words, line
            current = families[name] = Family(name, words)
        elif line.startswith("# TYPE "):
            name, kind = line[7:].split(" ")
            assert name == current.name and current.type is None and not current.samples, line
            assert kind in ("counter", "gauge", "histogram"), line
            current.type = kind
        else:
            sample = SAMPLE.fullmatch(line)
            assert sample and current.type, line
            assert sample[1] in [current.name + suffix for suffix in current.suffixes()], f"{line}: not of {current.name}"
            key = sample[1], tuple(sorted(labels_of(sample[2]).items()))
            assert key not in current.samples, f"{line}: twice"
            current.samples[key] = number_of(sample[3])
            assert current.type == "gauge" or current.samples[key] >= 0, line
    for family in families.values():
        assert family.type, f"{family.name} has no type"
        assert (family.type == "counter") == family.name.endswith("_total"), f"{family.name}: _total is of counters"
        if family.type == "histogram":
            check_histogram(family)
        for word in ("milli", "micro", "_ms", "_us", "kilo", "percent", "_bit"):
            assert word not in family.name, f"{family.name}: not in a base unit"
    return families


def value(families, name, **labels):
    return families[name].samples[name, tuple(sorted(labels.items()))]
