"""Other methods on TopoNav's own map, perception, planner and stop rule, one file each."""
