"""What a WPILib DataLog is made of: records, structs, units and SysId tests."""
