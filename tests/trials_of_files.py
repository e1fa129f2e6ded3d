"""One recording of files of another program, read in this process, or refused."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import pytest

from core.body import Site
from devices.files.imports import ImportedFiles, place_trial
from devices.files.refusal import FileRefusedError
from devices.files.trial import ImportedTrial


def import_with(
    trial: Callable[[Sequence[Path], float | None], ImportedTrial],
    files: Sequence[Path],
    placement: Mapping[Site, str],
    recording: str,
    rate_hz: float | None = None,
) -> ImportedFiles:
    """What `trial` reads of the files, at these sites."""
    return place_trial(trial(files, rate_hz), placement, recording)


def refused(read: Callable[..., object], *given: object, **named: object) -> str:
    """The one line by which these files are refused."""
    with pytest.raises(FileRefusedError) as caught:
        read(*given, **named)
    assert str(caught.value).isprintable()
    return str(caught.value)
