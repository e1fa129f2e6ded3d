"""A gyroscope bias that was set again is stated, with its sensor; none, nothing."""

from app.wizard.losses import NOTHING
from app.wizard.walk_messages import bias_message
from core.body import Site
from core.live.bias import BiasCorrection


def test_the_sensor_whose_bias_was_corrected_is_named() -> None:
    what, action = bias_message([BiasCorrection(Site.LEFT_SHANK, 12.0, 0.1)])
    assert "L shank" in what
    assert "standing again" in action


def test_nothing_is_stated_where_every_bias_held() -> None:
    assert bias_message([]) == NOTHING
