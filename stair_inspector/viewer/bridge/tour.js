((picture, seenKey, stops) => {
  if (window.__stairInspectorTour) return;
  const GAP = 12;
  const WAIT_MS = 300;
  let card = null;
  let marked = null;
  let before = null;
  let timer = 0;
  const found = (stop) => {
    const all = [...document.querySelectorAll(stop[0])];
    return all.find((each) => each.checkVisibility() && each.getBoundingClientRect().width > 0);
  };
  const unmark = () => {
    if (marked) marked.style.outline = '';
    marked = null;
  };
  /* Beside what is spoken of: the first place in the window where the card does not cover it. */
  const place = () => {
    const of = marked?.getBoundingClientRect();
    if (!card || !of) return;
    const wide = card.offsetWidth;
    const tall = card.offsetHeight;
    const within = (value, size, all) => Math.min(Math.max(value, GAP), Math.max(all - size - GAP, GAP));
    const left = within(of.left, wide, innerWidth);
    const top = within(of.top, tall, innerHeight);
    const places = [
      [left, of.bottom + GAP],
      [left, of.top - tall - GAP],
      [of.left - wide - GAP, top],
      [of.right + GAP, top],
    ];
    const fits = ([x, y]) => x >= 0 && y >= 0 && x + wide <= innerWidth && y + tall <= innerHeight;
    const [x, y] = places.find(fits) ?? [left, GAP];
    card.style.left = `${x}px`;
    card.style.top = `${y}px`;
  };
  const end = () => {
    unmark();
    clearInterval(timer);
    card?.remove();
    card = null;
    before?.focus?.();
  };
  const button = (words, action) => {
    const made = document.createElement('button');
    made.type = 'button';
    made.textContent = words;
    made.style.cssText =
      'font:inherit;padding:3px 12px;border-radius:4px;cursor:pointer;color:inherit;background:none;' +
      'border:1px solid var(--mantine-color-default-border)';
    made.onclick = action;
    return made;
  };
  const show = (shown, at) => {
    unmark();
    if (at >= shown.length) return end();
    marked = found(shown[at]);
    if (!marked) return show(shown, at + 1);
    marked.style.outline = '3px solid var(--mantine-primary-color-filled)';
    card.querySelector('p').textContent = shown[at][1];
    card.querySelector('small').textContent = `${at + 1} of ${shown.length}`;
    const isLast = at === shown.length - 1;
    const next = button(isLast ? 'Done' : 'Next', () => show(shown, at + 1));
    card.querySelector('div').replaceChildren(next, ...(isLast ? [] : [button('Skip the tour', end)]));
    place();
    next.focus();
  };
  const begin = () => {
    if (card) end();
    /* Begun from the help card, which lies over all that it speaks of. */
    const close = [...document.querySelectorAll('[role=dialog] button')].find((each) => each.textContent === 'Close');
    if (close) {
      close.click();
      return setTimeout(begin, WAIT_MS);
    }
    try {
      localStorage.setItem(seenKey, 'seen');
    } catch {
      /* A browser that keeps nothing shows it again. */
    }
    before = document.activeElement;
    card = document.createElement('section');
    card.dataset.testid = 'tour';
    card.setAttribute('role', 'dialog');
    card.setAttribute('aria-label', 'Tour of the page');
    /* Above notices, which wait. */
    card.style.cssText =
      'position:fixed;z-index:410;width:min(330px,calc(100vw - 24px));box-sizing:border-box;' +
      'padding:10px 14px;border-radius:6px;font-size:13px;line-height:1.4;color:var(--mantine-color-text);' +
      'background:var(--mantine-color-body);border:1px solid var(--mantine-color-default-border);' +
      'box-shadow:0 3px 16px rgba(0,0,0,.3)';
    card.innerHTML =
      '<small style="font-size:11px"></small><p aria-live="polite" style="margin:2px 0 8px"></p>' +
      '<div style="display:flex;gap:8px"></div>';
    /* No key of the tour is one of the page. */
    card.addEventListener('keydown', (event) => {
      event.stopPropagation();
      if (event.key === 'Escape') end();
    });
    document.body.appendChild(card);
    /* The toolbar is another element after every change. */
    timer = setInterval(place, WAIT_MS);
    show(stops.filter(found), 0);
  };
  window.__stairInspectorTour = begin;
  let seen = null;
  try {
    seen = localStorage.getItem(seenKey);
  } catch {
    seen = null;
  }
  if (seen !== null) return;
  const waiting = setInterval(() => {
    if (!stops.every(found) && !document.querySelector('[data-testid=state][data-state=ready]')) return;
    clearInterval(waiting);
    begin();
  }, WAIT_MS);
})
