"""Charts of the stride: what they show, in data units, and who paints it. Only `on_screen` needs Qt."""
