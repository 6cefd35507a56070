"""Pictures of a staircase: cameras, colours, legends, a renderer that needs no display, and what is burned in."""
