"""TopoNav: training-free object navigation with a topological memory."""
