"""What can be done on a step, by what its bar states, and by the buttons of its page that the bar has the keys of."""

from app.wizard.step import Step


def press(step: Step, text: str = "") -> None:
    """Do what the action with these words does; without any, what Enter does."""
    bar = step.bar()
    offered = [*bar.on_page, bar.primary, *bar.others, *bar.quiet]
    action = next(one for one in offered if one is not None and text in ("", one.text))
    assert action.is_enabled
    action.run()
