"""Which software writes results: another one may write other bytes.

It is found without importing any of what computes, since a cluster's workers are asked for it before all else. Where
`vqf` is "not installed", our own port of it computes, whose source is digested with the rest.
"""

import hashlib
from functools import cache
from pathlib import Path

from app.system.logs import version_of

CODE = Path(__file__).parents[3]
ROOMS = ("app", "core", "devices")
BYTES_FROM = ("gaitwright", "numpy", "scipy", "vqf", "pyarrow", "rerun-sdk", "typst")  # the next may give another bit


@cache
def software() -> str:
    """SHA-256 of all that computes and writes: our own source, and versions of the libraries that the bytes rest on."""
    source = hashlib.sha256(", ".join(f"{name} {version_of(name)}" for name in BYTES_FROM).encode())
    for room in ROOMS:
        for path in sorted((CODE / room).rglob("*.py")):
            source.update(path.relative_to(CODE).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return source.hexdigest()
