"""Residual models from recorded flights of a policy (Kaufmann et al. 2023, Nature 620, Methods)."""
