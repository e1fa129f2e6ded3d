"""The report is made and the session left: page, dialog and step."""
