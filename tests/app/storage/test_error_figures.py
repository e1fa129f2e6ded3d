"""A library keeps the study that its differences are judged by, for administrators to choose."""

import pytest

from app.storage.error_figures import SETTING, choose_study, chosen_study, figures_of
from app.storage.library import Library
from app.storage.stored import NotAllowedError, Operator, Role
from core.verdicts.sigmas import PUBLISHED, OwnStudy
from tests.app.cohort.repeatability.own_study import own_study


def test_a_study_is_chosen_and_given_up_again(library: Library) -> None:
    assert figures_of(library) is PUBLISHED
    choose_study(library, own_study())
    assert figures_of(library).study == OwnStudy(20, "2026-11-12")
    choose_study(library, None)
    assert figures_of(library) is PUBLISHED


def test_an_administrator_alone_chooses(library: Library) -> None:
    library.operators.add(Operator("vw", "V. Wirth", Role.VIEWER))
    library.log_in("vw")
    with pytest.raises(NotAllowedError):
        choose_study(library, own_study())
    assert figures_of(library) is PUBLISHED


def test_figures_that_cannot_be_read_are_not_used(library: Library) -> None:
    library.settings.put(SETTING, {"format": "gaitwright-repeatability/2"})
    assert chosen_study(library) is None
    assert figures_of(library) is PUBLISHED
