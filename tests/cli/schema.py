#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Hold JSON against one of the schemas of cli/schemas (the part of JSON Schema 2020-12 that they use; anything else is refused).

  schema.py SCHEMA FILE...   one line per finding, exit 1 when there is any
  schema.py --self-test      check that each kind of difference is found
"""
import json
import pathlib
import sys

TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}
KNOWN = {"$schema", "$id", "$defs", "$ref", "title", "description", "type", "const", "enum", "minimum", "maximum", "properties", "required",
         "additionalProperties", "items", "minItems", "maxItems", "oneOf",
         # for the table that a person sees (cli/report/printer.h)
         "x-unit", "x-scale", "x-count", "x-format", "x-words", "x-text", "x-omit", "x-hidden", "x-note", "x-block", "x-row", "x-column", "x-as"}
PARTS = pathlib.Path(__file__).resolve().parents[2] / "cli/schemas/parts.json"  # what "urn:tactus:parts" names


def has_type(value, name):
    if name in ("number", "integer"):
        return not isinstance(value, bool) and isinstance(value, int if name == "integer" else (int, float))
    return isinstance(value, TYPES[name])


def differences(value, schema, root, path="$"):
    """Where a value is not as a schema says, in words."""
    unknown = set(schema) - KNOWN
    if unknown:
        return [f"{path}: the schema uses {', '.join(sorted(unknown))}, which this program does not know"]
    if "$ref" in schema:
        document, name = schema["$ref"].split("#/$defs/")
        if document == "urn:tactus:parts":
            root = json.loads(PARTS.read_text(encoding="utf-8"))
        return differences(value, root["$defs"][name], root, path)
    if "oneOf" in schema:
        tried = [differences(value, one, root, path) for one in schema["oneOf"]]
        return [] if sum(not t for t in tried) == 1 else [f"{path}: fits {sum(not t for t in tried)} of the alternatives", *min(tried, key=len)]
    types = schema.get("type", [])
    types = [types] if isinstance(types, str) else types
    if types and not any(has_type(value, name) for name in types):
        return [f"{path}: {value!r} is no {' or '.join(types)}"]
    out = []
    if "const" in schema and value != schema["const"]:
        out.append(f"{path}: {value!r} is not {schema['const']!r}")
    if "enum" in schema and value not in schema["enum"]:
        out.append(f"{path}: {value!r} is none of {schema['enum']}")
    if "minimum" in schema and has_type(value, "number") and value < schema["minimum"]:
        out.append(f"{path}: {value} is below {schema['minimum']}")
    if "maximum" in schema and has_type(value, "number") and value > schema["maximum"]:
        out.append(f"{path}: {value} is above {schema['maximum']}")
    if isinstance(value, list):
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            out.append(f"{path}: {len(value)} items")
        for i, item in enumerate(value):
            out += differences(item, schema.get("items", {}), root, f"{path}[{i}]")
    if isinstance(value, dict):
        out += [f"{path}: lacks {name}" for name in schema.get("required", []) if name not in value]
        other = schema.get("additionalProperties", {})
        for name, item in value.items():
            if name in schema.get("properties", {}):
                out += differences(item, schema["properties"][name], root, f"{path}.{name}")
            elif other is False:
                out.append(f"{path}: {name} is not in the schema")
            else:
                out += differences(item, other, root, f"{path}.{name}")
    return out


def self_test():
    schema = {"$defs": {"n": {"type": "number", "minimum": 0, "maximum": 9}}, "type": "object", "required": ["a"], "additionalProperties": False,
              "properties": {"a": {"$ref": "#/$defs/n"}, "b": {"type": "array", "maxItems": 2, "items": {"type": ["integer", "null"]}},
                             "c": {"enum": ["x", "y"]}, "d": {"oneOf": [{"const": 1}, {"type": "string"}]}}}
    good = [{"a": 0}, {"a": 1.5, "b": [1, None], "c": "x"}, {"a": 2, "d": 1}, {"a": 2, "d": "s"}]
    bad = [{}, {"a": -1}, {"a": 9.5}, {"a": "1"}, {"a": True}, {"a": 1, "b": [1.5]}, {"a": 1, "b": [1, 2, 3]}, {"a": 1, "c": "z"}, {"a": 1, "d": 2},
           {"a": 1, "e": 0}, []]
    wrong = [v for v in good if differences(v, schema, schema)] + [v for v in bad if not differences(v, schema, schema)]
    wrong += [] if differences(1, {"pattern": "x"}, {}) else ["unknown keyword"]
    print(f"self-test: {len(good) + len(bad) + 1} values, {len(wrong)} wrong", *wrong)
    return not wrong


def main(args):
    if args == ["--self-test"]:
        return 0 if self_test() else 1
    if len(args) < 2:
        print(__doc__, file=sys.stderr)
        return 2
    schema = json.loads(pathlib.Path(args[0]).read_text(encoding="utf-8"))
    found = 0
    for name in args[1:]:
        for line in differences(json.loads(pathlib.Path(name).read_text(encoding="utf-8")), schema, schema):
            print(f"{name}: {line}")
            found += 1
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
