"""The effects of a swerve, one file each."""
