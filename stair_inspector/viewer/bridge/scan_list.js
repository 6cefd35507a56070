((picture) => {
  const list = picture.parentElement;
  /* The list is made anew after every result: what was written, and which row had the keyboard, is kept here. */
  const kept = (window.__stairInspectorScans ??= { words: '', row: null });
  const rows = () => [...list.querySelectorAll('[data-testid=scan-row]')];
  const field = list.querySelector('[data-testid=scan-filter]');
  const filter = () => {
    const wanted = (field ? kept.words : '').toLowerCase().split(' ');
    for (const row of rows()) {
      const words = row.textContent.toLowerCase();
      row.parentElement.hidden = !wanted.every((word) => words.includes(word));
    }
  };
  if (field) {
    field.value = kept.words;
    field.oninput = () => {
      kept.words = field.value;
      filter();
    };
  }
  list.addEventListener('focusin', (event) => {
    kept.row = event.target.dataset.scan ?? event.target.dataset.testid;
  });
  list.addEventListener('focusout', (event) => {
    if (event.relatedTarget) kept.row = null;
  });
  list.addEventListener('keydown', (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    const seen = rows().filter((row) => !row.parentElement.hidden);
    const now = seen.indexOf(document.activeElement);
    seen[Math.min(Math.max(now + step, 0), seen.length - 1)]?.focus();
  });
  filter();
  if (kept.row !== null && document.activeElement === document.body) {
    const again = kept.row === 'scan-filter' ? field : rows().find((row) => row.dataset.scan === kept.row);
    again?.focus({ preventScroll: true });
  }
})
