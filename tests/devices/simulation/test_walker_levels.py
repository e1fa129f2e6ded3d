"""Who wears a prosthesis of a stated level, knee and foot walks with what is left of the leg, and with these."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from core.body import Joint, Side, Site
from core.prosthesis import AmputationLevel, FootKind, KneeKind, Prosthesis
from core.samples import FloatArray
from devices.simulation.fitted_prosthesis import setting_of
from devices.simulation.walker import FreeMotion, SimulatedSession, Standing, Tissue, Walk, WalkerSettings
from devices.simulation.walker import simulate as made
from devices.simulation.walker_motion import LegMotion
from devices.simulation.walker_prosthesis import ProsthesisSetting, polycentric_shift_m

SIDE = Side.LEFT
TRANSTIBIAL, TRANSFEMORAL = AmputationLevel.TRANSTIBIAL, AmputationLevel.TRANSFEMORAL
PLAIN = WalkerSettings(
    seed=3,
    prosthetic_side=SIDE,
    recordings=(Standing(duration_s=1.0), FreeMotion(duration_s=4.0), Walk(strides=5)),
)


@cache
def simulate(fitted: Prosthesis, tissue: Tissue = Tissue.RIGID) -> SimulatedSession:
    return made(replace(PLAIN, fitted=fitted, tissue=tissue))


def walk_of(fitted: Prosthesis) -> LegMotion:
    return simulate(fitted).moved[-1].legs[SIDE]


def cycle(leg: LegMotion, angle: FloatArray, number: int = 3) -> FloatArray:
    """One stride, (101,), deg."""
    on = leg.events.initial_contact_s
    return np.rad2deg(np.interp(np.linspace(on[number], on[number + 1], 101), leg.time_s, angle))


def of_foot(kind: FootKind) -> Prosthesis:
    return Prosthesis(TRANSTIBIAL, foot=kind)


def swing_of(leg: LegMotion) -> FloatArray:
    """The ankle in the middle of a swing, deg."""
    ankle = cycle(leg, leg.angles.ankle)
    return ankle[75:95]


def across(leg: LegMotion, proximal: int) -> float:
    """How much a segment turns against the next one across its main axis, as a share of along it."""
    relative = np.swapaxes(leg.rotations[proximal], 1, 2) @ leg.rotations[proximal + 1]
    steps = np.swapaxes(relative[:-1], 1, 2) @ relative[1:]
    turned = [steps[:, i, k] - steps[:, k, i] for i, k in ((2, 1), (0, 2), (1, 0))]
    spread = np.linalg.svd(np.stack(turned), compute_uv=False)
    return float(spread[1] / spread[0])


@pytest.mark.parametrize("level", AmputationLevel)
def test_the_session_states_what_is_worn(level: AmputationLevel) -> None:
    assert simulate(Prosthesis(level)).session.patient.worn == {SIDE: Prosthesis(level)}


def test_of_a_prosthesis_that_is_not_stated_nothing_is() -> None:
    assert simulate(Prosthesis()).session.patient.prostheses == {}
    nobody = made(replace(PLAIN, prosthetic_side=None, fitted=of_foot(FootKind.SACH)))
    assert nobody.session.patient.prostheses == {}


def test_the_knee_above_a_transtibial_prosthesis_turns_as_a_person_s_and_a_prosthetic_one_about_one_axis() -> None:
    person = made(replace(PLAIN, prosthetic_side=None, tissue=Tissue.SOFT))
    off = {}
    for name, session in (
        ("person", person),
        ("transtibial", simulate(Prosthesis(TRANSTIBIAL), Tissue.SOFT)),
        ("transfemoral", simulate(Prosthesis(TRANSFEMORAL), Tissue.SOFT)),
    ):
        off[name] = across(session.moved[-1].legs[SIDE], 0)
    assert off["transtibial"] == pytest.approx(off["person"], rel=0.1)
    assert off["transfemoral"] < 0.01 < off["transtibial"]


def test_only_a_prosthetic_knee_is_as_its_kind() -> None:
    loading = slice(5, 30)
    knees = {
        kind: cycle(leg, leg.angles.knee) for kind in KneeKind for leg in [walk_of(Prosthesis(TRANSFEMORAL, kind))]
    }
    own = walk_of(Prosthesis(TRANSTIBIAL))
    own_knee = cycle(own, own.angles.knee)
    assert np.ptp(knees[KneeKind.LOCKED]) < 0.1
    for kind in (KneeKind.SINGLE_AXIS, KneeKind.POLYCENTRIC, KneeKind.FLUID_CONTROLLED):
        assert knees[kind][loading].max() < 8.0
    assert knees[KneeKind.FLUID_CONTROLLED][loading].max() < knees[KneeKind.MICROPROCESSOR][loading].max() - 2.0
    assert knees[KneeKind.MICROPROCESSOR][loading].max() < own_knee[loading].max()
    assert own_knee[loading].max() > 10.0
    assert min(knee.max() for kind, knee in knees.items() if kind is not KneeKind.LOCKED) > 50.0


def test_a_locked_knee_can_be_bent_by_hand() -> None:
    free = simulate(Prosthesis(TRANSFEMORAL, KneeKind.LOCKED)).moved[1].legs[SIDE]
    assert np.ptp(np.rad2deg(free.angles.knee)) > 40.0


def test_what_is_set_at_a_knee_moves_no_knee_that_is_the_patient_s() -> None:
    knee_set = ProsthesisSetting(stop_deg=6.0, extension=2.0, swing_flexion_deg=-15.0)
    walks = [
        made(replace(PLAIN, fitted=fitted, recordings=(Standing(), Walk(strides=6, prosthesis=setting))))
        for fitted in (Prosthesis(TRANSTIBIAL), Prosthesis(TRANSFEMORAL))
        for setting in (ProsthesisSetting(), knee_set)
    ]
    own, own_set, prosthetic, prosthetic_set = (one.moved[-1].legs[SIDE].angles.knee for one in walks)
    np.testing.assert_array_equal(own, own_set)
    assert np.rad2deg(np.abs(prosthetic - prosthetic_set).max()) > 8.0
    assert setting_of({}, Prosthesis(TRANSFEMORAL, KneeKind.MICROPROCESSOR)).stance_flexion == 0.5


def test_a_foot_without_a_joint_is_as_built_in_swing_and_bends_later_the_more_it_stores() -> None:
    sach, energy = walk_of(of_foot(FootKind.SACH)), walk_of(of_foot(FootKind.ENERGY_STORING))
    for leg in (sach, energy):
        assert np.abs(swing_of(leg)).max() < 1.5
    most = [cycle(leg, leg.angles.ankle) for leg in (sach, energy)]
    assert most[1].max() > most[0].max() + 4.0
    assert most[1].argmax() > most[0].argmax()
    assert (energy.events.heel_rise_s > sach.events.heel_rise_s).all()


def test_a_foot_with_an_axis_is_flat_sooner_and_a_hydraulic_ankle_stays_lifted_in_swing() -> None:
    flat_s = {}
    for kind in FootKind:
        events = walk_of(of_foot(kind)).events
        flat_s[kind] = float(np.mean(events.full_contact_s[:-1] - events.initial_contact_s[:-1]))
    rigid = min(flat_s[FootKind.SACH], flat_s[FootKind.ENERGY_STORING])
    assert all(flat_s[kind] < rigid for kind in FootKind if kind.has_joint)
    lifted = {kind: float(np.mean(swing_of(walk_of(of_foot(kind))))) for kind in FootKind}
    assert lifted[FootKind.HYDRAULIC_ANKLE] > 3.0
    assert max(abs(lifted[kind]) for kind in (FootKind.SACH, FootKind.ENERGY_STORING)) < 1.0


@pytest.mark.parametrize("kind", FootKind)
def test_hands_bend_only_a_foot_with_a_joint(kind: FootKind) -> None:
    free = simulate(of_foot(kind)).moved[1].legs[SIDE]
    bent_deg = float(np.ptp(np.rad2deg(free.angles.ankle)))
    assert (bent_deg > 10.0) is kind.has_joint
    assert (bent_deg < 1.0) is not kind.has_joint


def test_only_a_foot_of_several_axes_inverts() -> None:
    for kind in FootKind:
        found = across(walk_of(of_foot(kind)), 1)
        assert found > 0.1 if kind is FootKind.MULTI_AXIAL else found < 1e-3, kind


def test_what_is_left_of_a_foot_has_its_own_ankle_and_pushes_off_less() -> None:
    partial = Prosthesis(AmputationLevel.PARTIAL_FOOT)
    person = made(replace(PLAIN, prosthetic_side=None)).moved[-1].legs[SIDE]
    left = walk_of(partial)
    assert cycle(left, left.angles.ankle).min() > cycle(person, person.angles.ankle).min() + 3.0
    np.testing.assert_array_equal(left.angles.inversion, person.angles.inversion)


@pytest.mark.parametrize(
    ("level", "bare"),
    [
        (AmputationLevel.PARTIAL_FOOT, []),
        (TRANSTIBIAL, [Site.LEFT_SHANK, Site.LEFT_FOOT]),
        (TRANSFEMORAL, [Site.LEFT_SHANK, Site.LEFT_FOOT]),
    ],
)
def test_sensors_ride_on_tissue_where_it_is_left(level: AmputationLevel, bare: list[Site]) -> None:
    soft, rigid = (simulate(Prosthesis(level), tissue) for tissue in (Tissue.SOFT, Tissue.RIGID))
    imu = [session.session.recordings[-1].imu for session in (soft, rigid)]
    shaken = {site: np.abs(imu[0][site].acc_m_s2 - imu[1][site].acc_m_s2).max() for site in imu[0]}
    # a person's knee turns inward as it bends, which the segments below follow
    least = 3.0 if level is TRANSTIBIAL else 1e-9
    assert [site for site in shaken if site.side is SIDE and shaken[site] < least] == bare


def test_a_polycentric_knee_turns_about_one_direction_and_a_point_that_moves() -> None:
    angle = np.deg2rad(np.linspace(0.0, 90.0, 91))
    shift = polycentric_shift_m(angle)
    np.testing.assert_allclose(shift[0], 0.0)
    assert 0.009 < np.linalg.norm(shift[60]) < 0.06
    centres = []
    for k in (1, 20, 60):  # where nothing moves: d' = w x (d - c)
        step = (shift[k + 1] - shift[k - 1]) / (angle[k + 1] - angle[k - 1])
        centres.append(shift[k] + np.array([step[2], 0.0, -step[0]]))
    assert centres[0][2] > centres[1][2] + 0.03 > 0.03
    np.testing.assert_allclose(centres[2][[0, 2]], shift[60][[0, 2]] + [0.0, 0.0], atol=0.06)
    leg = walk_of(Prosthesis(TRANSFEMORAL, KneeKind.POLYCENTRIC))
    end_of_thigh = np.linalg.norm(leg.origins_m[1] - leg.origins_m[0], axis=1)
    assert np.ptp(end_of_thigh) > 0.01
    single = walk_of(Prosthesis(TRANSFEMORAL, KneeKind.SINGLE_AXIS))
    assert np.ptp(np.linalg.norm(single.origins_m[1] - single.origins_m[0], axis=1)) < 1e-9


@pytest.mark.parametrize(
    "fitted", [of_foot(FootKind.SACH), of_foot(FootKind.ENERGY_STORING), Prosthesis(TRANSFEMORAL, KneeKind.LOCKED)]
)
def test_the_truth_is_of_what_is_worn(fitted: Prosthesis) -> None:
    session = simulate(fitted)
    truth = session.truth.recordings["walk 1"].joints[Joint.LEFT_ANKLE]
    leg = walk_of(fitted)
    np.testing.assert_allclose(truth.angle_rad, np.interp(truth.time_s, leg.time_s, leg.angles.ankle), atol=1e-3)
