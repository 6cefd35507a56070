"""The tour of the page: on the first opening in a browser, which remembers it, and again whenever it is asked for."""

from stair_inspector.viewer.bridge.markup import page_script, press_attribute, text

SEEN_KEY = "stair_inspector.tour"
"""In the browser's storage, once the tour was begun."""
STOPS = (
    ("[data-testid=toolbar]", "The scan stands below these buttons. They show it raw, as steps or both, and turn it."),
    ("[data-testid=dock]", "Each step has a row: its values with their uncertainty. Press a row to choose the step."),
    ("[data-testid=status]", "What was found, and what is going on. Press the notes to read what to look at."),
    ("[role=tablist]", "The tabs follow the work: choose a scan, tune, look at steps, check, note findings, export."),
    ("[data-testid=legend]", "What colours, lines and marks mean; the same in scene, table and section."),
    (
        "[data-testid=toolbar]",
        "Help, at the right end: the keys, a drawing of a step, a glossary, and this tour again.",
    ),
)
"""What is outlined, by its selector, and what is said of it; what a small window does not show is passed over."""


def tour_html() -> str:
    """Return what begins the tour, once for a browser."""
    return page_script("tour", SEEN_KEY, STOPS)


def tour_button_html(label: str) -> str:
    """Return a button that begins the tour again."""
    return (
        f'<button type="button" data-testid="tour-again" {press_attribute("window.__stairInspectorTour()")} '
        'style="font:inherit;font-weight:600;padding:2px 10px;border-radius:4px;cursor:pointer;color:inherit;'
        f'background:none;border:1px solid var(--mantine-color-default-border)">{text(label)}</button>'
    )
