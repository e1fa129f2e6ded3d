"""What others published about changes of timed tests: how large one must be to be detected, and to matter.

A figure is of the people, the laboratory and the way of testing that it was found in. None of these judges a change
here: that is done by our own error between visits, where it is known (see `attempts`). They stand beside it, with
their sources. A figure of which fewer than two independent sources could be read is unverified and prints a dagger.
"""

from dataclasses import dataclass
from enum import StrEnum

from core.timed.measures import COLUMNS
from core.timed.protocols import TimedProtocol


class Population(StrEnum):
    """Whose changes they are."""

    LIMB_LOSS = "lower limb loss"
    STROKE = "stroke"
    OSTEOARTHRITIS = "hip or knee osteoarthritis or replacement"
    PARKINSON = "Parkinson's disease"


class ChangeKind(StrEnum):
    """DETECTABLE: beyond measurement error, at 90 or 95 %. IMPORTANT: that matters to patients, or goes with it."""

    DETECTABLE = "minimal detectable change"
    IMPORTANT = "minimal clinically important difference"


@dataclass(frozen=True, slots=True)
class PublishedChange:
    """The least change, `low` to `high` over its sources and groups of patients, in the unit of `column`.

    `read`: sources that were read. `unread`: those that are cited for it and could not be read.
    """

    column: str
    population: Population
    kind: ChangeKind
    low: float
    high: float
    read: tuple[str, ...] = ()
    unread: tuple[str, ...] = ()

    @property
    def is_verified(self) -> bool:
        """Whether two independent sources were read."""
        return len(self.read) >= 2

    @property
    def sources(self) -> tuple[str, ...]:
        return (*self.read, *self.unread)


_SPEED, _TWO, _SIX, _CHAIR, _RISES = (
    COLUMNS[protocol]
    for protocol in (
        TimedProtocol.TEN_METRES,
        TimedProtocol.TWO_MINUTES,
        TimedProtocol.SIX_MINUTES,
        TimedProtocol.UP_AND_GO,
        TimedProtocol.SIT_TO_STAND,
    )
)
_LOSS, _STROKE, _ARTHRITIS, _PARKINSON = Population
_MDC, _MCID = ChangeKind
_CARSE = "Carse et al. 2021, doi 10.1016/j.gaitpost.2021.06.001 (95 %: 0.13-0.29 m/s, 29-46 m; one K-level)"
_STEFFEN = "Steffen & Seney 2008, doi 10.2522/ptj.20070214 (95 %)"
_RESNIK = "Resnik & Borgia 2011, doi 10.2522/ptj.20100287 (90 %)"
_TORINO = "Arch Physioter 2024, doi 10.33393/aop.2024.3267 (hip replaced two days before, 95 %)"
_KENNEDY = "Kennedy et al. 2005, doi 10.1186/1471-2474-6-3 (before hip or knee replacement, 90 %)"

PUBLISHED: tuple[PublishedChange, ...] = (
    PublishedChange(_SPEED, _LOSS, _MCID, 0.21, 0.21, (_CARSE,)),
    PublishedChange(
        _SPEED,
        _STROKE,
        _MDC,
        0.05,
        0.21,
        (
            "Hosoi et al. 2023, doi 10.3389/fneur.2023.1219505 (below 0.4, to 0.8 and above 0.8 m/s)",
            "Lewek & Sykes 2019, J Neurol Phys Ther (the same groups: 0.10, 0.15, 0.18 m/s; 95 %)",
        ),
    ),
    PublishedChange(
        _SPEED,
        _STROKE,
        _MCID,
        0.13,
        0.16,
        ("Tilson et al. 2010, doi 10.2522/ptj.20090079", "Bohannon et al. 2013, doi 10.1589/jpts.25.1223"),
    ),
    PublishedChange(_SPEED, _ARTHRITIS, _MDC, 0.16, 0.16, (_TORINO,)),
    PublishedChange(
        _SPEED, _ARTHRITIS, _MCID, 0.07, 0.12, ("Gilbert et al. 2021, doi 10.1002/acr.24159 (20 m; knee)",)
    ),
    PublishedChange(_SPEED, _PARKINSON, _MDC, 0.09, 0.18, (_STEFFEN, "Combs et al. 2014, NeuroRehabilitation (95 %)")),
    PublishedChange(
        _SPEED,
        _PARKINSON,
        _MCID,
        0.06,
        0.14,
        (
            "Hass et al. 2014, doi 10.1097/NPT.0000000000000055 (small and moderate)",
            "Gait Posture 2024, doi 10.1016/j.gaitpost.2023.11.016 (0.082 m/s)",
        ),
    ),
    PublishedChange(_TWO, _LOSS, _MCID, 37.0, 37.0, (_CARSE,)),
    PublishedChange(_SIX, _LOSS, _MDC, 45.0, 45.0, (), (_RESNIK,)),
    PublishedChange(
        _SIX,
        _STROKE,
        _MDC,
        45.0,
        75.0,
        (
            "Fulk et al. 2008, doi 10.1080/09593980701588284 (54 m, 90 %)",
            "Morressier 2017, reliability of stroke-specific protocols (laps of 15 and 30 m, 95 %)",
        ),
    ),
    PublishedChange(
        _SIX, _STROKE, _MCID, 34.0, 71.0, ("Fulk & He 2018, doi 10.1097/NPT.0000000000000236 (from below 0.4 m/s on)",)
    ),
    PublishedChange(_SIX, _ARTHRITIS, _MDC, 61.0, 61.0, (), (_KENNEDY,)),
    PublishedChange(
        _SIX, _ARTHRITIS, _MCID, 74.0, 74.0, ("BMC Musculoskelet Disord 2022, doi 10.1186/s12891-022-05262-4 (knee)",)
    ),
    PublishedChange(_SIX, _PARKINSON, _MDC, 82.0, 82.0, (_STEFFEN,)),
    PublishedChange(_CHAIR, _LOSS, _MDC, 3.6, 3.6, (), (_RESNIK,)),
    PublishedChange(
        _CHAIR,
        _STROKE,
        _MDC,
        2.9,
        3.2,
        ("Alghadir et al. 2018, doi 10.1186/s12883-018-1146-9 (3.2 s)",),
        ("Flansbjer et al. 2005, doi 10.1080/16501970410017215 (2.9 s)",),
    ),
    PublishedChange(
        _CHAIR,
        _ARTHRITIS,
        _MDC,
        1.1,
        2.5,
        ("Alghadir et al. 2015, doi 10.1186/s12891-015-0637-8 (knee, 1.1 s)", _TORINO),
        (_KENNEDY,),
    ),
    PublishedChange(
        _CHAIR, _ARTHRITIS, _MCID, 0.8, 1.4, (), ("Wright et al. 2011, doi 10.2519/jospt.2011.3515 (hip)",)
    ),
    PublishedChange(_CHAIR, _PARKINSON, _MDC, 3.5, 3.5, ("Huang et al. 2011, doi 10.2522/ptj.20090126",)),
    PublishedChange(
        _RISES, _STROKE, _MCID, 0.7, 3.0, ("Agustín et al. 2021, doi 10.3390/ijerph18052314 (by how far they walk)",)
    ),
    PublishedChange(
        _RISES, _ARTHRITIS, _MDC, 1.7, 1.7, ("Amano & Suzuki 2018, doi 10.2490/prm.20180022 (knee, 95 %)",)
    ),
    PublishedChange(
        _RISES, _PARKINSON, _MDC, 10.0, 10.0, ("Petersen et al. 2017, doi 10.1519/JPT.0000000000000102 (95 %)",)
    ),
)


def published_changes(column: str, population: Population | None = None) -> tuple[PublishedChange, ...]:
    """What is published of one test's figure, of one population or of all; empty where nothing is in the table."""
    of_column = (one for one in PUBLISHED if one.column == column)
    return tuple(one for one in of_column if population is None or one.population is population)
