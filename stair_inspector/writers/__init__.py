"""One writer for each medium: HTML, PDF, XLSX, CSV, JSON, DXF."""
