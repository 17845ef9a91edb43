"use strict";
/* The lane of NC blocks over the plots of a run, and the block that is chosen in its table. */
const axisrigBlocks = (() => {
  const css = (name) =>
    getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
  const NS_PER_MS = 1e6;

  /* NC blocks over time; what waited before it began, and feedholds, are hatched. */
  function lane(state) {
    return (u) => {
      const { ctx, bbox } = u, ratio = devicePixelRatio;
      const { rows, lanes, holds } = state.chart.blocks;
      const height = bbox.height / lanes;
      const x = (t) => Math.min(Math.max(u.valToPos(t / NS_PER_MS, "x", true), bbox.left),
        bbox.left + bbox.width);
      ctx.save();
      ctx.textAlign = "left";
      ctx.textBaseline = "middle";
      ctx.font = `${10.5 * ratio}px ui-monospace, "DejaVu Sans Mono", monospace`;
      for (const [, due, begin, end, group, number, label] of rows) {
        const [first, left, right] = [due, begin, end].map(x);
        const top = bbox.top + number * height + ratio, high = height - 2 * ratio;
        if (left > first) hatch(ctx, first, top, left - first, high, css("block-wait"));
        if (right > left) {
          ctx.fillStyle = css("block-" + group);
          ctx.fillRect(left, top, Math.max(right - left - ratio, ratio), high);
        } else if (left === first && left > bbox.left && left < bbox.left + bbox.width) {
          ctx.fillStyle = css("soft");
          ctx.fillRect(left, top + high / 2, ratio, high / 2);
          continue;
        }
        const [from, to] = right > left ? [left, right] : [first, left];
        const room = to - from - 8 * ratio;
        const word = [label, label.split(" ")[0]].find((text) => ctx.measureText(text).width < room);
        if (!word) continue;
        ctx.fillStyle = css("ink");
        ctx.fillText(word, from + 4 * ratio, top + high / 2);
      }
      for (const [begin, end] of holds) {
        const [left, right] = [begin, end].map(x);
        if (right > left) hatch(ctx, left, bbox.top, right - left, height, css("limit"));
      }
      ctx.restore();
    };
  }

  function hatch(ctx, left, top, width, height, colour) {
    const step = 5 * devicePixelRatio;
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    ctx.strokeStyle = colour;
    ctx.lineWidth = 1.5 * devicePixelRatio;
    ctx.beginPath();
    for (let x = left - height; x < left + width; x += step) {
      ctx.moveTo(x, top + height);
      ctx.lineTo(x + height, top);
    }
    ctx.stroke();
    ctx.restore();
  }

  /* The block at an instant, of several the last one that has begun. */
  function at(state, ms, number) {
    const t = ms * NS_PER_MS;
    return state.chart.blocks.rows.findLast((row) =>
      (number == null || row[5] === number) && row[1] <= t && t < Math.max(row[3], row[1] + 1));
  }

  /* The stretch of the block that was chosen, in every plot. */
  function band(state) {
    return (u) => {
      if (!state.chosen) return;
      const { ctx, bbox } = u;
      const [left, right] = state.chosen.map((t) =>
        Math.min(Math.max(u.valToPos(t / NS_PER_MS, "x", true), bbox.left), bbox.left + bbox.width));
      if (right < left || left >= bbox.left + bbox.width) return;
      ctx.save();
      ctx.fillStyle = css("chosen");
      ctx.fillRect(left, bbox.top, Math.max(right - left, 2 * devicePixelRatio), bbox.height);
      ctx.restore();
    };
  }

  /* Choose the block of a row of the table, or none when it was chosen already. */
  function choose(state, row) {
    const was = row?.classList.contains("chosen");
    for (const one of state.blocks.querySelectorAll("tr.chosen")) {
      one.classList.remove("chosen");
      one.querySelector(".pick").setAttribute("aria-pressed", "false");
    }
    state.chosen = null;
    if (row && !was) {
      row.classList.add("chosen");
      row.querySelector(".pick").setAttribute("aria-pressed", "true");
      state.chosen = [Number(row.dataset.begin), Number(row.dataset.end)];
      const [first, last] = state.chosen.map((t) => t / NS_PER_MS);
      const [low, high] = state.view;
      const isSeen = first >= low && last <= high && (last - first) * 50 > high - low;
      const margin = Math.max((last - first) * 0.25, 5);
      if (!isSeen) {
        const [begin, end] = state.whole;
        const stretch = [Math.max(first - margin, begin), Math.min(last + margin, end)];
        return state.blockPlots.zoom(state, stretch);  // draws
      }
    }
    return state.blockPlots.redraw(state);
  }

  function connect(state, plots) {
    state.blockPlots = plots;
    state.blocks = state.figure.querySelector(".blocks");
    state.blocks?.addEventListener("click", (event) => {
      const row = event.target.closest("tr[data-at]");
      if (row && !event.target.closest("a")) choose(state, row);
    });
  }

  /* A click on the lane, which is no drag, chooses the block in the table. */
  function click(state, u) {
    let down = 0;
    u.over.addEventListener("mousedown", (event) => { down = event.clientX; });
    u.over.addEventListener("click", (event) => {
      if (!state.blocks || Math.abs(event.clientX - down) > 3) return;
      const place = u.over.getBoundingClientRect();
      const number = Math.floor((event.clientY - place.top) / place.height * state.chart.blocks.lanes);
      const found = at(state, u.posToVal(event.clientX - place.left, "x"), number);
      const row = found && state.blocks.querySelector(`tr[data-at="${found[0]}"]`);
      if (!row) return;
      choose(state, row);
      const box = row.closest(".wide");
      box.scrollTop = row.offsetTop - box.clientHeight / 2;
    });
  }

  return { lane, band, at, connect, click };
})();
