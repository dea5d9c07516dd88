"""The gallery: runs every script of examples/ and makes its page; one that fails ends the build.

Each figure is saved twice, for the light and for the dark page: blacks and greys are inverted, colours stay.
"""

import ast
import colorsys
import importlib.util
import io
import logging
import re
import time
from pathlib import Path

from mkdocs.structure.files import File, InclusionLevel

log = logging.getLogger("mkdocs.hooks.gallery")
ROOT = Path(__file__).parents[2]
COLOUR = re.compile(r"#[0-9a-fA-F]{6}\b")


def scripts():
    """Scripts of the gallery: those that say in a docstring what their picture shows."""
    return sorted(p for p in (ROOT / "examples").glob("*.py") if not p.name.startswith("_"))


def described(path):
    """Title and caption, from the docstring."""
    title, _, caption = (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").partition("\n\n")
    if not caption:
        raise ValueError(f"{path.name}: the docstring needs a title and a caption")
    return title.rstrip("."), " ".join(caption.split())


def computed(path):
    """Results and figure of a script; the figure is None for one that draws nothing."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    results = module.main()
    return results, module.figure(results) if hasattr(module, "figure") else None


def dark(svg):
    """The same picture on a dark page."""

    def turned(match):
        r, g, b = (int(match[0][i : i + 2], 16) / 255 for i in (1, 3, 5))
        h, lightness, s = colorsys.rgb_to_hls(r, g, b)
        grey = max(r, g, b) - min(r, g, b) < 0.06
        if grey:
            lightness = 0.12 + 0.78 * (1.0 - lightness)
        elif lightness < 0.38:
            lightness = 0.5 + 0.3 * lightness
        return "#" + "".join(f"{round(255 * c):02x}" for c in colorsys.hls_to_rgb(h, lightness, s))

    head, images, tail = svg.partition("<image")  # pictures inside stay as they are
    svg = COLOUR.sub(turned, head) + images + tail if not images else recoloured(svg, turned)
    return svg.replace("<svg ", '<svg fill="#e6e6e6" ', 1)


def recoloured(svg, turned):
    parts = re.split(r"(<image\b.*?/>|<image\b.*?</image>)", svg, flags=re.S)
    return "".join(p if p.startswith("<image") else COLOUR.sub(turned, p) for p in parts)


def drawn(figure):
    """The figure as SVG, without background, letters as outlines so that they are the same everywhere."""
    import matplotlib as mpl

    with mpl.rc_context({"svg.fonttype": "path", "svg.hashsalt": "microswim", "savefig.dpi": 130}):
        out = io.StringIO()
        figure.savefig(out, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    return out.getvalue()


def page(path, title, caption, results, picture):
    numbers = [(k, v) for k, v in results.items() if isinstance(v, float)] if isinstance(results, dict) else []
    rows = "".join(f"| {k} | {v:.4g} |\n" for k, v in numbers)
    shown = f"""<figure markdown>
![{title}]({path.stem}-light.svg#only-light)
![{title}]({path.stem}-dark.svg#only-dark)
<figcaption markdown>{caption}</figcaption>
</figure>
"""
    return f"""# {title}

{shown if picture else caption}

{"| number | value |" + chr(10) + "|---|---|" + chr(10) + rows if rows else ""}

The script, `examples/{path.name}`:

```python
{path.read_text(encoding="utf-8").strip()}
```
"""


def index(entries):
    cards = []
    for path, title, picture in entries:
        images = "".join(f"![{title}]({path.stem}-{s}.svg#only-{s})" for s in ("light", "dark")) if picture else ""
        cards.append(f"- [{images} {title}]({path.stem}.md)")
    text = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    return text.replace("<!-- cards -->", '<div class="gallery" markdown>\n\n' + "\n".join(cards) + "\n\n</div>")


def on_files(files, config):
    made, entries = {}, []
    for path in scripts():
        start = time.perf_counter()
        title, caption = described(path)
        results, figure = computed(path)
        if figure is not None:
            light = drawn(figure)
            made[f"gallery/{path.stem}-light.svg"], made[f"gallery/{path.stem}-dark.svg"] = light, dark(light)
        made[f"gallery/{path.stem}.md"] = page(path, title, caption, results, figure is not None)
        entries.append((path, title, figure is not None))
        log.info("gallery: %s in %.1f s", path.name, time.perf_counter() - start)
    made["gallery/index.md"] = index(entries)
    for uri, content in made.items():
        level = InclusionLevel.INCLUDED if uri.endswith("index.md") else InclusionLevel.NOT_IN_NAV
        files.append(File.generated(config, uri, content=content, inclusion=level))
    return files
