"""Motion profiles: from rest to rest along a straight line, as fast as a drive's voltage allows."""
