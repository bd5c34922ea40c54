"""What a log of no known layout probably holds: by names, units, shapes, and by what the signals say."""
