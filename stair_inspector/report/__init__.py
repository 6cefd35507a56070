"""The report: its pictures, charts, drawings, and the documents they go into."""
