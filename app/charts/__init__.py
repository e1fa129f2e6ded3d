"""Charts of the stride: what they show, in data units, and who paints it. Only what ends in `on_screen` needs Qt."""
