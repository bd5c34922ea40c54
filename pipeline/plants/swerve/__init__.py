"""Concealed swerve drive: tyre slip, module friction, backlash, and eight motors on one battery."""
