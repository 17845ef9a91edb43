"use strict";
/* Side view of an inclined tool: tool, clamping point, surface and beam in a chosen projection, and
   below it the surface with a scale of its own. A slider moves the tool, and the cursor of the plots
   does; data: see scene.py. */
const axisrigTool = (() => {
  const LEFT = 52, RIGHT = 12, TOP = 10, BOTTOM = 34;
  const HEAD = 30, HIGHEST = 430, LOWEST = 150, NEAR_HEIGHT = 150;
  const CUT_MM = 10, GHOSTS = 7, DEEP_MM = 5e-4, LEAST_MM = 2e-3;
  const PLAY_MS = 5000;
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const along = (p, q, way) => p.map((part, i) => part + way * q[i]);

  function element(name, attributes, ...inside) {
    const node = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    node.append(...inside);
    return node;
  }

  /* Points of the scene: [x, y, z], or null where nothing is known. */
  function points(signals, name) {
    const [x, y, z] = ["x", "y", "z"].map((place) => signals[`${name}_${place}`]);
    return x.map((part, row) => (part == null ? null : [part, y[row], z[row]]));
  }

  function read(node) {
    const about = JSON.parse(node.dataset.about);
    const signals = axisrigPlots.decode(about, node.dataset.packed);
    const scene = { about, signals, count: about.rows, times: signals.time_ms };
    for (const name of ["clamp", "tcp", "programmed", "hit"]) scene[name] = points(signals, name);
    scene.unit = scene.clamp.map((p, row) => {
      const way = along(p, scene.tcp[row], -1), size = Math.hypot(...way) || 1;
      return way.map((part) => part / size);
    });
    scene.near = scene.hit.map((p, row) => p != null && Math.abs(signals.depth[row]) < about.near_mm);
    scene.hasSurface = scene.hit.some((p) => p != null);
    return scene;
  }

  /* ---- from the machine into the picture ---- */

  function ticks(low, high, room) {
    const wanted = Math.max(2, room);
    const size = 10 ** Math.floor(Math.log10((high - low) / wanted));
    const step = [1, 2, 5, 10].map((f) => f * size).find((s) => (high - low) / s <= wanted);
    const found = [];
    for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n++) {
      found.push(+(n * step).toPrecision(12));
    }
    return found;
  }

  /* The frame of a picture: bounds in mm, and what makes pixels of a point. */
  function frame(view, bounds, place) {
    const [a0, a1, b0, b1] = bounds;
    const x = (a) => place.left + (a - a0) * place.scaleX;
    const y = (b) => place.top + (b1 - b) * place.scaleY;
    const at = (p) => [x(dot(p, view.right)), y(dot(p, view.up))];
    return { view, bounds, place, x, y, at };
  }

  const text = ([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`;

  function line(picture, list) {
    let path = "", is_on = false;
    for (const p of list) {
      if (p != null) path += (is_on ? "L" : "M") + text(picture.at(p));
      is_on = p != null;
    }
    return path;
  }

  /* Strips between two lines, where both are known and `fits` says so. */
  function strips(picture, first, second, fits) {
    let path = "";
    for (let row = 0; row + 1 < first.length; row++) {
      if (!fits(row) || !fits(row + 1)) continue;
      const corners = [first[row], second[row], second[row + 1], first[row + 1]];
      path += `M${corners.map((p) => text(picture.at(p))).join("L")}Z`;
    }
    return path;
  }

  function range(scene, lists, direction, rows) {
    let low = Infinity, high = -Infinity;
    for (const list of lists) {
      list.forEach((p, row) => {
        if (p == null || !rows(row)) return;
        const value = dot(p, direction);
        low = Math.min(low, value);
        high = Math.max(high, value);
      });
    }
    return [low, high];
  }

  function grid(picture) {
    const { bounds: [a0, a1, b0, b1], place, x, y, view } = picture;
    const nodes = [];
    const right = x(a1), foot = y(b0), top = y(b1);
    for (const tick of ticks(a0, a1, place.width / 90)) {
      nodes.push(element("path", { class: "tv-grid", d: `M${x(tick).toFixed(1)},${top}V${foot}` }),
        element("text", { x: x(tick).toFixed(1), y: foot + 14, "text-anchor": "middle" }, `${tick}`));
    }
    for (const tick of ticks(b0, b1, place.height / 45)) {
      nodes.push(element("path", { class: "tv-grid", d: `M${place.left},${y(tick).toFixed(1)}H${right}` }),
        element("text", { x: place.left - 5, y: y(tick) + 4, "text-anchor": "end" }, `${tick}`));
    }
    nodes.push(element("text", { x: right, y: foot + 28, "text-anchor": "end" }, view.x),
      element("text", { x: 0, y: foot + 28 }, view.y));
    return nodes;
  }

  /* ---- surface ---- */

  function planeAt(scene, row) {
    return scene.about.planes.findLast((plane) => plane.begin_ms <= scene.times[row] + 1e-6)
      || scene.about.planes[0];
  }

  /* Height of a plane in the picture, at the depth of the TCP. */
  function height(scene, view, plane, a) {
    const across = [
      view.right[1] * view.up[2] - view.right[2] * view.up[1],
      view.right[2] * view.up[0] - view.right[0] * view.up[2],
      view.right[0] * view.up[1] - view.right[1] * view.up[0],
    ];
    const up = dot(plane.normal, view.up);
    if (Math.abs(up) < 0.05) return null;
    const depth = dot(scene.tcp[0], across);
    return (plane.at_mm - depth * dot(plane.normal, across) - a * dot(plane.normal, view.right)) / up;
  }

  function surface(scene, picture) {
    const { bounds: [a0, a1, b0], x, y, view } = picture;
    const nodes = [];
    const lines = scene.about.planes
      .map((plane) => [a0, a1].map((a) => height(scene, view, plane, a)))
      .filter(([first]) => first != null);
    const foot = Math.max(y(b0), picture.place.top);
    for (const [first, last] of lines) {
      const edge = `M${x(a0)},${y(first).toFixed(1)}L${x(a1)},${y(last).toFixed(1)}`;
      nodes.push(element("path", { class: "tv-work", d: `${edge}V${foot}H${x(a0)}Z` }),
        element("path", { class: "tv-surface tv-other", d: edge }));
    }
    for (const plane of scene.about.ideal) {
      const [first, last] = [a0, a1].map((a) => height(scene, view, plane, a));
      if (first == null) continue;
      nodes.push(element("path", {
        class: "tv-ideal", d: `M${x(a0)},${y(first).toFixed(1)}L${x(a1)},${y(last).toFixed(1)}`,
      }));
    }
    if (!scene.about.planes.length && view.up[2]) {
      nodes.push(element("path", { class: "tv-surface", d: line(picture, scene.hit) }));
    }
    return nodes;
  }

  /* ---- pictures ---- */

  const everything = () => true;

  function beam(scene, picture) {
    const cut = scene.hit.map((p, row) => p && along(p, scene.unit[row], -CUT_MM));
    const isDeep = (row) => scene.near[row] && scene.signals.depth[row] > DEEP_MM;
    return [
      element("path", { class: "tv-cut", d: strips(picture, scene.hit, cut, (row) => scene.near[row]) }),
      element("path", { class: "tv-deep", d: strips(picture, scene.hit, scene.tcp, isDeep) }),
    ];
  }

  function contours(scene, picture, rows = everything) {
    const shown = (list) => list.map((p, row) => (rows(row) ? p : null));
    return [
      element("path", { class: "tv-programmed", d: line(picture, shown(scene.programmed)) }),
      element("path", { class: "tv-tcp", d: line(picture, shown(scene.tcp)) }),
    ];
  }

  function ghosts(scene, picture) {
    const nodes = [];
    for (let n = 0; n < GHOSTS; n++) {
      const row = Math.round(n * (scene.count - 1) / (GHOSTS - 1));
      const [cx, cy] = picture.at(scene.clamp[row]), end = text(picture.at(scene.tcp[row]));
      nodes.push(element("path", { class: "tv-ghost", d: `M${cx.toFixed(1)},${cy.toFixed(1)}L${end}` }),
        element("circle", { class: "tv-dot", cx: cx.toFixed(1), cy: cy.toFixed(1), r: 2.5 }));
    }
    return nodes;
  }

  function wholeBounds(scene, view) {
    const lists = [scene.clamp, scene.tcp, scene.programmed];
    const [a0, a1] = range(scene, lists, view.right, everything);
    const [b0, b1] = range(scene, lists, view.up, everything);
    const room = 0.05 * Math.max(a1 - a0, b1 - b0, 1) + 3;
    return [a0 - room, a1 + room, b0 - room - (view.up[2] ? CUT_MM : 0), b1 + room];
  }

  function side(scene, view, width) {
    let [a0, a1, b0, b1] = wholeBounds(scene, view);
    const inner = width - LEFT - RIGHT;
    const scale = Math.min((inner - 2 * HEAD) / (a1 - a0), (HIGHEST - HEAD) / (b1 - b0));
    const high = Math.max(LOWEST, scale * (b1 - b0) + HEAD);
    const [more, above] = [inner / scale - (a1 - a0), high / scale - (b1 - b0)];
    [a0, a1, b1] = [a0 - more / 2, a1 + more / 2, b1 + above];
    const place = { left: LEFT, top: TOP, scaleX: scale, scaleY: scale, width: inner, height: high };
    const picture = frame(view, [a0, a1, b0, b1], place);
    const moving = element("g", { class: "tv-moving" });
    const svg = element("svg", {
      class: "tv-svg", role: "img", viewBox: `0 0 ${width} ${(high + TOP + BOTTOM).toFixed(0)}`,
      "aria-label": `Tool from the side, ${view.y} over ${view.x}`,
    }, ...grid(picture), element("svg", {
      x: LEFT, y: TOP, width: inner, height: high, viewBox: `${LEFT} ${TOP} ${inner} ${high}`,
    }, ...surface(scene, picture), ...beam(scene, picture),
    element("path", { class: "tv-clamp", d: line(picture, scene.clamp) }),
    ...ghosts(scene, picture), ...contours(scene, picture), moving));
    return { svg, picture, moving };
  }

  /* The same way to the right, the height at the surface with its own scale. */
  function near(scene, view, whole, width) {
    if (!view.up[2]) return null; // from above there is no height
    if (!scene.hasSurface && !scene.signals.offset.some((offset) => offset)) return null;
    const rows = (row) => scene.signals.at_work[row] === 1;
    const lists = [scene.tcp, scene.programmed, scene.hit];
    let [b0, b1] = range(scene, lists, view.up, rows);
    if (!(b1 >= b0)) return null;
    const room = Math.max(0.12 * (b1 - b0), LEAST_MM);
    [b0, b1] = [b0 - room, b1 + room];
    const [a0, a1, , ] = whole.bounds;
    const inner = whole.place.width;
    const place = { left: LEFT, top: TOP, scaleX: whole.place.scaleX,
      scaleY: NEAR_HEIGHT / (b1 - b0), width: inner, height: NEAR_HEIGHT };
    const picture = frame(view, [a0, a1, b0, b1], place);
    const moving = element("g", { class: "tv-moving" });
    const isDeep = (row) => rows(row) && scene.near[row] && scene.signals.depth[row] > DEEP_MM;
    const svg = element("svg", {
      class: "tv-svg", role: "img", viewBox: `0 0 ${width} ${NEAR_HEIGHT + TOP + BOTTOM}`,
      "aria-label": `Contours at the surface, ${view.y} with its own scale over ${view.x}`,
    }, ...grid(picture), element("svg", {
      x: LEFT, y: TOP, width: inner, height: NEAR_HEIGHT,
      viewBox: `${LEFT} ${TOP} ${inner} ${NEAR_HEIGHT}`,
    }, ...surface(scene, picture),
    element("path", { class: "tv-deep", d: strips(picture, scene.hit, scene.tcp, isDeep) }),
    ...contours(scene, picture, rows), moving));
    return { svg, picture, moving };
  }

  /* ---- the tool at an instant ---- */

  /* The head: a nozzle above the clamping point, in the direction of the tool. */
  function head(picture, p, unit) {
    const { view, place } = picture;
    const [x, y] = picture.at(p);
    const up = [dot(unit, view.right) * place.scaleX, -dot(unit, view.up) * place.scaleY];
    const size = Math.hypot(...up) || 1;
    const [ux, uy] = up.map((part) => part / size), [vx, vy] = [-uy, ux];
    const corner = (side_, far) => text([x + side_ * vx + far * ux, y + side_ * vy + far * uy]);
    return `M${corner(-3, 0)}L${corner(3, 0)}L${corner(9, 14)}L${corner(9, HEAD)}L${corner(-9, HEAD)}L${corner(-9, 14)}Z`;
  }

  function move(scene, drawn, row) {
    const { picture, moving } = drawn;
    const clamp = scene.clamp[row], tcp = scene.tcp[row], hit = scene.hit[row], unit = scene.unit[row];
    const nodes = [];
    const plane = planeAt(scene, row), distance = scene.signals.distance[row];
    const edges = plane && picture.bounds.slice(0, 2).map((a) => [a, height(scene, picture.view, plane, a)]);
    if (edges && edges[0][1] != null) {
      const path = edges.map(([a, b]) => text([picture.x(a), picture.y(b)])).join("L");
      nodes.push(element("path", { class: "tv-surface", d: `M${path}` }));
    }
    if (plane && distance != null) {
      const foot = along(clamp, plane.normal, -distance);
      nodes.push(element("path", { class: "tv-distance", d: line(picture, [clamp, foot]) }));
    }
    if (hit && scene.near[row]) {
      const end = along(hit, unit, -CUT_MM);
      nodes.push(element("path", { class: "tv-through", d: line(picture, [hit, end]) }));
    }
    nodes.push(element("path", { class: "tv-beam", d: line(picture, [clamp, tcp]) }),
      element("path", { class: "tv-head", d: head(picture, clamp, unit) }));
    for (const [name, p] of [["tv-at-tcp", tcp], ["tv-at-programmed", scene.programmed[row]]]) {
      const [cx, cy] = picture.at(p).map((part) => part.toFixed(1));
      nodes.push(element("circle", { class: name, cx, cy, r: 3.5 }));
    }
    moving.replaceChildren(...nodes);
  }

  function words(scene, row) {
    const { signals } = scene;
    const parts = [`t ${scene.times[row].toFixed(1)} ms`, `tilt ${signals.tilt[row].toFixed(4)}°`,
      `L2 ${signals.length[row].toFixed(4)} mm`];
    const also = [["h", "distance"], ["o", "offset"], ["o/cos b", "moved"]];
    for (const [word, name] of also) {
      if (signals[name][row] != null) parts.push(`${word} ${signals[name][row].toFixed(4)} mm`);
    }
    const depth = signals.depth[row];
    if (depth != null) {
      const um = Math.abs(depth * 1000).toFixed(1);
      parts.push(`beam ends ${um} µm ${depth < 0 ? "above" : "below"} the surface`);
    }
    return parts.join(" · ");
  }

  /* ---- one side view ---- */

  function make(node, plots) {
    const scene = read(node);
    const slider = node.querySelector("input"), output = node.querySelector("output");
    const play = node.querySelector(".tv-play");
    const state = { view: scene.about.views[0], row: 0, width: 0, drawn: [], playing: 0, busy: false };
    const buttons = scene.about.views.map((view) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = { tilt: "plane of the tilt", path: "along the path" }[view.name] || view.name;
      button.addEventListener("click", () => { state.view = view; draw(); });
      return button;
    });
    node.querySelector(".tv-views").append(...buttons);

    function draw() {
      const width = Math.round(node.clientWidth);
      if (!width) return;
      state.width = width;
      buttons.forEach((button, n) =>
        button.setAttribute("aria-pressed", String(scene.about.views[n] === state.view)));
      const whole = side(scene, state.view, width);
      const close = near(scene, state.view, whole.picture, width);
      state.drawn = [whole, close].filter(Boolean);
      node.querySelector(".tv-side").replaceChildren(whole.svg);
      node.querySelector(".tv-near").replaceChildren(...(close ? [close.svg] : []));
      show();
    }

    function show() {
      for (const drawn of state.drawn) move(scene, drawn, state.row);
      slider.value = state.row;
      slider.setAttribute("aria-valuetext", `${scene.times[state.row].toFixed(1)} ms`);
      output.textContent = words(scene, state.row);
    }

    function choose(row) {
      state.row = row;
      show();
      if (!plots) return;
      state.busy = true;
      axisrigPlots.point(plots, scene.times[row]);
      state.busy = false;
    }

    /* The instant under the cursor of the plots; what is before the kinematic or after it is not
       shown. */
    function pointed(ms) {
      if (state.busy || ms == null || ms < scene.times[0] || ms > scene.times[scene.count - 1]) return;
      const after = scene.times.findIndex((time) => time >= ms);
      const before = Math.max(after - 1, 0);
      const row = ms - scene.times[before] < scene.times[after] - ms ? before : after;
      if (row === state.row) return;
      state.row = row;
      show();
    }

    function stop() {
      cancelAnimationFrame(state.playing);
      state.playing = 0;
      play.textContent = "play";
    }

    function start() {
      const first = state.row < scene.count - 1 ? state.row : 0, begin = performance.now();
      const [t0, t1] = [scene.times[first], scene.times[scene.count - 1]];
      const whole = PLAY_MS * (t1 - t0) / (t1 - scene.times[0]);
      play.textContent = "stop";
      const step = (now) => {
        const ms = t0 + (t1 - t0) * Math.min((now - begin) / whole, 1);
        const row = scene.times.findLastIndex((time) => time <= ms);
        if (row !== state.row) choose(Math.max(row, 0));
        if (ms < t1) state.playing = requestAnimationFrame(step);
        else stop();
      };
      state.playing = requestAnimationFrame(step);
    }

    slider.max = scene.count - 1;
    slider.addEventListener("input", () => { stop(); choose(Number(slider.value)); });
    play.addEventListener("click", () => (state.playing ? stop() : start()));
    if (plots) plots.pointed = pointed;
    state.row = scene.signals.tilt.reduce((most, tilt, row, all) => (tilt > all[most] ? row : most), 0);
    draw();
    const observer = new ResizeObserver(() => {
      if (Math.round(node.clientWidth) !== state.width) draw();
    });
    observer.observe(node);
    return { remove: () => { stop(); observer.disconnect(); } };
  }

  return { make };
})();
