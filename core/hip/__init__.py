"""The hips and the pelvis: headings between pelvis and thighs, frames, angles, and one clock for both legs.

A hip is a ball joint and no hinge: nothing here has an axis of its own, and nothing here leads back to how knees and
ankles are found.
"""
