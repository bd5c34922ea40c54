"""Motion profiles: time-efficient straight motions from rest to rest within a drive's voltage."""
