"""Everything that touches the disk.

Scans: PLY, PCD, LAS, LAZ, E57, PTX, text (XYZ, PTS, CSV), and meshes as PLY, OBJ, STL, OFF and GLB; see ``scans``.
"""
