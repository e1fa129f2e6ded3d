"""JSON for a server, which takes finite numbers only, as the standard has it: findings may hold others."""

import json
import math
from typing import Any

NOT_FINITE = "not finite"


def finite_json(value: object) -> str:
    """`value` as JSON; a number that is not finite becomes an object that names it."""
    try:
        return json.dumps(value, allow_nan=False)
    except ValueError:
        return json.dumps(_marked(value), allow_nan=False)


def from_finite_json(text: str | bytes) -> Any:
    """What `finite_json` was given."""
    return json.loads(text, object_hook=_unmarked)


def _marked(value: object) -> object:
    if isinstance(value, float) and not math.isfinite(value):
        return {NOT_FINITE: repr(value)}
    if isinstance(value, dict):
        return {key: _marked(one) for key, one in value.items()}
    return [_marked(one) for one in value] if isinstance(value, list | tuple) else value


def _unmarked(found: dict[str, Any]) -> Any:
    return float(found[NOT_FINITE]) if found.keys() == {NOT_FINITE} else found
