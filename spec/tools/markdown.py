# SPDX-License-Identifier: Apache-2.0
"""The Markdown of these chapters as HTML: headings, paragraphs, lists, tables, quotations, code, links, emphasis. Standard library only."""
import html
import re

LIST = re.compile(r"( *)(?:[*-]|\d+\.) (.*)")


def slug(text: str) -> str:
    """The anchor that GitHub gives a heading."""
    text = re.sub(r"[^\w\- ]", "", text.strip().lower())
    return text.replace(" ", "-")


def cells(row: str) -> list:
    return [c.strip().replace("\\|", "|") for c in re.split(r"(?<!\\)\|", row.strip().strip("|"))]


class Renderer:
    """`link(text)` turns the plain text between code and links into HTML with references; `target(url)` maps a link."""

    def __init__(self, link, target, prefix: str):
        self.link, self.target, self.prefix = link, target, prefix

    # ---- Text within a block ----
    def inline(self, text: str) -> str:
        pieces = []

        def keep(piece: str) -> str:
            pieces.append(piece)
            return f"\0{len(pieces) - 1}\0"

        def code(match) -> str:
            content = html.escape(match.group(2).strip() if match.group(1) != "`" else match.group(2))
            return keep(f"<code>{content}</code>")

        def anchor(match) -> str:
            return keep(f'<a href="{html.escape(self.target(match.group(2)))}">{self.inline(match.group(1))}</a>')

        text = re.sub(r"(`+)(.+?)\1", code, text)
        text = text.replace("&nbsp;", "\u00a0\u00a0")
        text = re.sub(r"\[([^\]]+)\]\(([^)\s]+)\)", anchor, text)
        text = self.link(html.escape(text, quote=False))
        text = re.sub(r"\*\*(.+?)\*\*", r"<strong>\1</strong>", text)
        text = re.sub(r"(?<![\w*])\*(?! )([^*]+?)\*(?!\w)", r"<em>\1</em>", text)
        text = text.replace(" &lt;= ", " \u2264 ").replace(" &gt;= ", " \u2265 ")
        text = re.sub(r"\bx (?=2\^)", "\u00d7 ", text)
        text = re.sub(r"\^(?:\(([^)]+)\)|(-?(?:\w+|\0\d+\0)))", lambda m: f"<sup>{m.group(1) or m.group(2)}</sup>", text)
        while "\0" in text:
            text = re.sub(r"\0(\d+)\0", lambda m: pieces[int(m.group(1))], text)
        return text

    # ---- Blocks ----
    def render(self, source: str) -> str:
        self.lines, self.at, out = source.split("\n"), 0, []
        while self.at < len(self.lines):
            block = self.block()
            if block:
                out.append(block)
        return "\n".join(out)

    def line(self) -> str:
        return self.lines[self.at] if self.at < len(self.lines) else ""

    def run(self, belongs) -> list:
        """Consecutive lines."""
        start = self.at
        while self.at < len(self.lines) and belongs(self.lines[self.at]):
            self.at += 1
        return self.lines[start:self.at]

    def block(self) -> str:
        line = self.line()
        if not line.strip() or line.startswith("<!--"):
            self.at += 1
            return ""
        if line.startswith("```"):
            return self.fenced()
        if line.startswith("#"):
            self.at += 1
            return self.heading(line)
        if line.startswith("|"):
            return self.table(self.run(lambda l: l.startswith("|")))
        if line.startswith(">"):
            inner = [re.sub(r"^> ?", "", l) for l in self.run(lambda l: l.startswith(">"))]
            return f"<aside>\n{self.nested(inner)}\n</aside>"
        if LIST.match(line):
            return self.list()
        text = self.run(lambda l: l.strip() and not re.match(r"```|#|\||>|<!--", l) and not LIST.match(l))
        return f"<p>{self.inline(' '.join(text))}</p>"

    def nested(self, lines: list) -> str:
        inner = Renderer(self.link, self.target, self.prefix)
        return inner.render("\n".join(lines))

    def fenced(self) -> str:
        self.at += 1
        code = self.run(lambda l: not l.startswith("```"))
        self.at += 1
        return f'<pre><code>{self.link(html.escape(chr(10).join(code), quote=False))}</code></pre>'

    def heading(self, line: str) -> str:
        level = len(line) - len(line.lstrip("#"))
        text = line[level:].strip()
        anchor = f"{self.prefix}-{slug(text)}" if level > 1 else self.prefix
        number = re.match(r"(\d+(?:\.\d+)*) ", text)
        named = f'<a class="self" id="{self.prefix}-{number.group(1)}"></a>' if number and level > 1 else ""
        return f'<h{level} id="{anchor}">{named}{self.inline(text)}</h{level}>'

    def table(self, rows: list) -> str:
        head, body = cells(rows[0]), [cells(r) for r in rows[2:]]
        out = ['<div class="table"><table>']
        if any(head):
            out.append("<thead><tr>" + "".join(f"<th>{self.inline(c)}</th>" for c in head) + "</tr></thead>")
        out.append("<tbody>")
        for row in body:
            rule = re.fullmatch(r"R-[A-Z]+-\d+", row[0])
            anchor = f' id="{row[0]}"' if rule and self.defines(head) else ""
            out.append(f"<tr{anchor}>" + "".join(f"<td>{self.inline(c)}</td>" for c in row) + "</tr>")
        return "\n".join(out + ["</tbody></table></div>"])

    @staticmethod
    def defines(head: list) -> bool:
        """A table that defines rules has the columns rule, text and class."""
        return head == ["rule", "", "class"]

    def list(self) -> str:
        ordered = bool(re.match(r" *\d", self.line()))
        items = []
        while LIST.match(self.line()):
            items.append([LIST.match(self.line()).group(2)])
            self.at += 1
            while self.line().startswith("  ") and not LIST.match(self.line()):
                items[-1].append(self.line().strip())
                self.at += 1
        tag = "ol" if ordered else "ul"
        return f"<{tag}>\n" + "\n".join(f"<li>{self.inline(' '.join(item))}</li>" for item in items) + f"\n</{tag}>"
