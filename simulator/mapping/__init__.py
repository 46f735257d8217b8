"""Maps from what sensors measure: 2D occupancy, 3D occupancy, hierarchies of maps."""
