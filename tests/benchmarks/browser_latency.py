"""How long after a slider has moved does the table change, in a browser, with a million points?

    python -m tests.benchmarks.browser_latency [--points 1000000] [--drawn 20000]

Prints the median and the longest delay of several moves of each slider beside the computing time that the page
reports. The budget is 300 ms. Without a graphics card the browser draws in software, which takes longer than all the
rest: the measurement uses every point, but only ``--drawn`` of them are shown.
"""

import argparse
import statistics
import tempfile
import time
from pathlib import Path

from stair_inspector.files.simulations import simulate_to_file
from stair_inspector.params import Params
from stair_inspector.simulation.scanner_specs import Scanner
from stair_inspector.simulation.specs import Stair
from tests.browser.inspector_page import ARGUMENTS, InspectorPage, find_browser

BUDGET_MS = 300.0
MOVES = {"paper's α_f [%]": "ArrowLeft", "ε_z [mm]": "ArrowRight", "m": "ArrowRight", "θ_th [°]": "ArrowLeft"}
_USED_CHANGED = "(before) => document.querySelector('[data-testid=used]')?.textContent !== before"
_STAMP_CHANGE = """() => {
    window.stamps = {};
    const text = (name) => document.querySelector(`[data-testid=${name}]`)?.textContent;
    const look = (name) => {
        const now = text(name);
        if (now === window.stamps.seen[name]) return;
        window.stamps.seen[name] = now;
        window.stamps[name] = performance.now();
    };
    addEventListener('keydown', () => {
        window.stamps = {pressed: performance.now(), seen: {used: text('used'), 'steps-table': text('steps-table')}};
    }, true);
    new MutationObserver(() => { if (window.stamps.seen) { look('used'); look('steps-table'); } })
        .observe(document.body, {subtree: true, childList: true, characterData: true});
}"""
_DELAY = "() => (window.stamps['steps-table'] ?? window.stamps.used) - window.stamps.pressed"
"""The browser's own clock, without the driver's share: from the key to the first change of the line of the settings
that were used, which every result changes, and to the last change of the table, which stays where no value changes."""


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--points", type=int, default=1_000_000)
    options.add_argument("--drawn", type=int, default=20_000)
    options.add_argument("--moves", type=int, default=8)
    given = options.parse_args()
    path = find_browser()
    if path is None:
        raise SystemExit("no Chromium found; install one, or name it in STAIR_INSPECTOR_BROWSER")
    from playwright.sync_api import sync_playwright

    from stair_inspector.pictures.display import choose_display
    from stair_inspector.viewer.app import App
    from stair_inspector.viewer.parts import scene_look

    scene_look.choose_display = lambda scan, most: choose_display(scan, min(most, given.drawn))
    with tempfile.TemporaryDirectory() as folder:
        scan = Path(folder) / "scan.ply"
        scanner = Scanner(
            max_points=given.points, azimuth_step_deg=0.03, elevation_step_deg=0.03, spacing_m=0.001, stations=3
        )
        simulate_to_file(scan, Stair(), scanner)
        app = App([scan], Params(), port=0, saves_projects=False)
        try:
            with sync_playwright() as playwright:
                browser = playwright.chromium.launch(executable_path=path, args=list(ARGUMENTS))
                measure(InspectorPage(browser, app.address), given.moves)
                browser.close()
        finally:
            app.stop()


def measure(page, n_moves):
    began = time.perf_counter()
    page.by_id("used").first.wait_for(state="attached", timeout=300_000)
    page.await_result()
    first_s = time.perf_counter() - began
    page.open()
    page.choose_columns("paper")
    print(f"{page.text('scan')}; first table after {first_s:.1f} s")
    page.page.evaluate(_STAMP_CHANGE)
    print(f"{'slider':<10}{'median ms':>10}{'max ms':>8}{'computing: median ms':>22}{'max ms':>8}")
    worst = 0.0
    for label, key in MOVES.items():
        delays, computing = [], []
        for _ in range(n_moves):
            before = page.by_id("used").text_content()
            page.press(label, key)
            page.page.wait_for_function(_USED_CHANGED, arg=before)
            page.await_result()
            delays.append(page.page.evaluate(_DELAY))
            computing.append(computing_ms(page.by_id("timings").text_content()))
        worst = max(worst, *delays)
        print(
            f"{label:<10}{statistics.median(delays):>10.0f}{max(delays):>8.0f}"
            f"{statistics.median(computing):>22.1f}{max(computing):>8.1f}"
        )
    print(f"budget {BUDGET_MS:.0f} ms: {'kept' if worst <= BUDGET_MS else 'exceeded'} (longest {worst:.0f} ms)")


def computing_ms(timings):
    """Sum of the stages in the page's line ``ms: levels 12.3 · surfaces 4.5``."""
    words = timings.removeprefix("ms: ").split(" · ") if timings.startswith("ms: ") else []
    return sum(float(word.split()[-1]) for word in words)


if __name__ == "__main__":
    main()
