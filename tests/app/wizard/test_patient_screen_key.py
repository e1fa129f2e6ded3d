"""F8 where there is no walking yet: it is stated where the patient's screen opens."""

from app.wizard.keys import Intent, KeyAction
from app.wizard.wizard import Wizard


def test_at_another_step_f8_states_where_the_patients_screen_opens(wizard: Wizard) -> None:
    wizard.begin(None)
    wizard.act_on(Intent(KeyAction.FULL_SCREEN))
    assert not wizard.shell.banner.isVisible()
    wizard.act_on(Intent(KeyAction.PATIENT_SCREEN))
    assert wizard.shell.banner.isVisible()
    assert wizard.shell.banner.text == "The patient screen opens in step 5, Walking."
