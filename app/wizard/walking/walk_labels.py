"""Labels that the next walk may have."""

from collections.abc import Sequence

from app.wording.recordings import ALIGNMENT, LETTERS, is_alignment, name_in_words
from app.wording.translation import tr
from core.session import Patient

MOST = 9  # as many as there are digits on caps
ALIGNMENTS = 3


def labels_for(patient: Patient, used: Sequence[str]) -> tuple[str, ...]:
    """Give the labels to choose from: the usual ones, then those of this session's walks."""
    used = [name_in_words(label) for label in used]
    count = max(ALIGNMENTS, sum(label in _alignments(len(LETTERS)) for label in set(used)) + 1)
    usual = [tr("Barefoot"), tr("Shoes"), tr("AFO")]
    if patient.prosthetic_sides:
        usual = [*_alignments(count), tr("Barefoot"), tr("Shoes")]
    else:
        usual += _alignments(1)
    others = [label for label in dict.fromkeys(used) if label and label not in usual]
    kept = others[-MOST:]
    return (*usual[: MOST - len(kept)], *kept)


def label_after(patient: Patient, used: Sequence[str]) -> str:
    """Give what the next walk is most likely called: the first alignment not walked with, or the label as before."""
    alignments, stored = _alignments(len(LETTERS)), used
    used = [name_in_words(label) for label in used]
    if stored and not is_alignment(stored[-1]):
        return stored[-1]
    if used or patient.prosthetic_sides:
        return next((label for label in alignments if label not in used), alignments[-1])
    return tr("Barefoot") if "barefoot" in patient.aids else tr("Shoes")


def stored_label(label: str, used: Sequence[str]) -> str:
    """Give a label as it is stored with this session's walks, which may have been begun in another language."""
    return next((one for one in used if name_in_words(one) == label), label)


def new_alignment(letter: str, used: Sequence[str]) -> str:
    """Give what an alignment is called that was not walked with before: by its letter, or the first label not used."""
    used = [name_in_words(label) for label in used]
    required = tr(ALIGNMENT).format(letter=letter)
    free = [label for label in _alignments(len(LETTERS)) if label not in used]
    return required if required in free else next(iter(free), required)


def _alignments(count: int) -> list[str]:
    return [tr(ALIGNMENT).format(letter=letter) for letter in LETTERS[:count]]
