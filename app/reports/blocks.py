"""Elements of a page. Headings, texts, tables and figures, as the template takes them."""

from collections.abc import Sequence
from dataclasses import dataclass

from app.charts.drawing import Picture

Block = dict[str, object]


@dataclass(frozen=True, slots=True)
class Cell:
    """One cell's words, over `span` columns, or a picture in their place."""

    stated: str
    is_bold: bool = False
    is_grey: bool = False
    span: int = 1
    is_centred: bool = False
    picture: Picture | None = None


@dataclass(frozen=True, slots=True)
class Column:
    """A column's heading; `width` as the template knows it ("auto", "1fr"); numbers stand to the right."""

    title: str
    width: str = "auto"
    is_number: bool = True


Row = Sequence[Cell | str] | str
"""Cells, or the words over a group of rows."""


def heading(stated: str, level: int = 1) -> Block:
    return {"kind": "heading", "said": stated, "level": level}


def note(stated: str) -> Block:
    return {"kind": "note", "said": stated}


def paragraph(stated: str) -> Block:
    return {"kind": "paragraph", "said": stated}


def bullets(stated: Sequence[str]) -> Block:
    return {"kind": "bullets", "said": list(stated)}


def figures(pictures: Sequence[Picture], columns: int = 1) -> Block:
    return {"kind": "figures", "pictures": [one.as_data() for one in pictures], "columns": columns}


def legend(items: Sequence[tuple[Picture, str]], columns: int = 3) -> Block:
    entries = [{"picture": swatch.as_data(), "said": stated} for swatch, stated in items]
    return {"kind": "legend", "items": entries, "columns": columns}


def if_room(blocks: Sequence[Block]) -> Block:
    """What is printed only where its page has the room: it explains, and what it explains can be read without it."""
    return {"kind": "if_room", "blocks": list(blocks)}


def table(columns: Sequence[Column], rows: Sequence[Row], *, is_dense: bool = False) -> Block:
    return {
        "kind": "table",
        "columns": [{"title": c.title, "width": c.width, "is_number": c.is_number} for c in columns],
        "rows": [{"group": row} if isinstance(row, str) else {"cells": [_cell(cell) for cell in row]} for row in rows],
        "is_dense": is_dense,
    }


def _cell(cell: Cell | str) -> dict[str, object]:
    one = Cell(cell) if isinstance(cell, str) else cell
    return {
        "said": one.stated,
        "bold": one.is_bold,
        "grey": one.is_grey,
        "span": one.span,
        "centred": one.is_centred,
        "picture": one.picture.as_data() if one.picture is not None else None,
    }
