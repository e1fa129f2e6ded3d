"""What can be done on a step, by what its bar states."""

from app.wizard.step import Step


def press(step: Step, text: str = "") -> None:
    """Do what the action with these words does; without any, what the primary one does."""
    bar = step.bar()
    offered = [bar.primary, *bar.others, *bar.quiet] if text else [bar.primary]
    action = next(one for one in offered if one is not None and text in ("", one.text))
    assert action.is_enabled
    action.run()
