"""Concealed quadrotor in a gimbal: it rotates about a fixed point under a pilot's rate commands."""
