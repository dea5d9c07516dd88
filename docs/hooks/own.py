"""No page of the site loads anything from elsewhere: it is read where there is no network too."""

import re

LOADS = re.compile(
    r'<(?:script|img|iframe)[^>]+src="https?:[^"]*"|<link[^>]+rel="stylesheet"[^>]+https?:'
)


def on_post_page(output, page, **_):
    if found := LOADS.search(output):
        raise ValueError(f"{page.file.src_uri} loads from elsewhere: {found[0]}")
    return output
