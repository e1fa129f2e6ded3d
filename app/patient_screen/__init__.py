"""The patient's own screen: one target, the stride just done and the last ten, a tone; its controls and a metronome.

Here is what the patient sees and what the operator sets. What is computed is in `core.live.stride_values`, what joins
it to a walk in `app.wizard.walking.patient_feedback`. Nothing here knows who the patient is, so nothing can show it.
"""
