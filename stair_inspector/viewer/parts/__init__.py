"""The parts of the page: a folder for each tab, and beside them what they share.

``part.py`` says what a part is and what it is given. A part owns its widgets and what they do, and says on which
changes it depends. It may import what lies beside the folders, and the rooms below, but no other part's folder. A new
part is a folder with its ``part.py``, and a line in :data:`stair_inspector.viewer.page.PARTS`.
"""
