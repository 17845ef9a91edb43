"use strict";
/* The map of a campaign: a canvas for each plan, metrics down and runs across. It wraps like text,
   so that a thousand runs are seen at once. */
const axisrigMap = (() => {
  const css = (name) =>
    getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
  const LARGE = 15, SMALL = 10, MANY = 60;
  const GAP = 6, TOP = 2, LABEL_MAX = 190, FONT = "system-ui, sans-serif";

  /* place: element to fill. data: see section.py. open: opens a run by its id. */
  function make(place, data, open) {
    const at = place.querySelector(".map-at");
    const plans = data.plans.map((plan) => {
      const figure = document.createElement("figure");
      const caption = document.createElement("figcaption");
      const canvas = document.createElement("canvas");
      canvas.tabIndex = 0;
      canvas.setAttribute("role", "application"); // keys choose a cell
      figure.append(caption, canvas);
      place.querySelector(".map-plans").append(figure);
      const map = {
        plan, figure, caption, canvas, data, runs: plan.runs, chosen: null,
        rows: ["run", ...plan.metrics],
      };
      canvas.addEventListener("mousemove", (event) => say(map, at, cellAt(map, event)));
      canvas.addEventListener("mouseleave", () => say(map, at, map.chosen));
      canvas.addEventListener("blur", () => { choose(map, null); say(map, at, null); });
      canvas.addEventListener("click", (event) => {
        const cell = cellAt(map, event);
        if (cell) open(map.runs[cell.run][0]);
      });
      canvas.addEventListener("keydown", (event) => {
        if (event.key === "Enter" && map.chosen) open(map.runs[map.chosen.run][0]);
        const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
        if (!step || !map.runs.length) return;
        event.preventDefault();
        const { run, row } = map.chosen || { run: -step[0], row: -step[1] };
        const clamp = (value, count) => Math.min(Math.max(value, 0), count - 1);
        choose(map, {
          run: clamp(run + step[0], map.runs.length), row: clamp(row + step[1], map.rows.length),
        });
        say(map, at, map.chosen);
      });
      return map;
    });
    const draw = () => plans.forEach((map) => paint(map, place.clientWidth));
    /* Runs for which `fits` holds are drawn. */
    function filter(fits) {
      for (const map of plans) {
        map.runs = map.plan.runs.filter(([id]) => fits(id));
        map.chosen = null;
        map.figure.hidden = !map.runs.length;
      }
      draw();
    }
    let width = place.clientWidth;
    new ResizeObserver(() => {
      if (place.clientWidth === width) return;
      width = place.clientWidth;
      draw();
    }).observe(place);
    return { filter, draw, plans };
  }

  function choose(map, cell) {
    map.chosen = cell;
    paint(map, map.width);
  }

  function say(map, at, cell) {
    const [id, cells] = cell ? map.runs[cell.run] : ["", ""];
    const verdict = cell && map.data.verdicts[cells[cell.row]];
    const word = verdict ? `${verdict[1]} ${verdict[0]}` : "no such check";
    at.textContent = cell ? `${id}${cell.row ? ` · ${map.rows[cell.row]}` : ""}: ${word}` : "";
    map.canvas.title = at.textContent;
  }

  function cellAt(map, event) {
    const box = map.canvas.getBoundingClientRect();
    const column = Math.floor((event.clientX - box.left - map.label) / map.size);
    const y = event.clientY - box.top - TOP;
    const line = Math.floor(y / map.line);
    const row = Math.floor((y - line * map.line) / map.size);
    const run = line * map.columns + column;
    const isInside = column >= 0 && column < map.columns && run < map.runs.length
      && row >= 0 && row < map.rows.length;
    return isInside ? { run, row } : null;
  }

  /* Lay out and draw. A line of runs has all metrics below each other; the first row is the run. */
  function paint(map, width) {
    const { canvas, runs, rows, plan } = map;
    if (!runs.length || !width) return;
    const ctx = canvas.getContext("2d");
    const size = map.size = plan.runs.length > MANY ? SMALL : LARGE;
    const font = `${size > SMALL ? 11 : 9.5}px ${FONT}`;
    ctx.font = font;
    const longest = Math.max(...rows.map((name) => ctx.measureText(name).width));
    map.width = width;
    map.label = Math.ceil(Math.min(longest, LABEL_MAX, width / 3)) + 6;
    map.columns = Math.max(Math.min(Math.floor((width - map.label) / size), runs.length), 1);
    map.line = rows.length * size + GAP;
    const lines = Math.ceil(runs.length / map.columns);
    const ratio = devicePixelRatio;
    const [wide, high] = [map.label + map.columns * size, lines * map.line - GAP + 2 * TOP];
    Object.assign(canvas, { width: wide * ratio, height: high * ratio });
    Object.assign(canvas.style, { width: `${wide}px`, height: `${high}px` });
    ctx.scale(ratio, ratio);
    ctx.translate(0, TOP);
    ctx.textBaseline = "middle";
    for (let line = 0; line < lines; line++) labels(map, ctx, font, line * map.line);
    cells(map, ctx);
    words(map);
  }

  function labels(map, ctx, font, top) {
    ctx.font = font;
    ctx.textAlign = "right";
    const room = map.label - 6;
    map.rows.forEach((name, row) => {
      let text = name;
      while (text.length > 2 && ctx.measureText(text).width > room) text = `${text.slice(0, -2)}…`;
      ctx.fillStyle = css(row ? "soft" : "ink");
      ctx.fillText(text, room, top + (row + 0.5) * map.size);
    });
  }

  /* A picture of a cell for each verdict: thousands of them are copied, not written. */
  function stamps(map) {
    const { size, data } = map, ratio = devicePixelRatio, side = size - 1;
    const inks = { marginal: "#1a1f26", error: css("error-ink") };
    const made = new Map([["-", [css("faint"), "", ""]]]);
    data.verdicts.forEach(([word, sign], place) =>
      made.set(String(place), [css(word), sign, inks[word] || "#ffffff"]));
    for (const [key, [fill, sign, ink]] of made) {
      const stamp = document.createElement("canvas");
      stamp.width = stamp.height = Math.round(side * ratio);
      const ctx = stamp.getContext("2d");
      ctx.scale(stamp.width / side, stamp.height / side);
      ctx.fillStyle = fill;
      ctx.fillRect(0, 0, side, side);
      ctx.font = `700 ${Math.round(size * 0.72)}px ${FONT}`;
      ctx.textAlign = "center";
      ctx.textBaseline = "middle";
      ctx.fillStyle = ink;
      ctx.fillText(sign, side / 2, size / 2);
      made.set(key, stamp);
    }
    return made;
  }

  function cells(map, ctx) {
    const { runs, rows, size } = map, made = stamps(map);
    runs.forEach(([, verdicts], at) => {
      const x = map.label + (at % map.columns) * size;
      const top = Math.floor(at / map.columns) * map.line;
      for (let row = 0; row < rows.length; row++) {
        ctx.drawImage(made.get(verdicts[row]), x, top + row * size, size - 1, size - 1);
      }
    });
    if (!map.chosen) return;
    const { run, row } = map.chosen;
    ctx.strokeStyle = css("ink");
    ctx.lineWidth = 2;
    ctx.strokeRect(map.label + (run % map.columns) * size - 1,
      Math.floor(run / map.columns) * map.line + row * size - 1, size + 1, size + 1);
  }

  /* The caption, and the words for a reader who does not see the map. */
  function words(map) {
    const { plan, runs, rows, data } = map;
    const counts = data.verdicts.map(([word], place) =>
      [runs.filter(([, cells]) => cells[0] === String(place)).length, word]);
    const said = counts.filter(([count]) => count).map(([count, word]) => `${count} ${word}`);
    const more = plan.left_out ? `, ${plan.left_out} metrics more` : "";
    map.caption.replaceChildren(Object.assign(document.createElement("b"), { textContent: plan.name }),
      ` ${said.join(", ")}${more}`);
    map.canvas.setAttribute("aria-label",
      `${plan.name}: ${runs.length} runs across, ${rows.length - 1} metrics down: ${said.join(", ")}. `
      + "Arrow keys choose a cell, Enter opens its run.");
  }

  return { make };
})();
