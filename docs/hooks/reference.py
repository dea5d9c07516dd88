"""The reference: a page for each public name, in the sections of api.md, which lists them."""

import inspect
import re

from mkdocs.structure.files import File

import microswim

LISTED = re.compile(r"^::: microswim\.(\w+)$", re.MULTILINE)
PAGE = "api.md"
#: A package that is called, by the function that it calls (decisions/0018-path-is-called.md).
MEANT = {"path": "path.following.path"}


def address(name):
    """Path of a name's page; classes apart, since some disks know no capitals."""
    kind = "class" if inspect.isclass(getattr(microswim, name)) else "function"
    return f"api/{kind}/{name}.md"


def sections(text):
    """Title of each section and the names in it."""
    for part in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        title, _, rest = part.partition("\n")
        if names := LISTED.findall(rest):
            yield title.strip(), names


def on_config(config):
    """The sections below the reference in the navigation."""
    with open(f"{config['docs_dir']}/{PAGE}", encoding="utf-8") as file:
        below = [{t: [{n: address(n)} for n in names]} for t, names in sections(file.read())]
    for entry in config["nav"]:
        if entry.get("API") == PAGE:
            entry["API"] = [PAGE, *below]
    return config


def on_files(files, config):
    text = files.get_file_from_path(PAGE).content_string
    for name in LISTED.findall(text):
        options = "    options:\n      show_root_heading: false\n"
        content = f"# {name}\n\n::: microswim.{MEANT.get(name, name)}\n{options}"
        files.append(File.generated(config, address(name), content=content))
    return files


def on_page_markdown(markdown, page, **_):
    """A line for each name in place of its whole documentation."""
    if page.file.src_uri != PAGE:
        return None

    def line(found):
        said = inspect.getdoc(getattr(microswim, found[1])).split("\n\n")[0].replace("\n", " ")
        return f"- [`{found[1]}`]({address(found[1])}): {said}"

    return LISTED.sub(line, markdown)
