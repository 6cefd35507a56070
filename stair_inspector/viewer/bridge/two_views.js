((picture, arrangement, only) => {
  const overlay = picture.parentElement;
  const viser = window.__viserMutable;
  /* Where the bar stands, as a share of the width, and which half the mouse went down in: 1 left, -1 right. */
  const views = (window.__stairInspectorViews ??= { at: 0.5, side: 0 });
  views.arrangement = arrangement;
  const store = () => viser.scene?.__r3f?.root?.getState?.();
  /* Of each part: its left edge, its width, and how far the whole picture is moved in it. */
  views.parts = (width) =>
    arrangement === 'halves'
      ? [[0, width / 2, -width / 4], [width / 2, width / 2, width / 4]]
      : [[0, width * views.at, 0], [width * views.at, width * (1 - views.at), 0]];
  /* viser draws the labels of all nodes at once, over everything: they belong to the right part. */
  const labels = () =>
    viser.scene.children.filter(
      (group) => group.children.length && group.children.every((each) => each.renderOrder > 10000),
    );
  views.hidden = (part) =>
    Object.entries(viser.nodeRefFromName)
      .filter(([name]) => name === only[1 - part] || name.startsWith(only[1 - part] + '/'))
      .map(([, node]) => node)
      .concat(part === 0 ? labels() : [])
      .filter((node) => node?.visible);

  const takeOver = (renderer) => {
    const once = renderer.render.bind(renderer);
    renderer.render = (scene, camera) => {
      const isPage = scene === viser.scene && camera === viser.camera && !renderer.getRenderTarget();
      if (views.arrangement === 'one' || !isPage) return once(scene, camera);
      const { clientWidth: width, clientHeight: height } = renderer.domElement;
      renderer.setScissorTest(true);
      try {
        views.parts(width).forEach(([left, wide, moved], part) => {
          const hidden = views.hidden(part);
          hidden.forEach((node) => { node.visible = false; });
          try {
            renderer.setViewport(moved, 0, width, height);
            renderer.setScissor(left, 0, wide, height);
            once(scene, camera);
          } finally {
            hidden.forEach((node) => { node.visible = true; });
          }
        });
      } finally {
        renderer.setScissorTest(false);
        renderer.setViewport(0, 0, width, height);
        renderer.setScissor(0, 0, width, height);
      }
    };
  };

  /* What is pressed in a half is told as if it were pressed in the whole picture, of which the half is a part. */
  const translate = (event) => {
    const canvas = viser.canvas;
    if (views.arrangement !== 'halves' || !canvas || !event.target?.contains?.(canvas)) return;
    const box = canvas.getBoundingClientRect();
    const isHeld = event.type === 'pointerup' || event.type === 'click' || (event.type === 'pointermove' && event.buttons);
    if (!isHeld || !views.side) views.side = event.clientX < box.left + box.width / 2 ? 1 : -1;
    for (const name of ['clientX', 'pageX', 'offsetX', 'x']) {
      const value = event[name] + (views.side * box.width) / 4;
      Object.defineProperty(event, name, { get: () => value });
    }
  };

  const install = () => {
    const state = store();
    if (!state) return setTimeout(install, 100);
    if (views.renderer !== state.gl) {
      views.renderer = state.gl;
      takeOver(state.gl);
    }
    if (!views.hears) {
      views.hears = true;
      const kinds = ['pointerdown', 'pointermove', 'pointerup', 'click', 'dblclick', 'contextmenu', 'wheel'];
      kinds.forEach((kind) => window.addEventListener(kind, translate, true));
    }
    state.invalidate();
  };

  const bar = overlay.querySelector('[data-testid=swipe]');
  const place = () => {
    if (!overlay.isConnected) return clearInterval(timer);
    const canvas = viser.canvas;
    if (!canvas) return;
    const box = canvas.getBoundingClientRect();
    for (const side of ['left', 'top', 'width', 'height']) overlay.style[side] = box[side] + 'px';
    const parts = views.parts(box.width);
    for (const name of overlay.querySelectorAll('[data-view]')) {
      const [left, wide] = parts[Number(name.dataset.view)];
      name.style.left = left + 10 + 'px';
      name.style.display = wide < 90 ? 'none' : '';
    }
    if (!bar) return;
    bar.style.left = parts[1][0] + 'px';
    bar.setAttribute('aria-valuenow', Math.round(100 * views.at));
  };
  const swipe = (at) => {
    views.at = Math.min(Math.max(at, 0.02), 0.98);
    place();
    store()?.invalidate();
  };
  if (bar) {
    let isDragged = false;
    bar.onpointerdown = (event) => { bar.setPointerCapture(event.pointerId); isDragged = true; };
    bar.onpointerup = () => { isDragged = false; };
    bar.onpointermove = (event) => {
      const box = viser.canvas.getBoundingClientRect();
      if (isDragged) swipe((event.clientX - box.left) / box.width);
    };
    bar.onkeydown = (event) => {
      const step = { ArrowLeft: -0.02, ArrowRight: 0.02 }[event.key];
      if (!step) return;
      event.stopPropagation();
      event.preventDefault();
      swipe(views.at + step);
    };
  }
  document.getElementById('stair-inspector-views')?.remove();
  overlay.id = 'stair-inspector-views';
  document.body.appendChild(overlay);
  const timer = setInterval(place, 300);
  place();
  install();
})
