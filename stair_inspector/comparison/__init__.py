"""Two inspections of one stair: matched by place, laid onto each other on what did not move, and compared.

``matching`` finds which step is which, ``surfaces`` what can be laid onto each other, ``consensus`` the parts that
agree, ``alignment`` the motion, ``deviations`` the map of each tread, ``compare`` the whole.
"""
