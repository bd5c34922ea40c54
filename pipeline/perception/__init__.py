"""Floor 6: from the corners of gates in an image to an estimate of the state without drift.

`camera` and `view` say where corners appear, `pose` where a machine is that sees them so, `drift` how far its odometry
has drifted; `correction` joins them. The chain is that of Kaufmann et al. 2023 (Nature 620, Methods).
"""
