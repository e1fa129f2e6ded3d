"""MATLAB files of any program: variables and structures that say by their names what they are, see `named_columns`.

A structure with acceleration and angular rates is a sensor, called as the structure is or as its text "name" states;
times, a rate and units may stand beside it or in a structure around it. Samples are vectors of one axis (`acc_x`),
matrices of three (`acc`, a column or a row for each axis), or one matrix with a cell of its columns' names. Tables and
timetables are objects that only MATLAB can open.

Held against files that MATLAB itself wrote (of versions 5 to 7.3, small ones, without sensors), not against recordings.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np

from core.samples import FloatArray
from devices.files.column_names import (
    XYZ,
    NamedQuantity,
    Quantity,
    is_unit,
    meaning_of,
    sensor_columns,
)
from devices.files.matlab_variables import ClosedObject, Variable, read_matlab
from devices.files.named_columns import trial_of_tables
from devices.files.named_table import NamedTable
from devices.files.refusal import FileRefusedError, quoted

OF_THREE_AXES = (Quantity.ACC, Quantity.FREE_ACC, Quantity.GYR, Quantity.MAG)
OF_ALL = (Quantity.TIME, Quantity.COUNTER)  # what a structure may give for those that it holds
UNITS = ("units", "unit")
NAMES = ("name", "label", "sensor", "location", "segment", "placement", "site", "id", "serial")
TABLES = ("table", "timetable", "timeseries")
TURN_TABLE = (
    "In MATLAB, convert a timetable with timetable2table(T), times with seconds(), and the table "
    'with table2struct(T, "ToScalar", true). Save that structure'
)


@dataclass(slots=True)
class _Group:
    """What is in one structure, as columns, and what it takes over from those around it."""

    path: tuple[str, ...] = ()
    columns: dict[str, FloatArray] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    rate_hz: float | None = None
    left_out: list[str] = field(default_factory=list)
    inner: list[tuple[str, Mapping[str, Variable]]] = field(default_factory=list)


def _tables(path: Path) -> Sequence[NamedTable]:
    variables = read_matlab(path)
    groups = list(_groups((), variables, _Group()))
    found = [one for one in groups if sensor_columns(list(one.columns), one.units)]
    if not found:
        for name, class_name in _closed(variables):
            if class_name in TABLES:
                raise FileRefusedError(
                    path.name,
                    "{name} is a MATLAB {kind}, which only MATLAB can open",
                    TURN_TABLE,
                    name=quoted(name),
                    kind=class_name,
                )
        everything = [name for one in groups for name in (*one.columns, *one.left_out)]
        found = [_Group(left_out=everything)]
    around = zip(*(one.path[:-1] for one in found), strict=False)
    common = sum(
        1 for _ in takewhile(lambda names: len(set(names)) == 1, around)
    )  # what is around all distinguishes no sensor
    calls = ["_".join(one.path[common:]) for one in found]
    return [
        NamedTable(
            columns=one.columns,
            where=path.name,
            file=str(path),
            called=(called if calls.count(called) == 1 else f"{called} {number}").strip() or path.stem,
            place=_sample,
            units=one.units,
            rate_hz=one.rate_hz,
            left_out=one.left_out,
        )
        for number, (one, called) in enumerate(zip(found, calls, strict=True), start=1)
    ]


matlab_trial = partial(trial_of_tables, "matlab", _tables)


def _groups(path: tuple[str, ...], variables: Mapping[str, Variable], around: _Group) -> Iterator[_Group]:
    """A structure, with times, rate and units of those around it, and all structures in it."""
    group = _group(path, variables)
    group.rate_hz = group.rate_hz if group.rate_hz is not None else around.rate_hz
    group.units = _of_columns(around.units, group.columns) | group.units
    has_times = any(_is_of_all(name) for name in group.columns)
    if not has_times:
        group.columns |= {name: values for name, values in around.columns.items() if _is_of_all(name)}
        group.units |= {name: unit for name, unit in around.units.items() if _is_of_all(name)}
    yield group
    for name, inner in group.inner:
        text = next((str(one) for key in NAMES if isinstance(one := inner.get(key), str) and one), "")
        yield from _groups((*path, text or name), inner, group)


def _group(path: tuple[str, ...], variables: Mapping[str, Variable]) -> _Group:
    group = _Group(path)
    lists = [value for value in variables.values() if isinstance(value, list) and len(value) > 1]
    texts: list[list[str]] = [value for value in lists if all(isinstance(one, str) for one in value)]
    reported: dict[str, str] = {}
    for name, value in variables.items():
        if isinstance(value, str):
            base = name.removesuffix("s").removesuffix("_unit")
            reported |= {base: value} if base != name.removesuffix("s") else {}
        elif isinstance(value, np.ndarray):
            _put(group, name, value, texts)
        elif isinstance(value, dict) and name.lower() in UNITS:
            reported |= {inner: unit for inner, unit in value.items() if isinstance(unit, str)}
        elif isinstance(value, dict) and _is_of_axes(meaning_of(name)):
            for inner, of_axis in value.items():
                if isinstance(of_axis, np.ndarray):
                    _put(group, f"{name}_{inner}", of_axis, [])
        elif isinstance(value, dict):
            group.inner.append((name, value))
        elif isinstance(value, list) and value and all(isinstance(one, dict) for one in value):
            group.inner += [(f"{name}_{k}", one) for k, one in enumerate(value, start=1)]
        elif isinstance(value, ClosedObject):
            group.left_out.append(name)
    group.units = _of_columns(reported, group.columns) | reported | group.units
    return group


def _put(group: _Group, name: str, values: FloatArray, texts: Sequence[list[str]]) -> None:
    """Numbers as columns: of one axis, of three, or of those that a list of texts names."""
    meaning = meaning_of(name)
    labels = [one for one in texts if len(one) == values.shape[1] and sensor_columns(one)]
    if values.size == 1:
        if meaning is not None and meaning.quantity is Quantity.SAMPLE_RATE and 0 < values.item() < np.inf:
            group.rate_hz = values.item()
    elif 1 in values.shape:
        _add(group, name, values.ravel())
    elif _is_of_axes(meaning) and (values.shape[1] == 3) != (values.shape[0] == 3):
        for axis, column in zip(XYZ, values.T if values.shape[1] == 3 else values, strict=True):
            _add(group, f"{name}_{axis}", column)
    elif len(labels) == 1 and len(set(labels[0])) == len(labels[0]):
        for label, column in zip(labels[0], values.T, strict=True):
            _add(group, label, column)
        for units in texts:
            if units is not labels[0] and len(units) == len(labels[0]) and all(is_unit(u) or not u for u in units):
                group.units |= dict(zip(labels[0], units, strict=True))
    else:
        group.left_out.append(name)


def _add(group: _Group, name: str, values: FloatArray) -> None:
    if name in group.columns:
        group.left_out.append(name)
    else:
        group.columns[name] = values


def _of_columns(reported: Mapping[str, str], columns: Mapping[str, FloatArray]) -> dict[str, str]:
    """The units of columns, given for these or for what they are the axes of."""
    found = {}
    for column in columns:
        base = column[:-2] if column[-2:].lower() in ("_x", "_y", "_z") else column
        if unit := reported.get(column) or reported.get(base):
            found[column] = unit
    return found


def _is_of_axes(meaning: NamedQuantity | None) -> bool:
    return meaning is not None and meaning.quantity in OF_THREE_AXES and not meaning.axis


def _is_of_all(name: str) -> bool:
    meaning = meaning_of(name)
    return meaning is not None and meaning.quantity in OF_ALL


def _closed(variables: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    for name, value in variables.items():
        inner = {f"{name}({k})": one for k, one in enumerate(value, 1)} if isinstance(value, list) else value
        if isinstance(value, ClosedObject):
            yield name, value.class_name
        elif isinstance(inner, dict):
            yield from _closed(inner)


def _sample(row: int) -> str:
    return f"sample {row + 1}"
