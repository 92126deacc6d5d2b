# SPDX-License-Identifier: Apache-2.0
"""Check a static site: every link of a page leads to a file and an anchor of the site, and nothing is loaded from elsewhere."""
import html.parser
import pathlib
import re
import tempfile
import urllib.parse

LOADED = {"src", "srcset", "data", "poster", "background"}  # attributes whose target a browser fetches by itself
EXTERNAL = re.compile(r"(?:[a-z][a-z0-9+.-]*:)?//", re.I)


class Page(html.parser.HTMLParser):
    """Anchors and links of one page."""

    def __init__(self, text):
        super().__init__()
        self.anchors, self.links, self.loaded = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        for name, value in attrs:
            if value is None:
                continue
            if name == "id" or (name == "name" and tag == "a"):
                self.anchors.append((name, value))
            elif name in LOADED or (tag == "link" and name == "href"):
                self.loaded.append(value)
            elif name == "href":
                self.links.append(value)
            elif name == "style":
                self.loaded += re.findall(r"url\(['\"]?([^'\")]+)", value)


def of_style(text):
    return re.findall(r"url\(\s*['\"]?([^'\")\s]+)", text) + re.findall(r"@import\s+['\"]([^'\"]+)", text)


def findings(site):
    """One sentence per link that leads nowhere, anchor that is there twice and thing that would be fetched from elsewhere."""
    texts = {path: path.read_text(encoding="utf-8", errors="replace") for path in sorted(site.rglob("*.html"))}
    read = {path: Page(text) for path, text in texts.items()}
    anchors = {path.resolve(): {name for _, name in page.anchors} for path, page in read.items()}
    found = []
    for path, page in read.items():
        name = path.relative_to(site)
        ids = [value for kind, value in page.anchors if kind == "id"]
        found += [f"{name}: two anchors #{anchor}" for anchor in sorted({a for a in ids if ids.count(a) > 1})]
        styles = [url for sheet in re.findall(r"<style[^>]*>(.*?)</style>", texts[path], re.S) for url in of_style(sheet)]
        for url in page.loaded + styles:
            found += [f"{name}: loads {url} from elsewhere"] if EXTERNAL.match(url) else wrong(site, path, url, anchors)
        for url in page.links:
            found += [] if re.match(r"[a-z][a-z0-9+.-]*:", url, re.I) else wrong(site, path, url, anchors)
    for path in sorted(site.rglob("*.css")):
        for url in of_style(path.read_text(encoding="utf-8")):
            if EXTERNAL.match(url):
                found.append(f"{path.relative_to(site)}: loads {url} from elsewhere")
    return sorted(set(found))


def wrong(site, path, url, anchors):
    """Why a link within the site leads nowhere."""
    name = path.relative_to(site)
    if url.startswith(("data:", "javascript:")):
        return []
    target, _, anchor = url.partition("#")
    target = urllib.parse.unquote(target.partition("?")[0])
    file = (path.parent / target).resolve() if target else path.resolve()
    if not file.is_relative_to(site.resolve()):
        return [f"{name}: {url} leads out of the site"]
    if not file.is_file():
        return [f"{name}: {url}: no such file"]
    anchor = urllib.parse.unquote(anchor)
    if anchor and anchor not in anchors.get(file, {anchor}):
        return [f"{name}: {url}: no such anchor"]
    return []


def self_test():
    good = {"index.html": '<h1 id="top">T</h1><a href="b/page.html#x">p</a><a href="https://example.org/">e</a><img src="f.svg">',
            "b/page.html": '<p id="x"><a href="../index.html#top">up</a> <a href="#x">here</a></p>', "f.svg": "<svg/>"}
    bad = [("index.html", '<a href="gone.html">', "no such file"), ("index.html", '<a href="b/page.html#y">', "no such anchor"),
           ("index.html", '<a href="#y">', "no such anchor"), ("index.html", '<a href="b">', "no such file"),
           ("index.html", '<a href="../../etc/hosts">', "leads out of the site"), ("index.html", '<img src="//example.org/a.png">', "from elsewhere"),
           ("index.html", '<script src="https://example.org/a.js"></script>', "from elsewhere"),
           ("index.html", '<link rel="stylesheet" href="https://example.org/a.css">', "from elsewhere"),
           ("index.html", '<p style="background: url(http://example.org/a.png)">', "from elsewhere"),
           ("index.html", '<style>@import "https://example.org/a.css";</style>', "from elsewhere"),
           ("style.css", "body { background: url('https://example.org/a.png') }", "from elsewhere"),
           ("index.html", '<p id="a"></p><p id="a"></p>', "two anchors #a"), ("index.html", '<img src="g.svg">', "no such file")]
    failed = 0
    for name, text, word in [("", "", None), *bad]:
        with tempfile.TemporaryDirectory() as scratch:
            site = pathlib.Path(scratch)
            for path, content in ({**good, name: good.get(name, "") + text} if name else good).items():
                (site / path).parent.mkdir(exist_ok=True)
                (site / path).write_text(content, encoding="utf-8")
            found = findings(site)
        if len(found) != (word is not None) or (word and word not in found[0]):
            print(f"self-test: {text or 'the good site'}: expected {word or 'no finding'}, found {found}")
            failed = 1
    print(f"links: {len(bad) + 1} sites")
    return failed
