"""Formulas in TeX, turned into MathML when the site is built: no script, no font from elsewhere.

``$...$`` within a line, ``$$...$$`` as a block of its own; ``\\tag{5}`` numbers it (5) and gives it
the anchor ``eq-5``.
"""

import re
import xml.etree.ElementTree as etree

from latex2mathml.converter import convert
from markdown.blockprocessors import BlockProcessor
from markdown.extensions import Extension
from markdown.inlinepatterns import InlineProcessor
from markdown.util import AtomicString

INLINE = r"(?<![\\$])\$(?![\s$])([^$\n]+?)(?<!\s)\$"
TAG = re.compile(r"\\tag\{([\w-]+)\}")
BOLD = re.compile(r'<mi mathvariant="bold">([A-Za-z]|&#x003A9;)</mi>')
MATRIX = re.compile(r"<mo>&#x0005B;</mo><mtable>(.*?)</mtable><mo>&#x0005D;</mo>", re.DOTALL)
PRIME = re.compile(r"<msup>((?:(?!<msup>).)*?)<mi>&#x02032;</mi></msup>")
RAISED = r'<mrow>\1<mo lspace="0" rspace="0.1em">&#x02032;</mo></mrow>'
BOTH = re.compile(
    r"<msubsup>(<m[in]>[^<]*</m[in]><m[in]>[^<]*</m[in]>)<mi>&#x02032;</mi></msubsup>"
)
INTEGRAL = "<mo>&#x0222B;</mo>"


def bold(match):
    """Browsers know bold letters only as characters of their own."""
    letter = match[1]
    if len(letter) > 1:
        return "<mi>&#x1D6C0;</mi>"  # Omega
    start, first = (0x1D400, "A") if letter.isupper() else (0x1D41A, "a")
    return f"<mi>{chr(ord(letter) + start - ord(first))}</mi>"


def mathml(tex, display):
    """MathML of a formula; brackets and integrals that also grow where no font for formulas is."""
    text = convert(tex.strip(), display=display)
    if "\\" in re.sub(r"<[^>]*>", "", text) or "<mi>&</mi>" in text:
        raise ValueError(f"no MathML for {tex!r}")
    text = MATRIX.sub(r'<mtable class="matrix">\1</mtable>', BOLD.sub(bold, text))
    text = BOTH.sub(r"<msup><msub>\1</msub><mi>&#x02032;</mi></msup>", text)
    text = PRIME.sub(RAISED, text)  # the character is raised already
    if display == "block":
        text = text.replace(
            INTEGRAL, INTEGRAL.replace("<mo", '<mo class="integral" largeop="false"')
        )
    return text


class Inline(InlineProcessor):
    def handleMatch(self, m, data):
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
    def extendMarkdown(self, md):
        md.inlinePatterns.register(Inline(INLINE, md), "tex", 185)
        md.parser.blockprocessors.register(Block(md.parser), "tex", 95)


def on_config(config):
    config.markdown_extensions.append(Formulas())
    return config
