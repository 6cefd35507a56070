"""Plan and section of a staircase: once as geometry, then as DXF with real dimensions and as SVG for print."""
