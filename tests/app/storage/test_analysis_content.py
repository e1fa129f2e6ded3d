"""What is kept of an analysis is read back whole or refused, and nothing else than an analysis is kept."""

import hashlib
import json
from dataclasses import replace

import numpy as np
import pytest

from app.storage.analysis_content import DIGEST, LENGTH, DamagedContentError, packed, unpacked
from core.results import Analysis
from devices.simulation.walker import DEMONSTRATION, Standing
from tests.simulated import analysis_of, session_of


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    return analysis_of(session_of(replace(DEMONSTRATION, recordings=(Standing(),))))


def sealed(outline: object, arrays: bytes = b"") -> bytes:
    """Content whose digest is right, whatever it holds."""
    text = json.dumps(outline).encode()
    content = len(text).to_bytes(LENGTH, "little") + text + arrays
    return hashlib.sha256(content).digest() + content


def test_it_comes_back_and_the_same_gives_the_same_bytes(analysis: Analysis) -> None:
    content = packed(analysis)
    assert packed(unpacked(content)) == content


def test_another_byte_anywhere_is_damage(analysis: Analysis) -> None:
    content = packed(analysis)
    for at in (0, DIGEST, DIGEST + LENGTH, len(content) - 1):
        with pytest.raises(DamagedContentError):
            unpacked(content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :])
    with pytest.raises(DamagedContentError):
        unpacked(content[:-1])


@pytest.mark.parametrize(
    "outline",
    [
        ["no analysis"],
        {"unknown": 1},
        {"word": ["NoSuchWord", "left"]},
        {"value": ["NoSuchValue", []]},
        {"array": ["|O", [1], "C"]},
        {"array": ["<f8", [1], "A"]},
        {"array": ["<f8", [4], "C"]},
    ],
)
def test_what_is_sealed_and_no_analysis_is_refused(outline: object) -> None:
    with pytest.raises(DamagedContentError):
        unpacked(sealed(outline))


@pytest.mark.parametrize("strange", [np.array([object()]), object(), 1j])
def test_what_no_analysis_holds_is_not_kept(analysis: Analysis, strange: object) -> None:
    odd = replace(analysis, recordings=(strange,))  # type: ignore[arg-type]  # what must not be kept
    with pytest.raises(TypeError, match="an analysis holds no"):
        packed(odd)
