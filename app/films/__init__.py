"""The manual's short silent films, drawn by the application itself. Nothing here is measured, nothing is a patient."""
