"""Curves on the screen. Here and nowhere else pyqtgraph is imported, which takes most of a second: import it late."""
