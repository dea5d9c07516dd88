"""The gallery: runs every script of examples/ and makes its page; one that fails ends the build.

Scripts run beside each other, each in a process of its own with one thread: `gallery.py SCRIPT`
prints what `run` makes of it as JSON. The tests, which run them too, keep what they saw (`keep`):
as long as neither the script nor the package has changed since, it is not run a second time.
Each figure is saved twice, for the light and for the dark page: blacks and greys are inverted,
colours stay.
"""

import ast
import colorsys
import hashlib
import importlib.util
import io
import json
import logging
import os
import re
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

log = logging.getLogger("mkdocs.hooks.gallery")
ROOT = Path(__file__).parents[2]
KEEP = ROOT / "build" / "gallery"
LEFT_ALONE = re.compile(r'(<image\b.*?/>|<g id="Quad\w+">.*?</g>)', re.DOTALL)
COLOUR = re.compile(r"#[0-9a-fA-F]{6}\b")
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")


def scripts():
    """Scripts of the gallery, in folders of a subject too."""
    return sorted(p for p in (ROOT / "examples").rglob("*.py") if not p.name.startswith("_"))


def described(path):
    """Title and what else the docstring says."""
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    title, _, caption = text.partition("\n\n")
    if not caption:
        raise ValueError(f"{path.name}: the docstring needs a title and a caption")
    return title.rstrip("."), caption


def loaded(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def dark(svg):
    """The same picture for the dark page; maps and photographs inside stay as they are."""

    def turned(match):
        r, g, b = (int(match[0][i : i + 2], 16) / 255 for i in (1, 3, 5))
        h, lightness, s = colorsys.rgb_to_hls(r, g, b)
        if max(r, g, b) - min(r, g, b) < 0.06:
            lightness = 0.12 + 0.78 * (1.0 - lightness)
        elif lightness < 0.38:
            lightness = 0.55
        return "#" + "".join(f"{round(255 * c):02x}" for c in colorsys.hls_to_rgb(h, lightness, s))

    parts = LEFT_ALONE.split(svg)
    svg = "".join(p if LEFT_ALONE.fullmatch(p) else COLOUR.sub(turned, p) for p in parts)
    return svg.replace("<svg ", '<svg fill="#e6e6e6" ', 1)


def drawn(figure):
    """The figure as SVG without background; letters as outlines, the same everywhere."""
    import matplotlib as mpl

    with mpl.rc_context({"svg.fonttype": "path", "svg.hashsalt": "microswim", "savefig.dpi": 130}):
        out = io.StringIO()
        figure.savefig(
            out, format="svg", transparent=True, metadata={"Date": None, "Creator": None}
        )
    return out.getvalue()


PICTURES = """<figure markdown>
![{title}]({light}#only-light)
![{title}]({dark}#only-dark)
<figcaption markdown>

{caption}

</figcaption>
</figure>
"""


def page(path, title, caption, results, pictures):
    numbers = [(k, v) for k, v in results.items() if isinstance(v, float)]
    rows = "".join(f"| {k} | {v:.4g} |\n" for k, v in numbers)
    table = f"| number | value |\n|---|---|\n{rows}" if rows else ""
    shown = PICTURES.format(title=title, caption=caption, **pictures)
    code = path.read_text(encoding="utf-8").strip()
    where = path.relative_to(ROOT).as_posix()
    source = f"The script, `{where}`:\n\n```python\n{code}\n```\n"
    return f"# {title}\n\n{shown}\n{table}\n{source}"


def card(path, title, pictures):
    images = "".join(f"![{title}]({picture}#only-{shade})" for shade, picture in pictures.items())
    return f"- [{images} {title}]({path.stem}.md)"


def index(cards):
    """The page of cards; `cards` by folder."""
    text = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    for folder, entries in cards.items():
        block = '<div class="gallery" markdown>\n\n' + "\n".join(entries) + "\n\n</div>"
        text = text.replace(f"<!-- cards of {folder} -->", block)
    return text


def run(path):
    """What `composed` makes of a script that runs now."""
    module = loaded(path)
    results = module.main()
    return composed(path, results, module.figure(results))


def composed(path, results, figure):
    """Page, pictures and card of a script."""
    title, caption = described(path)
    light = drawn(figure)
    names = {shade: f"{path.stem}-{shade}.svg" for shade in ("light", "dark")}
    text = page(path, title, caption, results, names)
    files = {names["light"]: light, names["dark"]: dark(light), f"{path.stem}.md": text}
    return files, card(path, title, names)


def digest(path):
    """What a script's page hangs on, in one number: script, package, this file."""
    return hashlib.sha256(path.read_bytes() + _of_package()).hexdigest()


@cache
def _of_package():
    """The same of all that the scripts share: code and data of the package, this file."""
    found = hashlib.sha256(Path(__file__).read_bytes())
    for file in sorted((ROOT / "src").rglob("*")):
        if file.is_file() and "__pycache__" not in file.parts:
            found.update(file.read_bytes())
    return found.digest()


def keep(path, results, figure):
    """Keep a script's page for the next build of the site."""
    KEEP.mkdir(parents=True, exist_ok=True)
    kept = {"of": digest(path), "page": composed(path, results, figure)}
    (KEEP / f"{path.stem}.json").write_text(json.dumps(kept), encoding="utf-8")


def kept(path):
    """A page that was kept, None where there is none or its sources have changed."""
    file = KEEP / f"{path.stem}.json"
    found = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {"of": ""}
    return found["page"] if found["of"] == digest(path) else None


def made(path):
    """What `run` makes of a script, in a process of its own."""
    seen = kept(path)
    if seen:
        log.info("gallery: %s as the tests saw it", path.name)
        return seen
    start = time.perf_counter()
    command = [sys.executable, __file__, str(path)]
    done = subprocess.run(
        command, env=os.environ | ONE_THREAD, capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise RuntimeError(f"{path.relative_to(ROOT)} failed:\n{done.stderr}")
    log.info("gallery: %s in %.1f s", path.name, time.perf_counter() - start)
    return json.loads(done.stdout)


def on_files(files, config):
    from mkdocs.structure.files import File, InclusionLevel  # the tests run without it

    pages, cards, paths = {}, {}, scripts()
    with ThreadPoolExecutor(os.cpu_count()) as side_by_side:
        for path, (content, entry) in zip(paths, side_by_side.map(made, paths)):
            pages |= content
            cards.setdefault(path.parent.name, []).append(entry)
    pages["index.md"] = index(cards)
    for uri, content in pages.items():
        level = InclusionLevel.INCLUDED if uri == "index.md" else InclusionLevel.NOT_IN_NAV
        files.append(File.generated(config, f"gallery/{uri}", content=content, inclusion=level))
    return files


if __name__ == "__main__":
    json.dump(run(Path(sys.argv[1]).resolve()), sys.stdout)
