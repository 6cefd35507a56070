"""The parts of a page by the name of their folder or file, as tests want to lay hands on them."""


def part_of(session, name):
    """The part of a page that is made in the folder, or the file, of a name: ``part_of(session, "checks")``."""
    (found,) = [part for part in session.parts if name in type(part).__module__.split(".")[-2:]]
    return found
