"""The demonstration's library: who is simulated, what each visit recorded, and how both get into it.

Nothing in it is made up for the screen. The walker moves, its sensors' samples go into journals and come out of them as
any patient's do, and what is shown is what the analysis finds in them. Nothing here needs a screen.
"""
