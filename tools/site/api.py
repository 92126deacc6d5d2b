# SPDX-License-Identifier: Apache-2.0
"""Pages of the libraries' interface: the installed headers, read by doxygen.

The headers keep their own short form of comments ("in  x  ...", "err  limit_exceeded R-FRC-3 ...", formulas and programs indented).
Doxygen is handed copies in which these parts are paragraphs and blocks of code.
"""
import pathlib
import re
import subprocess

import pages

C = "C interface"  # of its headers c/tactus.h is included as <tactus.h>
PARTS = {"in": "In", "out": "Out", "pre": "Before the call", "err": "Errors", "time": "Cost", "cost": "Cost"}
PART = re.compile(r"(\s*)(in|out|pre|err|time|cost) {2,}(\S.*)$")
INNER = re.compile(r"(?:^|\s{2,})(in|out|pre|err|time|cost) {2,}(?=\S)")
DOXYFILE = """
PROJECT_NAME = "Tactus libraries"
INPUT = main.dox tactus {c}
RECURSIVE = YES
FILE_PATTERNS = *.h *.dox
STRIP_FROM_PATH = .
STRIP_FROM_INC_PATH = .
OUTPUT_DIRECTORY = {out}
HTML_OUTPUT = .
HTML_HEADER = header.html
HTML_FOOTER = footer.html
HTML_EXTRA_STYLESHEET = bar.css
HTML_COLORSTYLE_HUE = 214
HTML_COLORSTYLE_SAT = 40
GENERATE_LATEX = NO
GENERATE_TREEVIEW = NO
MARKDOWN_SUPPORT = NO
JAVADOC_AUTOBRIEF = YES
EXTRACT_ALL = YES
EXTRACT_STATIC = YES
HIDE_UNDOC_RELATIONS = YES
SHOW_INCLUDE_FILES = NO
VERBATIM_HEADERS = NO
SOURCE_BROWSER = NO
HAVE_DOT = NO
CLASS_GRAPH = NO
SORT_MEMBER_DOCS = NO
ENABLE_PREPROCESSING = YES
MACRO_EXPANSION = YES
EXPAND_ONLY_PREDEF = YES
PREDEFINED = __cplusplus TACTUS_API=
QUIET = YES
WARN_IF_UNDOCUMENTED = NO
WARN_AS_ERROR = FAIL_ON_WARNINGS
"""


STYLE = """
#titlearea { display: none; }
div.contents, div.header, div.headertitle { max-width: 72rem; margin-left: auto; margin-right: auto; }
div.fragment { padding: .5rem .8rem; overflow-x: auto; }
div.line { line-height: 1.4; min-height: 1.4em; }
"""


def public_headers(root):
    """For each component its headers, as they are included: their files in the tree. Read from the calls of tactus_headers()."""
    found = {}
    for listing in sorted(root.glob("**/CMakeLists.txt")):
        if "build" in listing.relative_to(root).parts:
            continue
        text = listing.read_text(encoding="utf-8")
        for component, folder, prefix, names in re.findall(r"^\s*tactus_headers\(\s*tactus_(\w+)\s+(\S+)\s+(\S+)([^)]*)\)", text, re.M):
            for name in names.split():
                found.setdefault(component, {})["/".join(filter(None, ("tactus", prefix.strip('"'), name)))] = root / folder / name
        for headers in re.findall(r"^\s*tactus_c_library\(.*?HEADERS ([\w. ]+)", text, re.M):
            found.setdefault(C, {}).update({"c/" + name: listing.parent / name for name in headers.split()})
    return found


def first_sentence(text):
    comment = re.search(r"^///.*(?:\n///.*)*", text, re.M) or re.search(r"^/\*\n.*?\*/", text, re.M | re.S)
    words = " ".join(line.strip("/* ") for line in comment[0].splitlines()).strip() if comment else ""
    return re.split(r"(?<=[.:]) (?=[A-Z#])", words, maxsplit=1)[0].rstrip(":").removesuffix(".")


def main_page(headers):
    """A table per component: what to include, and what it is for."""
    out = ["/** @mainpage Libraries", "Start with tactus/tactus.h, which shows a whole program. Each component is a target of CMake, "
           "<code>tactus\\::codec</code> and so on, and is built where its packages are there."]
    for component, files in sorted(headers.items(), key=lambda item: (item[0] != "codec", item[0] != C, item[0])):
        rows = "".join(f"<tr><td>{name}</td><td>{escaped(first_sentence(file.read_text(encoding='utf-8')))}</td></tr>\n"
                       for name, file in sorted(files.items()))
        out.append(f"<h2>{component}</h2>\n<table>\n{rows}</table>")
    return "\n\n".join(out) + "\n*/\n"


def escaped(text):
    """Text that doxygen shows as it stands, with `code` between backticks."""
    text = re.sub(r'[\\@<>#%&$]', lambda m: {"<": "&lt;", ">": "&gt;", "&": "&amp;"}.get(m[0], "\\" + m[0]), text)
    text = text.replace("::", "\\::")  # names are linked all the same; a private one must not end as a link to nowhere
    return re.sub(r"`([^`]*)`", r"<code>\1</code>", text)


def split_parts(text):
    """Sentences and the parts that follow them in one line: [("", "Play."), ("err", "as open()")]."""
    pieces = INNER.split(text)
    return [("", pieces[0].strip())] * bool(pieces[0].strip()) + list(zip(pieces[1::2], (p.strip() for p in pieces[2::2])))


def paragraphs(lines):
    """A comment of full lines, in doxygen's words."""
    out, code, part_indent = [], [], None

    def end_code():
        if code:
            out.extend(["@code{.unparsed}", *code, "@endcode"])
            code.clear()
    for number, line in enumerate(lines):
        indent = len(line) - len(line.lstrip())
        part = PART.match(line)
        goes_on = part_indent is not None and indent > part_indent and not part
        inside = bool(code) and next((later for later in lines[number:] if later.strip()), "").startswith("  ")
        if (indent >= 2 and not part and not goes_on) or (inside and not line.strip()):
            code.append(line)
            continue
        end_code()
        if goes_on:
            out.append(escaped(line.strip()))
            continue
        part_indent = indent if part else None
        for kind, text in split_parts(line.strip()):
            if kind:
                out += ["@par " + PARTS[kind], escaped(text)]
                part_indent = indent
            else:
                out.append(escaped(text))
        if not line.strip():
            out.append("")
    end_code()
    return out


def trailing(text):
    """A comment behind a member: one line."""
    return " ".join((f"<b>{PARTS[kind]}:</b> " if kind else "") + escaped(words) for kind, words in split_parts(text))


def converted(text):
    out, block = [], []

    def end_block():
        if block:
            indent, is_first = block[0][0], not any(line.startswith("#") or "namespace" in line for line in out)
            lines = paragraphs([words for _, words in block])
            out.extend(f"{indent}/// {line}".rstrip() for line in (["@file"] if is_first else []) + lines)
            if is_first:
                out.append("")
            block.clear()
    for line in text.splitlines():
        full = re.match(r"(\s*)///(?!<) ?(.*)$", line)
        if full:
            block.append((full[1], full[2]))
            continue
        end_block()
        behind = re.match(r"(.*)///< ?(.*)$", line)
        out.append(f"{behind[1]}///< {trailing(behind[2])}" if behind else line)
    end_block()
    return "\n".join(out) + "\n"


def converted_c(text):
    """A header in C: comments before a declaration and behind it become doxygen's, the first one that of the file."""
    def comment(match):
        before, words = match[1], match[2]
        if "SPDX" in words or words.strip().startswith("---"):
            return before
        lines = [re.sub(r"^ ?\* ?", "", line) for line in words.splitlines()]
        if before.strip():
            return f"{before}/**< {escaped(' '.join(line.strip() for line in lines))} */"
        is_file = comment.is_first
        comment.is_first = False
        if not is_file:
            return f"{before}/** {escaped(' '.join(line.strip() for line in lines)).strip()} */"
        plain, table = [line for line in lines if line.strip()], []
        while plain and not re.match(r"\w+ {2,}", plain[0]):
            table.append(escaped(plain.pop(0)))
        return "\n".join(["/** @file", *table, *(["@code{.unparsed}", *plain, "@endcode"] if plain else []), "*/"])
    comment.is_first = True
    return re.sub(r"^([^\n]*?)/\*(.*?)\*/", comment, text, flags=re.M | re.S)


def write(root, out, scratch):
    headers = public_headers(root)
    for name, source in (pair for files in headers.values() for pair in files.items()):
        (scratch / name).parent.mkdir(parents=True, exist_ok=True)
        text = source.read_text(encoding="utf-8")
        (scratch / name).write_text(converted_c(text) if name.startswith("c/") else converted(text), encoding="utf-8")
    (scratch / "main.dox").write_text(main_page(headers), encoding="utf-8")
    (scratch / "Doxyfile").write_text(DOXYFILE.format(out=out.resolve(), c="c" if C in headers else ""), encoding="utf-8")
    subprocess.run(["doxygen", "-w", "html", "header.html", "unused.html", "unused.css"], cwd=scratch, check=True, capture_output=True)
    header = (scratch / "header.html").read_text(encoding="utf-8")
    (scratch / "header.html").write_text(re.sub(r"(<body[^>]*>)", rf"\1\n{pages.bar('$relpath^../')}", header, count=1), encoding="utf-8")
    (scratch / "footer.html").write_text("</body>\n</html>\n", encoding="utf-8")
    (scratch / "bar.css").write_text(pages.BAR_STYLE + STYLE, encoding="utf-8")
    out.mkdir(parents=True)
    done = subprocess.run(["doxygen", "Doxyfile"], cwd=scratch, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit("doxygen: " + done.stderr[-4000:].replace(str(scratch), ""))
    for path in out.glob("*.html"):
        text = path.read_text(encoding="utf-8").replace("#include &lt;c/", "#include &lt;")
        if 'name="nested-classes"' not in text:  # a class with private classes only is said to have a list of them
            text = re.sub(r'<a href="#nested-classes">Classes</a>( &#124;)?', "", text)
        path.write_text(text, encoding="utf-8")


def self_test():
    cases = [(["Play a packet.   err  as open()"], ["Play a packet.", "@par Errors", "as open()"]),
             (["in   q  3 x int16", "     of the grid", "out  F  |F| < 40"], ["@par In", "q  3 x int16", "of the grid", "@par Out", "F  |F| &lt; 40"]),
             (["Dequantise:", "  F = Q * 2^e", "as a double."], ["Dequantise:", "@code{.unparsed}", "  F = Q * 2^e", "@endcode", "as a double."]),
             (["So:", "  a;", "", "  b;", "", "End."], ["So:", "@code{.unparsed}", "  a;", "", "  b;", "@endcode", "", "End."]),
             (["See `a<b>`."], ["See <code>a&lt;b&gt;</code>."])]
    failed = [(given, paragraphs(given)) for given, wanted in cases if paragraphs(given) != wanted]
    print(*(f"api: {given} becomes {got}" for given, got in failed), f"api: {len(cases)} comments, {len(failed)} wrong", sep="\n")
    return int(bool(failed))
