"""What other programs read: spreadsheet, C3D, OpenSim and FHIR, made from an Analysis alone, without a screen.

Every number is one of the CSV files' or of summary.json; nothing is computed here. `exports` is the way in: it takes
names away unless identity is asked for, and notes in a library's audit what left it.
"""
