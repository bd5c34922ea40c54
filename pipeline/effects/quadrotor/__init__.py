"""The effects of a quadrotor, one file each."""
