"""Racing a quadrotor through gates (Kaufmann et al. 2023, Nature 620, Methods)."""
