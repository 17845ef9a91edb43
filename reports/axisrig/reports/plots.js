"use strict";
/* Plots of runs in any page of axisrig: unpacks signals and draws them with uPlot. */
const axisrigPlots = (() => {
  const css = (name) =>
    getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
  const NS_PER_MS = 1e6;
  const START = { ms: 0, label: "time in ms" };
  const LANES = 5, LANE_HEIGHT = 12;
  /* The actual value is a broad band, on which truth shows as a line where the two agree. */
  const WIDTHS = { set: 1.5, actual: 4, truth: 1 };

  /* ---- signals: base64, gzip, byte planes, zig-zag differences (see encode.py) ---- */

  function unpack(base64) {
    return pako.inflate(Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)));
  }

  function column(octets, offset, rows, head) {
    const scale = 10 ** head.digits;
    const values = new Array(rows);
    let sum = head.start;
    for (let row = 0; row < rows; row++) {
      let step = 0;
      for (let plane = head.planes - 1; plane >= 0; plane--) {
        step = step * 256 + octets[offset + plane * rows + row];
      }
      sum += step % 2 ? -(step + 1) / 2 : step / 2;
      values[row] = sum / scale;
    }
    for (const [first, count] of head.gaps) values.fill(null, first, first + count);
    return values;
  }

  /* The signals of a run by the names of their columns, and `time_ms`. */
  function decode(chart, packed) {
    const octets = unpack(packed);
    const signals = {};
    let offset = 0;
    for (const head of chart.columns) {
      signals[head.name] = column(octets, offset, chart.rows, head);
      offset += head.planes * chart.rows;
    }
    signals.time_ms = signals.time_ns.map((t) => t / NS_PER_MS);
    return signals;
  }

  /* ---- what is on a plot besides the signals ---- */

  function eventLines(events, labelled) {
    return (u) => {
      const { ctx, bbox } = u, ratio = devicePixelRatio;
      const lanes = Array.from({ length: LANES }, () => []);
      ctx.save();
      ctx.font = `${11 * ratio}px system-ui, sans-serif`;
      ctx.lineWidth = ratio;
      /* What went wrong gets its name first; the others take the room that is left. */
      const isWrong = (event) => event.kind === "alarm" || event.kind === "fault";
      for (const event of [...events].sort((a, b) => isWrong(b) - isWrong(a))) {
        const x = Math.round(u.valToPos(event.time_ns / NS_PER_MS, "x", true));
        if (x < bbox.left || x > bbox.left + bbox.width) continue;
        const colour = css(event.kind) || css("soft");
        let top = bbox.top;
        if (labelled) {
          const width = ctx.measureText(event.label).width + 10 * ratio;
          const right = x + width > bbox.left + bbox.width;
          const [begin, end] = right ? [x - width, x + 4 * ratio] : [x, x + width];
          const lane = lanes.findIndex((taken) => taken.every(([a, b]) => begin > b || end < a));
          if (lane >= 0) {
            lanes[lane].push([begin, end]);
            top = bbox.top - (lane + 0.6) * LANE_HEIGHT * ratio;
            ctx.fillStyle = colour;
            ctx.textAlign = right ? "right" : "left";
            ctx.textBaseline = "middle";
            ctx.fillText(event.label, x + (right ? -4 : 4) * ratio, top);
          }
        }
        ctx.strokeStyle = colour;
        ctx.setLineDash([1.5 * ratio, 2.5 * ratio]);
        ctx.beginPath();
        ctx.moveTo(x + 0.5, top - LANE_HEIGHT * 0.4 * ratio);
        ctx.lineTo(x + 0.5, bbox.top + bbox.height);
        ctx.stroke();
      }
      ctx.restore();
    };
  }

  /* Where the closed form expects instants; one that is narrow shows as a line. */
  function bands(state) {
    return (u) => {
      const { ctx, bbox } = u;
      ctx.save();
      ctx.fillStyle = css("expected");
      for (const band of state.chart.bands || []) {
        if (band.axis != null && band.axis !== state.axis) continue;
        const [left, right] = [band.start_ns, band.end_ns].map((t) =>
          Math.min(Math.max(u.valToPos(t / NS_PER_MS, "x", true), bbox.left), bbox.left + bbox.width));
        if (right > left) ctx.fillRect(left, bbox.top, Math.max(right - left, 1), bbox.height);
      }
      ctx.restore();
    };
  }

  /* States of distance control over time, each with its name where there is room. */
  function stateLane(state) {
    return (u) => {
      const { ctx, bbox } = u, ratio = devicePixelRatio;
      ctx.save();
      ctx.font = `600 ${10.5 * ratio}px system-ui, sans-serif`;
      ctx.textAlign = "left";
      ctx.textBaseline = "middle";
      for (const lane of state.chart.lanes || []) {
        if (lane.axis !== state.axis) continue;
        const [left, right] = [lane.start_ns, lane.end_ns].map((t) =>
          Math.min(Math.max(u.valToPos(t / NS_PER_MS, "x", true), bbox.left), bbox.left + bbox.width));
        if (right <= left) continue;
        ctx.fillStyle = css("lane-" + lane.state.toLowerCase().replaceAll("_", "-"));
        ctx.fillRect(left, bbox.top, Math.max(right - left, 1), bbox.height);
        if (ctx.measureText(lane.label).width + 8 * ratio > right - left) continue;
        ctx.fillStyle = css("ink");
        ctx.fillText(lane.label, left + 4 * ratio, bbox.top + bbox.height / 2);
      }
      ctx.restore();
    };
  }

  const STATES = ["INACTIVE", "ACTIVE", "FREEZE", "TURNING_OFF", "ACTIVE_CONST_DIST", "ERROR"];

  /* "lag_mm_max 0.5", for two of one name "latch_mm 9 … 10", different names one after the other. */
  function named(limits) {
    const values = new Map();
    for (const limit of limits) {
      values.set(limit.label, [...(values.get(limit.label) || []), limit.value]);
    }
    return [...values].map(([label, list]) => `${label} ${list.join(" … ")}`).join(", ");
  }

  function limitLines(limits) {
    return (u) => {
      const { ctx, bbox } = u, ratio = devicePixelRatio;
      ctx.save();
      ctx.font = `${10.5 * ratio}px system-ui, sans-serif`;
      ctx.strokeStyle = ctx.fillStyle = css("limit");
      ctx.textAlign = "right";
      ctx.lineWidth = ratio;
      /* Limits outside the picture are named at its edge, one below the other; those that lie
         close together get one name. */
      let group = [];
      let outside = { above: 0, below: 0 };
      for (const [i, limit] of limits.entries()) {
        const y = Math.round(u.valToPos(limit.value, "y", true));
        const above = y < bbox.top, below = y > bbox.top + bbox.height;
        const right = bbox.left + bbox.width - 4 * ratio;
        const text = named([limit]);
        if (above || below) {
          ctx.textBaseline = above ? "top" : "bottom";
          const row = 12 * ratio * outside[above ? "above" : "below"]++ + 2 * ratio;
          const edge = above ? bbox.top + row : bbox.top + bbox.height - row;
          ctx.fillText(`${above ? "▲" : "▼"} ${text}`, right, edge);
          continue;
        }
        ctx.setLineDash([6 * ratio, 4 * ratio]);
        ctx.beginPath();
        ctx.moveTo(bbox.left, y + 0.5);
        ctx.lineTo(bbox.left + bbox.width, y + 0.5);
        ctx.stroke();
        group.push(limit);
        const next = limits[i + 1] && u.valToPos(limits[i + 1].value, "y", true);
        if (next != null && next >= bbox.top && y - next < 14 * ratio) continue;
        /* The lowest of several limits is named below its line, the others above theirs. */
        const under = i === 0 && limits.length > 1;
        ctx.textBaseline = under ? "top" : "bottom";
        ctx.fillText(named(group), right, y + (under ? 3 : -2) * ratio);
        group = [];
      }
      ctx.restore();
    };
  }

  /* ---- one run ---- */

  function legendValue(unit) {
    return (u, value) => (value == null ? "–" : `${+value.toFixed(6)}${unit ? " " + unit : ""}`);
  }

  function roundTimes(low, high, step, zero) {
    const times = [];
    for (let n = Math.ceil((low - zero) / step); n * step + zero <= high; n++) times.push(n * step + zero);
    return times;
  }

  function plotOptions(state, plot, series, place) {
    const { chart, figure } = state;
    const axisOf = (entry) => entry.axis == null || entry.axis === state.axis;
    const events = chart.events.filter((e) => axisOf(e) || !chart.axes.includes(e.axis));
    const limits = chart.limits
      .filter((l) => l.plot === plot.plot && axisOf(l))
      .sort((a, b) => a.value - b.value);
    const grid = { stroke: () => css("faint"), width: 1 };
    const ticks = { stroke: () => css("line"), width: 1, size: 4 };
    const font = "11px system-ui, sans-serif";
    const binary = plot.plot === "probe", blocks = plot.plot === "block";
    const lane = plot.plot === "state" || blocks;
    const draws = blocks ? axisrigBlocks.lane(state) : lane ? stateLane(state) : bands(state);
    const range = lane ? [0, 6] : binary ? [-0.15, 1.15] : chart.ranges?.[plot.plot]?.[state.axis];
    const sinceZero = (t) => t - state.zero.ms;
    return {
      width: figure.clientWidth,
      height: plot.height * (blocks ? chart.blocks.lanes : binary || lane ? 1 : paper()) + (place.first ? LANES * LANE_HEIGHT : 0) + (place.last ? 34 : 0),
      padding: [place.first ? LANES * LANE_HEIGHT + 4 : 6, 14, place.last ? 0 : 4, 0],
      cursor: { sync: { key: state.key }, drag: { x: true, y: false }, y: false },
      scales: {
        x: { time: false },
        y: range ? { range } : {},
      },
      axes: [
        {
          stroke: () => css("soft"), grid, ticks, font,
          size: place.last ? 40 : 0, show: true,
          splits: (u, i, low, high, step) => roundTimes(low, high, step, state.zero.ms),
          values: (u, splits) => (place.last ? splits.map((t) => +sinceZero(t).toFixed(6)) : []),
          label: place.last ? state.zero.label : undefined, labelFont: font, labelSize: 16,
        },
        {
          stroke: () => css("soft"), grid, ticks, font, size: 62,
          label: plot.unit ? `${plot.title} · ${plot.unit}` : plot.title,
          labelFont: "600 11px system-ui, sans-serif", labelSize: 16,
          splits: binary ? () => [0, 1] : lane ? () => [] : undefined,
          space: 24,
        },
      ],
      series: [
        { label: "t", value: (u, t) => legendValue("ms")(u, t == null ? t : sinceZero(t)) },
        ...series.map((entry) => ({
          label: entry.label,
          stroke: () => css(entry.style) || css("other"),
          width: WIDTHS[entry.style] || 1.25,
          /* A stop may be far away: the motion gives the scale. */
          auto: entry.style !== "stop",
          dash: entry.style === "set" ? [5, 3] : undefined,
          points: { show: false },
          value: blocks ? (u, value, i, at) => axisrigBlocks.at(state, u.data[0][at])?.[6] || "–"
            : lane ? (u, value) => STATES[value] || "–" : legendValue(entry.unit),
          paths: lane ? () => null : binary ? uPlot.paths.stepped({ align: 1 }) : undefined,
        })),
      ],
      hooks: {
        drawClear: [axisrigBlocks.band(state), draws],
        draw: [limitLines(limits), eventLines(events, place.first)],
        setCursor: [(u) => state.pointed?.(u.cursor.idx == null ? null : u.data[0][u.cursor.idx])],
        setScale: [(u, key) => key === "x" && follow(state, u)],
        ready: [(u) => {
          if (place.first) u.root.querySelector(".u-series").classList.add("u-keep");
          if (blocks) axisrigBlocks.click(state, u);
        }],
      },
    };
  }

  /* Zooming one plot of a run zooms them all. */
  function follow(state, source) {
    if (state.busy) return;
    state.busy = true;
    const { min, max } = source.scales.x;
    for (const u of state.plots) if (u !== source) u.setScale("x", { min, max });
    state.view = [min, max];
    state.busy = false;
    markTools(state);
  }

  function zoom(state, [min, max]) {
    state.view = [min, max];
    state.busy = true;
    for (const u of state.plots) u.setScale("x", { min, max });
    state.busy = false;
    markTools(state);
  }

  function render(state) {
    const { chart, signals, figure } = state;
    const stack = figure.querySelector(".stack");
    for (const u of state.plots) u.destroy();
    stack.replaceChildren();
    const shown = chart.plots
      .map((plot) => [plot, [...(plot.series[state.axis] || []), ...(plot.series["*"] || [])]])
      .filter(([, series]) => series.length);
    state.plots = [];
    state.busy = true;
    shown.forEach(([plot, series], i) => {
      const place = { first: i === 0, last: i === shown.length - 1 };
      const data = [signals.time_ms, ...series.map((entry) => signals[entry.column])];
      state.plots.push(new uPlot(plotOptions(state, plot, series, place), data, stack));
    });
    state.busy = false;
    zoom(state, state.view);
  }

  /* A stretch of a run to a fixed stop counts its time from the contact. */
  function open(state, stretch) {
    const moved = stretch.zero.ms !== state.zero.ms;
    state.zero = stretch.zero;
    if (!moved) return zoom(state, stretch);
    state.view = stretch;
    render(state);
  }

  function button(text, action, pressed) {
    const node = document.createElement("button");
    node.type = "button";
    node.textContent = text;
    node.addEventListener("click", action);
    node.pressed = pressed;
    return node;
  }

  function markTools(state) {
    for (const node of state.figure.querySelectorAll(".tools button")) {
      node.setAttribute("aria-pressed", String(node.pressed()));
    }
  }

  function buildTools(state) {
    const { chart } = state;
    const tools = state.figure.querySelector(".tools");
    const at = (stretch) => () =>
      Math.abs(state.view[0] - stretch[0]) + Math.abs(state.view[1] - stretch[1]) < 1e-6;
    const gap = document.createElement("span");
    gap.className = "gap";
    tools.append(
      ...chart.axes.map((axis) =>
        button(axis, () => { state.axis = axis; render(state); }, () => state.axis === axis)),
      gap,
      ...state.windows.map((stretch) =>
        button(stretch.label, () => open(state, stretch), at(stretch))),
      button("whole run", () => open(state, state.whole), at(state.whole)),
    );
  }

  /* Draw a run into an element `figure.plots`; key: joins the cursors of its plots. */
  function draw(figure, chart, packed, key) {
    const signals = decode(chart, packed);
    const times = signals.time_ms;
    if (chart.blocks) signals.block = times.map(() => 0);
    const windows = chart.windows.map((w) =>
      Object.assign([w.start_ns / NS_PER_MS, w.end_ns / NS_PER_MS], {
        label: w.label,
        zero: w.zero ? { ms: w.origin_ns / NS_PER_MS, label: `ms from ${w.zero}` } : START,
      }));
    const whole = Object.assign([times[0], times[times.length - 1]], { zero: START });
    const first = windows[chart.opens ?? 0] || whole;
    const state = {
      figure, chart, signals, windows, whole, plots: [], busy: false,
      axis: chart.axis, view: first, zero: first.zero, key,
    };
    buildTools(state);
    axisrigBlocks.connect(state, { zoom, redraw });
    render(state);
    const observer = new ResizeObserver(() => {
      const width = figure.clientWidth;
      for (const u of state.plots) {
        if (width && u.width !== width) u.setSize({ width, height: u.height });
      }
    });
    observer.observe(figure);
    state.remove = () => {
      observer.disconnect();
      for (const u of state.plots) u.destroy();
    };
    return state;
  }

  /* What is drawn to be printed is lower, so that a run is one sheet. */
  const paper = () => (document.documentElement.classList.contains("printing") ? 0.6 : 1);

  /* Draw again in the colours that now hold. What was just made has no scales yet, and uPlot would
     keep those that it does not have: so paths and scales stay as they are. */
  function redraw(state) {
    for (const u of state.plots) u.redraw(false);
  }

  /* Put the cursor of every plot of a run to an instant; outside what is seen there is none. */
  function point(state, ms) {
    const [first, last] = state.view;
    const left = ms < first || ms > last ? -10 : null;
    for (const u of state.plots) u.setCursor({ left: left ?? u.valToPos(ms, "x"), top: 0 }, false);
  }

  return { unpack, decode, draw, redraw, point };
})();
