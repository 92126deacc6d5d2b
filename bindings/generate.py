#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Make what each language needs to call the functions of names.txt, from that list and from the headers in c/.

  generate.py version-script PART...   linker script that exports exactly these functions
  generate.py wasm-exports PART...     options of wasm-ld, one a line
  generate.py python PART...           ctypes: constants, structs and functions
  generate.py javascript PART...       constants, and where the fields of structs are in the memory of the WebAssembly module
  generate.py typescript PART...       declarations of these, and of the functions of the module

PART is a section of names.txt, such as decoder. A name without a declaration, or a declaration without a name, is an error.
"""
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
HEADERS = {"tactus.h": ("decoder",), "tactus_encoder.h": ("encoder",), "tactus_session.h": ("session",), "tactus_trace.h": ("trace",)}
SIZES = {"int32_t": 4, "uint32_t": 4, "tactus_status": 4, "int64_t": 8, "uint64_t": 8, "float": 4, "double": 8,
         "size_t": 4, "uint8_t": 1, "pointer": 4}  # of wasm32
CTYPES = {"int32_t": "c_int32", "uint32_t": "c_uint32", "tactus_status": "c_int32", "int64_t": "c_int64", "uint64_t": "c_uint64",
          "float": "c_float", "double": "c_double", "size_t": "c_size_t", "uint8_t": "c_uint8", "char": "c_char"}


def names_of(parts):
    """Functions of these parts, in order; of all without parts."""
    out, part, known = [], None, set()
    for line in (HERE / "names.txt").read_text().splitlines():
        line = line.split("#")[0].strip()
        if line.startswith("["):
            part = line.strip("[]")
            known.add(part)
        elif line and (part in parts or not parts):
            out.append(line)
    if unknown := set(parts) - known:
        sys.exit(f"names.txt has no part {', '.join(sorted(unknown))}")
    return out


def split_field(text):
    """'const float *out' -> ('const float *', 'out', count of an array or 0)"""
    kind, name, count = re.fullmatch(r"(.+?[\s*])(\w+)(?:\[(\d+)\])?", text.strip()).groups()
    return " ".join(kind.replace("*", " * ").split()), name, int(count or 0)


class Interface:
    """Constants, structs and functions of the headers that hold these parts."""

    def __init__(self, parts):
        text = "".join((HERE / "c" / header).read_text() for header, held in HEADERS.items()
                       if header == "tactus.h" or set(held) & set(parts))
        text = re.sub(r"/\*.*?\*/", " ", text, flags=re.S)
        self.constants, self.structs, self.functions = {}, {}, {}
        self.constants["TACTUS_VERSION"] = int(re.search(r"#define TACTUS_VERSION (\w+)", text)[1], 0)
        for body in re.findall(r"\benum \{(.*?)\}", text, re.S):
            for name, value in re.findall(r"(\w+) = (-?\d+)", body):
                self.constants[name] = int(value)
        for body, name in re.findall(r"typedef struct \w+ \{(.*?)\} (\w+);", text, re.S):
            self.structs[name] = [field for line in body.split(";") if line.strip() for field in fields_of(line)]
        self.handles = set(re.findall(r"typedef struct (\w+) \1;", text))
        for result, name, args in re.findall(r"TACTUS_API (.+?[\s*])(\w+)\(([^)]*)\);", text):
            arguments = [] if args.strip() == "void" else [split_field(arg) for arg in args.split(",")]
            self.functions[name] = (" ".join(result.replace("*", " * ").split()), arguments)


def fields_of(line):
    """'uint32_t a, b' -> two fields"""
    first, *more = line.split(",")
    kind, name, count = split_field(first)
    return [(kind, name, count)] + [split_field(f"{kind} {field}") for field in more]


def version_script(names, interface, parts):
    return "TACTUS_0 {\n  global:\n" + "".join(f"    {name};\n" for name in names) + "  local:\n    *;\n};\n"


def wasm_exports(names, interface, parts):
    return "".join(f"--export={name}\n" for name in names)


def ctype(kind, interface):
    """The ctypes expression of a C type."""
    words = kind.replace("const", "").split()
    base, stars = words[0], words.count("*")
    if stars == 0:
        return CTYPES.get(base, base)
    if base in interface.handles:
        return "c_void_p" if stars == 1 else "POINTER(c_void_p)"
    if base == "char":
        return "c_char_p" if stars == 1 else "POINTER(c_char_p)"
    fields = interface.structs.get(base)
    is_one = base == "tactus_error" or (fields and fields[0][1] == "size")  # else the pointer may be to an array
    return f"POINTER({base})" if is_one else "c_void_p"


def field_ctype(kind, count, interface):
    if "*" in kind:
        return "c_char_p" if "char" in kind else "c_void_p"
    return ctype(kind, interface) + (f" * {count}" if count else "")


def python(names, interface, parts):
    lines = ["# Made by bindings/generate.py.", "from ctypes import (POINTER, Structure, c_char_p, c_double, c_float, c_int32, c_int64, "
             "c_size_t, c_uint8, c_uint32, c_uint64, c_void_p)", ""]
    lines += [f"{name} = {value}" for name, value in interface.constants.items()]
    for name, fields in interface.structs.items():
        lines += ["", "", f"class {name}(Structure):", "    _fields_ = ["]
        lines += [f'        ("{field}", {field_ctype(kind, count, interface)}),' for kind, field, count in fields]
        lines += ["    ]"]
    lines += ["", "", "FUNCTIONS = {"]
    for part in parts:
        lines.append(f'    "{part}": {{')
        for name in names_of([part]):
            result, arguments = interface.functions[name]
            restype = "None" if result == "void" else ctype(result, interface)
            lines.append(f'        "{name}": ({restype}, [{", ".join(ctype(kind, interface) for kind, _, _ in arguments)}]),')
        lines.append("    },")
    return "\n".join(lines + ["}", ""])


def wasm_layout(name, interface):
    """[(field, type, offset, count)], size and alignment of a struct in wasm32."""
    at, most, out = 0, 1, []
    for kind, field, count in interface.structs[name]:
        base = kind.replace("const", "").split()[0]
        if "*" in kind:
            base = "pointer"
        if base in interface.structs:
            _, size, align = wasm_layout(base, interface)
        else:
            size = align = SIZES[base]
        at = -(-at // align) * align
        out.append((field, base, at, count))
        at += size * max(1, count)
        most = max(most, align)
    return out, -(-at // most) * most, most


def javascript(names, interface, parts):
    lines = ["// Made by bindings/generate.py.", "export const constants = {"]
    lines += [f"  {name}: {value}," for name, value in interface.constants.items()] + ["};", "", "export const layouts = {"]
    for name in interface.structs:
        fields, size, _ = wasm_layout(name, interface)
        lines.append(f"  {name}: {{size: {size}, fields: {{")
        lines += [f'    {field}: {{type: "{kind}", offset: {at}, count: {max(1, count)}}},' for field, kind, at, count in fields]
        lines.append("  }},")
    return "\n".join(lines + ["};", ""])


def typescript(names, interface, parts):
    def js(kind):
        if "*" in kind:
            return "number"
        return {"void": "void", "int64_t": "bigint", "uint64_t": "bigint"}.get(kind, "number")
    lines = ["// Made by bindings/generate.py.", "", "/** Functions of the module. Pointers are addresses in its memory. */",
             "export interface Exports {", "  memory: WebAssembly.Memory;"]
    for name in names:
        result, arguments = interface.functions[name]
        lines.append(f"  {name}({', '.join(f'{arg}: {js(kind)}' for kind, arg, _ in arguments)}): {js(result)};")
    lines += ["}", "", "export const constants: {"] + [f"  readonly {n}: {v};" for n, v in interface.constants.items()] + ["};"]
    lines += ["", "/** Where a field is, in bytes from the front of its struct. */", "export interface Field {",
              '  readonly type: string;  // "pointer", a type of C, or a struct', "  readonly offset: number;",
              "  readonly count: number;  // of an array, else 1", "}", "", "export interface Layout<Name extends string> {",
              "  readonly size: number;", "  readonly fields: {readonly [name in Name]: Field};", "}", "", "export const layouts: {"]
    for name, fields in interface.structs.items():
        lines.append(f"  readonly {name}: Layout<{' | '.join(chr(34) + field + chr(34) for _, field, _ in fields)}>;")
    return "\n".join(lines + ["};", ""])


FORMS = {"version-script": version_script, "wasm-exports": wasm_exports, "python": python,
         "javascript": javascript, "typescript": typescript}


def main():
    if len(sys.argv) < 3 or sys.argv[1] not in FORMS:
        sys.exit(__doc__)
    parts = sys.argv[2:]
    names, interface = names_of(parts), Interface(parts)
    if missing := [name for name in names if name not in interface.functions]:
        sys.exit(f"no header declares {', '.join(missing)}")
    if unlisted := set(interface.functions) - set(names_of([])):
        sys.exit(f"names.txt lacks {', '.join(sorted(unlisted))}")
    sys.stdout.write(FORMS[sys.argv[1]](names, interface, parts))


if __name__ == "__main__":
    main()
