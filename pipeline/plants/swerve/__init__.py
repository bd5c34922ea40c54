"""The concealed swerve drive: tyres that slip, modules that rub, gears with play, eight motors on one battery."""
