"""From a house's plan to triangles: walls with openings, floors, ceilings, stairs, objects."""
