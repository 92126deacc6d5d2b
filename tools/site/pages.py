# SPDX-License-Identifier: Apache-2.0
"""Pages of a site from Markdown files, sources and folders of the tree. What a page links to comes with it."""
import html
import os
import pathlib
import re
import subprocess

from tools.book import Book
from tools.markdown import slug
from tools.page import SHARED_STYLE, html_page

START = ("README.md", "docs", "CONTRIBUTING.md", "CHANGELOG.md", "CODE_OF_CONDUCT.md", "SECURITY.md", "LICENSE",
         "conformance/README.md", "sim/scenes/README.md", "examples", "reports")
SPECIFICATION = pathlib.PurePosixPath("spec/index.html")
COPIED = {".svg", ".png", ".csv", ".json", ".toml", ".txt", ".tct"}  # shown or saved by the browser as they are
NAV = (("index.html", "Tactus"), ("docs/index.html", "Guides"), ("examples/index.html", "Examples"), ("api/index.html", "Libraries"),
       (str(SPECIFICATION), "Specification"), ("reports/index.html", "Reports"))
STYLE = SHARED_STYLE + """
main { max-width: 62rem; margin: 0 auto; padding: 1rem 1rem 6rem; overflow-wrap: break-word; }
h1 { font-size: 1.8rem; margin-top: 1rem; }
h2 { font-size: 1.35rem; border-bottom: 1px solid var(--line); padding-bottom: .2rem; }
h3 { font-size: 1.1rem; }
table { display: block; overflow-x: auto; }
img { max-width: 100%; background: #fff; border-radius: 4px; }
"""
# The bar stands on every page, those of doxygen and the specification too: its rules name nothing but itself.
BAR_STYLE = """
.site-bar { display: flex; flex-wrap: wrap; gap: .2rem 1.4rem; padding: .7rem 1.2rem; background: #1f2a38; font: 1rem/1.4 system-ui, sans-serif;
  grid-column: 1 / -1; }
.site-bar a { color: #c9d6e6; text-decoration: none; }
.site-bar a:hover, .site-bar a:first-child { color: #fff; }
.site-bar a:first-child { font-weight: 600; }
@media print { .site-bar { display: none; } }
"""


def bar(root):
    """in  root  relative path from the page to the top of the site, "" or "../" """
    items = "".join(f'<a href="{root}{target}">{title}</a>' for target, title in NAV)
    return f'<div class="site-bar">{items}</div>'


def page(title, body, output):
    root = "../" * (len(output.parts) - 1)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{html.escape(title)}</title>
<link rel="stylesheet" href="{root}site.css">
</head>
<body>
{bar(root)}
<main>
{body}
</main>
</body>
</html>
"""


def with_anchors(body):
    """Headings get the anchors that GitHub gives them."""
    seen = {}

    def anchored(match):
        name = slug(html.unescape(re.sub(r"<[^>]+>", "", match[2])))
        count = seen[name] = seen.get(name, -1) + 1
        return f'<h{match[1]} id="{name}-{count}">' if count else f'<h{match[1]} id="{name}">'
    return re.sub(r"<h([1-6])>(?=(.*?)</h\1>)", anchored, body, flags=re.S)


def title_of(path):
    """What a file or a folder is about, in its own words: a heading, or the first comment of a source after the licence."""
    if path.is_dir():
        return title_of(path / "README.md") if (path / "README.md").is_file() else ""
    if path.suffix == ".md":
        found = re.search(r"^# (.*)$", path.read_text(encoding="utf-8"), re.M)
    elif path.suffix in {".cpp", ".h", ".py"}:
        found = re.search(r'^(?:///?|""")(?!.*SPDX) ?(\S.*?)(?:"""|[.:;](?= |$)|$)', path.read_text(encoding="utf-8"), re.M)
    else:
        found = None
    return found[1] if found else ""


class Site:
    """Files of the tree and the places that they have in the site."""

    def __init__(self, root, out):
        self.root, self.out, self.todo, self.placed = root, out, [], {}
        self.stems = {c.name: c.stem for c in Book().chapters}

    def output_of(self, path):
        """Where a file or folder of the tree stands in the site; None: it is not there, and the link checker will say so."""
        if path in self.placed:
            return self.placed[path]
        source = self.root / path
        if source.is_dir():
            readme = path / "README.md"
            output = self.output_of(readme) if (self.root / readme).is_file() else path / "index.html"
        elif not source.is_file():
            return None
        elif path.name == "README.md":
            output = path.parent / "index.html"
        elif path.suffix == ".md":
            output = path.with_suffix(".html")
        else:
            output = path if path.suffix in COPIED else path.with_name(path.name + ".html")
        self.placed[path] = output
        self.todo.append(path)
        return output

    def target(self, path, url):
        """A link of the file `path`, as it must be in the site."""
        name, _, anchor = html.unescape(url).partition("#")
        if not name or re.match(r"[a-z][a-z0-9+.-]*:", name):
            return url
        sought = pathlib.PurePosixPath(os.path.normpath(path.parent / name))
        if sought.parent == SPECIFICATION.parent and sought.name in self.stems:
            stem = self.stems[sought.name]
            output, anchor = SPECIFICATION, f"{stem}-{anchor}" if anchor else stem
        else:
            output = SPECIFICATION if sought == SPECIFICATION.parent else self.output_of(sought)
        if output is None:
            return url
        relative = os.path.relpath(output, self.placed[path].parent)
        return html.escape(f"{relative}#{anchor}" if anchor else relative)

    def specification(self):
        book = SPECIFICATION.parent / "book"  # the page of all chapters stands for none of them
        self.placed[book] = SPECIFICATION
        text = html_page(Book(), "Tactus: specification")
        text = re.sub(r'\bhref="(?!#)([^"]*)"', lambda m: f'href="{self.target(book, m[1])}"', text)
        text = text.replace("</style>", BAR_STYLE + "</style>", 1).replace("<body>", "<body>\n" + bar("../"), 1)
        (self.out / SPECIFICATION).parent.mkdir(parents=True)
        (self.out / SPECIFICATION).write_text(text, encoding="utf-8")

    def markdown(self, path):
        text = (self.root / path).read_text(encoding="utf-8")
        done = subprocess.run(["cmark-gfm", "-e", "table", "-e", "strikethrough", "-e", "autolink"], input=text, capture_output=True,
                              text=True, check=True)
        body = re.sub(r'\b(href|src)="([^"]*)"', lambda m: f'{m[1]}="{self.target(path, m[2])}"', with_anchors(done.stdout))
        heading = re.search(r"<h1[^>]*>(.*?)</h1>", body, re.S)
        return re.sub(r"<[^>]+>", "", html.unescape(heading[1])) if heading else path.as_posix(), body

    def source(self, path):
        text = (self.root / path).read_text(encoding="utf-8")
        return path.as_posix(), f"<h1>{html.escape(path.as_posix())}</h1>\n<pre><code>{html.escape(text)}</code></pre>"

    def folder(self, path):
        rows = []
        for entry in sorted((self.root / path).iterdir(), key=lambda e: (e.is_file(), e.name)):
            if entry.name.startswith((".", "__")) or entry.name == "CMakeLists.txt":
                continue
            target = self.target(path / "-", entry.name)
            title = title_of(entry)
            rows.append(f'<li><a href="{target}">{html.escape(entry.name)}{"/" if entry.is_dir() else ""}</a>'
                        f'{": " + html.escape(title) if title else ""}</li>')
        return path.as_posix(), f"<h1>{html.escape(path.as_posix())}/</h1>\n<ul>\n" + "\n".join(rows) + "\n</ul>"

    def write(self, path):
        source, output = self.root / path, self.placed[path]
        if source.is_dir() and (source / "README.md").is_file():
            return  # its page is that of the file
        to = self.out / output
        to.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix in COPIED and source.is_file():
            to.write_bytes(source.read_bytes())
            return
        if source.is_dir():
            self.placed[path / "-"] = output  # links of a folder start inside it
            title, body = self.folder(path)
        else:
            title, body = self.markdown(path) if path.suffix == ".md" else self.source(path)
        to.write_text(page(title, body, output), encoding="utf-8")


def write(root, out):
    (out / "site.css").write_text(STYLE + BAR_STYLE, encoding="utf-8")
    site = Site(root, out)
    site.specification()
    for name in START:
        site.output_of(pathlib.PurePosixPath(name))
    while site.todo:
        site.write(site.todo.pop())


def self_test():
    given = "<h2>A <code>b</code>, c</h2><h2>Same</h2><h3>Same</h3>"
    wanted = '<h2 id="a-b-c">A <code>b</code>, c</h2><h2 id="same">Same</h2><h3 id="same-1">Same</h3>'
    failed = with_anchors(given) != wanted
    print(f"pages: headings {'WRONG: ' + with_anchors(given) if failed else 'good'}")
    return int(failed)
