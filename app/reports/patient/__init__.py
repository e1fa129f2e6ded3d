"""The pages that go into the patient's file: what was measured, stated once, on paper.

`document` makes the PDF of a `request`; every other module makes one page or draws one kind of figure. Numbers are not
computed here: they come from `walk_figures`, `gait_csv`, `summary` and the core, so that paper, screen and files agree.
A page is a list of blocks (heading, text, table, figure) that `resources/report/report.typ` sets without knowing gait.
"""
