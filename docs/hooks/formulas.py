"""Formulas in TeX, turned into MathML when the site is built: no script, no font from elsewhere.

``$...$`` within a line, ``$$...$$`` as a block of its own; ``\\tag{5}`` numbers it (5) and gives it the
anchor ``eq-5``.
"""

import re
import xml.etree.ElementTree as etree

from latex2mathml.converter import convert
from markdown.blockprocessors import BlockProcessor
from markdown.extensions import Extension
from markdown.inlinepatterns import InlineProcessor
from markdown.util import AtomicString

TAG = re.compile(r"\\tag\{([\w-]+)\}")
BOLD = re.compile(r'<mi mathvariant="bold">([A-Za-z])</mi>')


def mathml(tex, display):
    """MathML of a formula; browsers know bold letters only as characters of their own."""
    text = convert(tex.strip(), display=display)
    if "\\" in re.sub(r"<[^>]*>", "", text) or "<mi>&</mi>" in text:
        raise ValueError(f"no MathML for {tex!r}")
    shift = {True: 0x1D400 - ord("A"), False: 0x1D41A - ord("a")}
    return BOLD.sub(lambda m: f"<mi>{chr(ord(m[1]) + shift[m[1].isupper()])}</mi>", text)


class Inline(InlineProcessor):
    def handleMatch(self, m, data):  # noqa: N802
        return self.md.htmlStash.store(mathml(m[1], "inline")), m.start(0), m.end(0)


class Block(BlockProcessor):
    def test(self, parent, block):
        text = block.strip()
        return len(text) > 4 and text.startswith("$$") and text.endswith("$$")

    def run(self, parent, blocks):
        tex = blocks.pop(0).strip()[2:-2]
        tag = TAG.search(tex)
        box = etree.SubElement(parent, "div", {"class": "equation"})
        formula = etree.SubElement(box, "div", {"class": "formula"})
        stash = self.parser.md.htmlStash
        formula.text = AtomicString(stash.store(mathml(TAG.sub("", tex), "block")))
        if tag:
            name = f"eq-{tag[1].lower()}"
            box.set("id", name)
            number = etree.SubElement(box, "a", {"class": "number", "href": f"#{name}"})
            number.text = AtomicString(f"({tag[1]})")


class Formulas(Extension):
    def extendMarkdown(self, md):  # noqa: N802
        md.inlinePatterns.register(
            Inline(r"(?<![\\$])\$(?![\s$])([^$\n]+?)(?<!\s)\$", md), "tex", 185
        )
        md.parser.blockprocessors.register(Block(md.parser), "tex", 95)


def on_config(config):
    config.markdown_extensions.append(Formulas())
    return config
