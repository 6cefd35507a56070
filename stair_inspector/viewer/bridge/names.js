((picture) => {
  if (window.__stairInspectorNames) return;
  window.__stairInspectorNames = true;
  /* By the sign on it: viser's buttons with nothing but a sign. */
  const SIGNS = {
    'list-search': 'Find a command',
    adjustments: 'Scene tree and connection',
    'arrow-back': 'Back to the controls',
    x: 'Close',
  };
  const AXES = ['x', 'y', 'z'];
  const LATER_MS = 120;
  const setTo = (element, attribute, value) => {
    if (element && element.getAttribute(attribute) !== value) element.setAttribute(attribute, value);
  };
  const nameRow = (label) => {
    const row = label.closest('.mantine-Flex-root');
    if (!row) return;
    const name = label.textContent;
    const slider = row.querySelector('[role=slider]');
    setTo(slider, 'aria-label', name);
    const fields = [...row.querySelectorAll('input:not([type=hidden]),textarea')];
    const isVector = fields.length === AXES.length && !slider;
    fields.forEach((field, place) => {
      if (slider) setTo(field, 'aria-label', name + ', as a number');
      else if (isVector) setTo(field, 'aria-label', name + ' ' + AXES[place]);
      else if (field.id !== label.htmlFor) setTo(field, 'aria-label', name);
    });
    const group = row.querySelector('.mantine-Flex-root:has(>button)');
    setTo(group, 'role', 'group');
    setTo(group, 'aria-label', name);
  };
  const nameButton = (button) => {
    if (button.textContent.trim() || button.title || button.getAttribute('aria-label')) return;
    if (button.matches('.mantine-NumberInput-control')) return;
    const sign = [...(button.querySelector('svg')?.classList ?? [])].find((each) => each.startsWith('tabler-icon-'));
    const known = sign && SIGNS[sign.slice('tabler-icon-'.length)];
    if (button.matches('.mantine-CloseButton-root')) setTo(button, 'aria-label', 'Close');
    else if (known) setTo(button, 'aria-label', known);
    else if (sign) setTo(button, 'aria-label', sign.slice('tabler-icon-'.length).replaceAll('-', ' '));
  };
  const openFolderByKey = (event) => {
    if (event.target !== event.currentTarget || (event.key !== 'Enter' && event.key !== ' ')) return;
    event.preventDefault();
    event.stopPropagation();
    event.currentTarget.click();
  };
  const nameFolder = (sign) => {
    const head = sign.parentElement;
    if (!head.matches('.mantine-Paper-root>.mantine-Paper-root')) return;
    if (!head.hasAttribute('tabindex')) {
      head.tabIndex = 0;
      setTo(head, 'role', 'button');
      head.addEventListener('keydown', openFolderByKey);
    }
    setTo(head, 'aria-expanded', String(sign.classList.contains('tabler-icon-chevron-up')));
  };
  /* viser's panel on a phone is opened by a line that no key reaches. */
  const nameSheet = (sheet) => {
    const head = [...sheet.querySelectorAll('div')].find((each) => each.style.cursor === 'pointer');
    if (!head || head.hasAttribute('tabindex')) return;
    head.tabIndex = 0;
    head.addEventListener('keydown', openFolderByKey);
    /* Stair and table are to be seen first. */
    if (!window.__stairInspectorSheet) head.click();
    window.__stairInspectorSheet = true;
  };
  const nameAll = () => {
    waiting = 0;
    document.querySelectorAll('label[for]').forEach(nameRow);
    document.querySelectorAll('button').forEach(nameButton);
    document.querySelectorAll('svg.tabler-icon-chevron-down,svg.tabler-icon-chevron-up').forEach(nameFolder);
    document.querySelectorAll('.mantine-Paper-root[style*="width: 20em"]').forEach(nameSheet);
  };
  let waiting = 0;
  const later = () => {
    waiting ||= setTimeout(nameAll, LATER_MS);
  };
  new MutationObserver(later).observe(document.body, { childList: true, subtree: true });
  nameAll();
})
