"""What is drawn of an inspection: nodes, cameras, sections, points that were clicked."""
