((picture) => {
  const MARKED_MS = 2500;
  const dock = picture.parentElement;
  const root = document.documentElement;
  const old = document.getElementById('stair-inspector-dock');
  const bodyOf = (element) => element.querySelector('[data-testid=dock-body]');
  const place = () => {
    if (!dock.isConnected) {
      clearInterval(timer);
      removeEventListener('stair-inspector-dock', place);
      return;
    }
    const canvas = document.querySelector('canvas[data-engine]');
    if (!canvas) return;
    const box = canvas.getBoundingClientRect();
    /* On a phone viser's panel is a sheet at the foot of the window. */
    const sheet = document.querySelector('.mantine-Paper-root[style*="width: 20em"]');
    const below = sheet ? sheet.offsetHeight : 0;
    dock.style.bottom = below + 'px';
    dock.style.left = box.left + 'px';
    dock.style.width = box.width + 'px';
    const edge = dock.querySelector('[data-testid=dock-edge]');
    edge.setAttribute('aria-valuenow', Math.round((100 * dock.offsetHeight) / innerHeight));
    root.style.setProperty('--si-dock', dock.offsetHeight + below + 'px');
  };
  const cellsOf = (element) =>
    new Map(
      [...element.querySelectorAll('tr[data-step] td[data-column]')].map((cell) => [
        cell.parentElement.dataset.step + ' ' + cell.dataset.column,
        cell,
      ]),
    );
  const chosenIn = (element) => element.querySelector('tr[aria-selected=true]')?.dataset.step;
  /* How what has the keyboard is found again. */
  const focusIn = (element) => {
    const focused = document.activeElement;
    if (!element.contains(focused)) return null;
    if (focused.dataset.key) return `[data-key="${focused.dataset.key}"]`;
    return focused.dataset.step ? `tr[data-step="${focused.dataset.step}"]` : null;
  };
  const markWhatChanged = () => {
    const before = cellsOf(old);
    const now = Date.now();
    for (const [key, cell] of cellsOf(dock)) {
      const was = before.get(key);
      if (!was) continue;
      const since = was.textContent === cell.textContent ? Number(was.dataset.since || 0) : now;
      if (now - since >= MARKED_MS) continue;
      cell.dataset.since = since;
      cell.style.animation = `stair-inspector-changed ${MARKED_MS}ms ${since - now}ms`;
    }
  };

  const scrolled = old ? bodyOf(old).scrollTop : 0;
  const focus = old ? focusIn(old) : null;
  const chosen = old ? chosenIn(old) : undefined;
  if (old) {
    for (const open of old.querySelectorAll('details[open][data-keep]')) {
      const same = dock.querySelector(`details[data-keep="${open.dataset.keep}"]`);
      if (same) same.open = true;
    }
    if (old.dataset.same === dock.dataset.same) markWhatChanged();
    old.remove();
  }
  dock.id = 'stair-inspector-dock';
  document.body.appendChild(dock);
  bodyOf(dock).scrollTop = scrolled;
  const isFolded = root.classList.contains('stair-inspector-folded');
  dock.querySelector('[data-testid=dock-fold]').setAttribute('aria-expanded', !isFolded);
  if (focus) dock.querySelector(focus)?.focus({ preventScroll: true });
  const row = chosenIn(dock);
  if (row !== undefined && row !== chosen) {
    dock.querySelector('tr[aria-selected=true]').scrollIntoView({ block: 'nearest' });
  }
  addEventListener('stair-inspector-dock', place);
  const timer = setInterval(place, 300);
  place();
})
