"""Equations of the site's pages as MathML, which a browser shows by itself: nothing is fetched at reading time.

A hook of the site's builder. On a page `$x$` is an equation in a line, and a fence called `math` one of its own.
"""

import re
from typing import Any

from latex2mathml.converter import convert

BLOCK = re.compile(r"(?ms)^```math\n(.*?)^```$")
INLINE = re.compile(r"(?<![\\$\w])\$(?=\S)([^$\n]+?)(?<=\S)\$(?![\w$])")
CODE = re.compile(r"(?ms)^```.*?^```$|`[^`\n]*`")


def on_page_markdown(markdown: str, page: Any, **_: object) -> str:
    """Replace the equations of the pages of methods; elsewhere a dollar is a dollar."""
    return with_equations(markdown) if page.file.src_uri.startswith("methods/") else markdown


def with_equations(markdown: str) -> str:
    shown = BLOCK.sub(lambda found: _block(found[1]), markdown)
    parts, end = [], 0
    for code in CODE.finditer(shown):
        parts += [INLINE.sub(_in_line, shown[end : code.start()]), code[0]]
        end = code.end()
    return "".join([*parts, INLINE.sub(_in_line, shown[end:])])


def _in_line(found: re.Match[str]) -> str:
    return f"<span>{convert(found[1])}</span>"  # a line that begins with <math> would be a block of its own


def _block(text: str) -> str:
    lines = "".join(convert(line, display="block") for line in text.strip().split("\n\n"))
    return f'<div class="equation" tabindex="0">{lines}</div>\n'
