# SPDX-License-Identifier: Apache-2.0
"""All chapters as one page, in HTML without external resources, or as one Markdown file for a typesetter."""
import html
import re

from tools.book import NUMBER, Book, Chapter
from tools.markdown import Renderer, slug

# What the pages of the site (tools/site) look like too.
SHARED_STYLE = """
:root { color-scheme: light dark; --text: #1c1e21; --paper: #fff; --soft: #5c6370; --line: #d7dae0; --tint: #f5f6f8; --link: #0b57a4; }
@media (prefers-color-scheme: dark) {
  :root { --text: #d9dce1; --paper: #16181b; --soft: #9aa1ac; --line: #33373d; --tint: #1f2226; --link: #7fb4f2; } }
* { box-sizing: border-box; }
body { margin: 0; color: var(--text); background: var(--paper); font: 1rem/1.55 system-ui, sans-serif; }
a { color: var(--link); text-decoration: none; }
a:hover { text-decoration: underline; }
h1, h2, h3 { line-height: 1.25; margin: 2.2em 0 .6em; }
code, pre { font-family: ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace; font-size: .86em; }
code { background: var(--tint); border-radius: 3px; padding: .05em .25em; }
pre { background: var(--tint); border: 1px solid var(--line); border-radius: 4px; padding: .7rem .9rem; overflow-x: auto; line-height: 1.4; }
pre code { background: none; padding: 0; font-size: 1em; }
table { border-collapse: collapse; font-size: .92rem; }
th, td { border-bottom: 1px solid var(--line); padding: .3rem .9rem .3rem 0; text-align: left; vertical-align: top; }
th { border-bottom-width: 2px; }
"""
STYLE = SHARED_STYLE + """html { scroll-padding-top: 1rem; -webkit-text-size-adjust: 100%; }
main { max-width: 54rem; margin: 0 auto; padding: 1rem 1rem 6rem; overflow-wrap: break-word; }
h1 { font-size: 1.7rem; border-bottom: 1px solid var(--line); padding-bottom: .3rem; margin-top: 4rem; }
h2 { font-size: 1.3rem; }
h3 { font-size: 1.08rem; }
header h1 { border: 0; margin: 1.5rem 0 0; font-size: 2rem; }
header p { color: var(--soft); margin: .2rem 0 1.5rem; }
pre a { color: inherit; text-decoration: underline dotted; }
aside { border-left: 3px solid var(--line); color: var(--soft); margin: 1rem 0; padding: .1rem 0 .1rem 1rem; }
.table { overflow-x: auto; margin: 1rem 0; }
td:first-child { min-width: 5.5rem; }
.rules td:nth-child(2) { min-width: 13rem; }
td code { overflow-wrap: normal; }
td:last-child { min-width: 7rem; }
sup { white-space: nowrap; line-height: 0; font-size: .8em; }
tr:target, :target + tr { background: var(--tint); }
nav { font-size: .92rem; border: 1px solid var(--line); border-radius: 4px; padding: .6rem 1rem; }
nav details { margin: .15rem 0; }
nav summary { cursor: pointer; }
nav ul { list-style: none; margin: .1rem 0 .4rem; padding-left: 1.2rem; }
@media (max-width: 30rem) { main { padding: .6rem .8rem 4rem; } pre { font-size: .78rem; padding: .6rem; } table { font-size: .86rem; } }
@media (min-width: 70rem) {
  body { display: grid; grid-template-columns: 15rem minmax(0, 1fr); }
  nav { position: sticky; top: 0; height: 100vh; overflow-y: auto; border: 0; border-right: 1px solid var(--line); border-radius: 0; padding: 1.2rem 1rem; }
  main { margin: 0 auto; padding: 1rem 2.5rem 6rem; width: 100%; } }
@media print {
  :root { --text: #000; --paper: #fff; --soft: #333; --line: #aaa; --tint: #f4f4f4; --link: #000; }
  body { display: block; font-size: 9.5pt; } main { max-width: none; padding: 0; }
  nav { position: static; height: auto; border: 0; page-break-after: always; } nav details > ul { display: block; }
  h1 { page-break-before: always; margin-top: 0; } header h1 { page-break-before: auto; } h1, h2, h3 { page-break-after: avoid; }
  .table, pre { overflow: visible; } pre { white-space: pre-wrap; } tr, pre { page-break-inside: avoid; } }
"""
OPEN_IN_PRINT = "addEventListener('beforeprint',()=>document.querySelectorAll('nav details').forEach(d=>d.open=true));"


def linked(book: Book, chapter: Chapter):
    def link(text: str) -> str:
        out, at = [], 0
        for start, end, target in book.references(chapter, text):
            out += [text[at:start], f'<a href="#{target}">{text[start:end]}</a>' if target else text[start:end]]
            at = end
        return "".join(out) + text[at:]
    return link


def target_in(book: Book, chapter: Chapter):
    """A link of a chapter, in the page that holds all chapters."""
    stems = {c.name: c.stem for c in book.chapters}

    def target(url: str) -> str:
        path, _, anchor = url.partition("#")
        stem = stems.get(path) if path else chapter.stem
        if stem:
            return f"#{stem}-{anchor}" if anchor else f"#{stem}"
        return url
    return target


def chapter_html(book: Book, chapter: Chapter) -> str:
    body = Renderer(linked(book, chapter), target_in(book, chapter), chapter.stem).render(chapter.text)
    if chapter.stem == "rules":                             # a rule that no chapter defines is defined by the index
        for rule, row in book.rules.items():
            if row["chapter"] == "-":
                body = body.replace(f'<tr><td><a href="#{rule}">{rule}</a></td>', f'<tr id="{rule}"><td>{rule}</td>', 1)
    return body


def contents(book: Book) -> str:
    out = []
    for chapter in book.chapters:
        sections = "".join(f'<li><a href="#{chapter.stem}-{slug(h)}">{html.escape(h.replace("`", ""))}</a></li>'
                           for level, h in chapter.headings if level == "##")
        out.append(f'<details><summary><a href="#{chapter.stem}">{html.escape(chapter.title)}</a></summary><ul>{sections}</ul></details>'
                   if sections else f'<div><a href="#{chapter.stem}">{html.escape(chapter.title)}</a></div>')
    return "<nav>\n" + "\n".join(out) + "\n</nav>"


def html_page(book: Book, title: str) -> str:
    body = "\n".join(f'<section class="{c.stem}">\n{chapter_html(book, c)}\n</section>' for c in book.chapters)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>{STYLE}</style>
</head>
<body>
{contents(book)}
<main>
<header><h1>{title}</h1><p>All chapters. Normative as each chapter says.</p></header>
{body}
</main>
<script>{OPEN_IN_PRINT}</script>
</body>
</html>
"""


def dead_links(page: str):
    """Internal links of a page that lead nowhere, and anchors that are there twice."""
    anchors = re.findall(r'\sid="([^"]+)"', page)
    for url in sorted(set(re.findall(r'href="#([^"]*)"', page)) - set(anchors)):
        yield f"page: no anchor #{url}"
    for anchor in sorted({a for a in anchors if anchors.count(a) > 1}):
        yield f"page: two anchors #{anchor}"
    for url in sorted(set(re.findall(r'(?:src|href)="(?:https?:)?//([^"]*)"', page))):
        yield f"page: an external resource: {url}"


def markdown_page(book: Book, title: str) -> str:
    """One file for pandoc or another typesetter: explicit anchors, links within the file."""
    out = [f"---\ntitle: {title}\nlang: en\ntoc: true\n---\n"]
    for chapter in book.chapters:
        target, fenced = target_in(book, chapter), False
        for line in chapter.text.splitlines():
            fenced ^= line.startswith("```")
            if line.startswith("<!--"):
                continue
            if not fenced and (m := re.match(r"(#{1,3}) (.*)", line)):
                number = re.match(rf"({NUMBER}) ", m.group(2))
                anchor = chapter.stem if len(m.group(1)) == 1 else f"{chapter.stem}-{number.group(1) if number else slug(m.group(2))}"
                line = f"{line} {{#{anchor}}}"
            elif not fenced:
                line = re.sub(r"\]\(([^)\s]+)\)", lambda u: f"]({of_number(book, target(u.group(1)))})", line)
            out.append(line)
        out.append("")
    return "\n".join(out)


def of_number(book: Book, url: str) -> str:
    """#40-rigid-2-packet as #40-rigid-2: headings of the Markdown file have one anchor each."""
    for chapter in book.chapters:
        for _, heading in chapter.headings:
            number = re.match(rf"({NUMBER}) ", heading)
            if number and url == f"#{chapter.stem}-{slug(heading)}":
                return f"#{chapter.stem}-{number.group(1)}"
    return url
