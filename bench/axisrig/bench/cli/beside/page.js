"use strict";
// Draws what `/states` sends. Every text goes into a text node, so that it stays a text.
(() => {
  const POINTS = 240; // of a chart: 12 s of wall time
  const OLD_S = 1.5;
  const SMALL_OF = { mm: "µm", "°": "m°" };
  const SMALL = Object.values(SMALL_OF);
  const at = (id) => document.getElementById(id);
  const charts = new Map(); // key of a chart -> [[simulated s, value, ...], ...]
  let drawn = ""; // what the cards were made for
  let fields = new Map();

  const put = (element, text) => {
    if (element.textContent !== text) element.textContent = text;
  };
  const make = (tag, name, ...inside) => {
    const element = document.createElement(tag);
    if (name) element.className = name;
    element.append(...inside);
    return element;
  };
  const number = (value, digits = 4) => {
    if (value === null || value === undefined) return "–";
    const text = value.toFixed(digits).replace("-", "−");
    return /[1-9]/.test(text) ? text : text.replace("−", "");
  };
  const seconds = (ns) => (ns === null ? "–" : number(ns / 1e9, 6));
  const whole = (value) => value.toLocaleString("en").replaceAll(",", " ");
  const lamp = (element, text, kind) => {
    put(element, text);
    element.className = `lamp ${kind}`;
  };
  const list = (id, texts) => {
    const element = at(id);
    if (element.dataset.shown === JSON.stringify(texts)) return;
    element.dataset.shown = JSON.stringify(texts);
    element.replaceChildren(...texts.map((text) => make("li", "", text)));
  };

  // Cards

  const field = (key, tag, name) => {
    const element = make(tag, name);
    fields.set(key, element);
    return element;
  };
  const rows = (prefix, names) => {
    const terms = make("dl", "");
    for (const name of names) {
      terms.append(make("div", "", make("dt", "", name), field(`${prefix}.${name}`, "dd", "")));
    }
    return terms;
  };
  const SVG = "http://www.w3.org/2000/svg";
  const chart = (key, title, lines) => {
    const drawing = document.createElementNS(SVG, "svg");
    drawing.setAttribute("viewBox", "0 0 100 100");
    drawing.setAttribute("preserveAspectRatio", "none");
    drawing.setAttribute("role", "img");
    drawing.setAttribute("aria-label", title);
    for (const line of lines) {
      const drawn = document.createElementNS(SVG, "polyline");
      drawn.setAttribute("class", `line-${line}`);
      drawing.append(drawn);
    }
    const names = make("span", "");
    lines.forEach((line, place) => {
      names.append(make("span", `ink ink-${line}`), line + (place < lines.length - 1 ? "  " : ""));
    });
    fields.set(`${key}.svg`, drawing);
    const place = make("div", "", make("p", "", names, field(`${key}.range`, "span", "")), drawing);
    charts.set(key, []);
    return place;
  };
  const plot = (key, time, values, unit) => {
    const points = charts.get(key);
    if (points.length && points[points.length - 1][0] > time) points.length = 0;
    if (!points.length || points[points.length - 1][0] < time) points.push([time, ...values]);
    if (points.length > POINTS) points.shift();
    const known = points.flatMap((point) => point.slice(1)).filter((value) => value !== null);
    if (!known.length) return;
    let low = Math.min(...known);
    let high = Math.max(...known);
    const digits = SMALL.includes(unit) ? 1 : 4;
    put(fields.get(`${key}.range`), `${number(low, digits)} … ${number(high, digits)} ${unit}`);
    const least = 4 * 0.1 ** digits; // what is shown as a straight line
    const middle = (low + high) / 2;
    const reach = Math.max(0.58 * (high - low), least);
    [low, high] = [middle - reach, middle + reach];
    const begin = points[0][0];
    const width = Math.max(points[points.length - 1][0] - begin, 1e-9);
    [...fields.get(`${key}.svg`).children].forEach((line, place) => {
      const drawn = points
        .filter((point) => point[place + 1] !== null)
        .map((point) => [
          (100 * (point[0] - begin)) / width,
          100 - (100 * (point[place + 1] - low)) / (high - low),
        ]);
      line.setAttribute("points", drawn.map((xy) => xy.map((v) => v.toFixed(2)).join(",")).join(" "));
    });
  };
  const card = (prefix, title, names, plots) => {
    const head = make("h3", "", make("span", "", title), field(`${prefix}.lamp`, "span", "lamp"));
    const left = make("div", "", field(`${prefix}.big`, "p", "big"), rows(prefix, names));
    const whole = make("article", "live-card", head, left, make("div", "chart", ...plots));
    fields.set(prefix, whole);
    return whole;
  };
  const AXIS = ["set", "lag", "touch probe", "input", "measuring", "last latch"];
  const DISTANCE = ["sensor", "reads", "distance", "set value", "error", "commanded by"];
  const build = (state) => {
    const names = [state.run, state.axes.map((a) => a.axis), state.distance.map((d) => d.axis)];
    if (drawn === JSON.stringify(names)) return;
    drawn = JSON.stringify(names);
    fields = new Map();
    charts.clear();
    at("axes").replaceChildren(
      ...state.axes.map(({ axis }) =>
        card(`axis ${axis}`, axis, AXIS, [
          chart(`${axis}.position`, `set and actual position of axis ${axis}`, ["set", "actual"]),
          chart(`${axis}.lag`, `lag of axis ${axis}`, ["lag"]),
        ]),
      ),
    );
    at("distance").replaceChildren(
      ...state.distance.map(({ axis }) =>
        card(`distance ${axis}`, axis, DISTANCE, [
          chart(`${axis}.offset`, `offset of axis ${axis}`, ["offset"]),
          chart(`${axis}.sensor`, `sensor value of axis ${axis}`, ["sensor"]),
        ]),
      ),
    );
  };
  const big = (element, text, unit) => {
    if (element.dataset.shown === text + unit) return;
    element.dataset.shown = text + unit;
    element.replaceChildren(text, " ", make("small", "", unit));
  };
  const milli = (value) => (value === null ? null : 1000 * value);
  const thousandth = (value, unit) => `${number(milli(value), 1)} ${SMALL_OF[unit]}`;
  const ON = ["operation enabled"];
  const BAD = ["fault", "fault reaction active", "quick stop active", "error"];
  const LEVEL = { true: "actuated", false: "not actuated", null: "not mapped (60FD)" };
  const drawAxis = (axis, time) => {
    const key = `axis ${axis.axis}`;
    const get = (name) => fields.get(`${key}.${name}`);
    const kind = ON.includes(axis.drive) ? "on" : BAD.includes(axis.drive) ? "bad" : "";
    lamp(get("lamp"), axis.drive + (axis.is_outside ? ", real drive" : ""), kind);
    fields.get(key).classList.toggle("off", kind === "bad");
    big(get("big"), number(axis.actual), axis.unit);
    put(get("set"), `${number(axis.set)} ${axis.unit}`);
    put(get("lag"), thousandth(axis.lag, axis.unit));
    put(get("touch probe"), axis.touch_probe);
    put(get("input"), LEVEL[axis.input]);
    put(get("measuring"), axis.measuring || "no");
    const latch = axis.latch;
    put(
      get("last latch"),
      latch ? `${number(latch.position)} ${axis.unit}, ${latch.block}, ${seconds(latch.time_ns)} s` : "none",
    );
    plot(`${axis.axis}.position`, time, [axis.set, axis.actual], axis.unit);
    plot(`${axis.axis}.lag`, time, [milli(axis.lag)], SMALL_OF[axis.unit]);
  };
  const FOLLOWS = ["active", "active const dist"];
  const drawDistance = (one, time) => {
    const key = `distance ${one.axis}`;
    const get = (name) => fields.get(`${key}.${name}`);
    const kind = FOLLOWS.includes(one.state) ? "on" : BAD.includes(one.state) ? "bad" : "";
    const more = [one.is_held ? "held" : "", one.is_dry_run ? "dry run" : ""].filter(Boolean);
    lamp(get("lamp"), [one.state, ...more].join(", "), kind);
    fields.get(key).classList.toggle("off", kind === "bad");
    big(get("big"), number(one.offset), `${one.unit} offset`);
    put(get("sensor"), one.sensor);
    put(get("reads"), `${number(one.reading)} ${one.unit}`);
    put(get("distance"), `${number(one.distance)} ${one.unit}`);
    put(get("set value"), `${one.set_name} ${number(one.set)} ${one.unit}`);
    put(get("error"), thousandth(one.error, one.unit));
    put(get("commanded by"), one.source);
    plot(`${one.axis}.offset`, time, [one.offset], one.unit);
    plot(`${one.axis}.sensor`, time, [one.reading], one.unit);
  };

  // Tables

  const cell = (text, name = "") => make("td", name, text);
  const drawProbes = (probes) => {
    at("probe-part").hidden = !probes.length;
    at("probes").replaceChildren(
      ...probes.map((probe) => {
        const signal = make("span", "");
        lamp(signal, probe.level ? "on" : "off", probe.level ? "on" : "");
        return make(
          "tr", "", make("th", "", probe.probe), make("td", "", signal),
          cell(whole(probe.edges), "right"), cell(seconds(probe.edge_ns), "right"),
        );
      }),
    );
  };
  const load = (percent) => {
    const bar = document.createElementNS(SVG, "svg");
    const filled = document.createElementNS(SVG, "rect");
    bar.setAttribute("aria-hidden", "true");
    filled.setAttribute("width", `${Math.min(percent, 100)}%`);
    filled.setAttribute("height", "100%");
    bar.append(filled);
    return make("div", percent > 90 ? "load full" : "load", bar, `${number(percent, 1)} %`);
  };
  // Cycle, working counter and states of an EtherCAT line
  const lineWords = (line) => [
    `cycle ${line.period_us} µs, frame ${number(line.wire_us, 2)} µs`,
    `working counter ${line.counter}, wrong in ${whole(line.wrong)} of ${whole(line.back)}`,
    ...line.slaves.map(([axis, state]) => `${axis} ${state}`),
  ];
  const drawBus = (bus) => {
    at("bus").replaceChildren(
      ...bus.map((one) => {
        const name = make("th", "", one.segment + (one.is_outside ? ", real bus" : ""));
        const nodes = one.counters.map((c) => `${c.node}: ${c.state}, TEC ${c.tec}, REC ${c.rec}`);
        if (one.lost) nodes.unshift(`lost: ${one.lost}`);
        if (one.line) nodes.push(...lineWords(one.line));
        return make(
          "tr", "", name, make("td", "", load(one.load_pct)), cell(whole(one.frames), "right"),
          cell(whole(one.error_frames), "right"), cell(nodes.join("; ") || "none"),
        );
      }),
    );
  };

  // The page

  const drawCampaign = (progress) => {
    put(at("campaign"), progress.state.split("; running:")[0]);
    const tiles = progress.verdicts.map((one) => {
      const words = make("span", "", `${one.glyph} ${one.verdict}`);
      return make("li", `tile v-${one.verdict}`, make("b", "", String(one.runs)), words);
    });
    at("verdicts").replaceChildren(...tiles);
    const ended = [...progress.ended].reverse().map((one) => {
      const word = make("span", `word v-${one.verdict}`, `${one.glyph} ${one.verdict}`);
      return make("li", "", word, " ", one.run);
    });
    at("ended").replaceChildren(...ended);
  };
  const drawRealTime = (kept) => {
    at("realtime").hidden = !kept;
    if (!kept) return;
    put(
      at("realtime"),
      `real time: ${kept.late} of the last ${kept.looked_at} SYNCs more than ${number(kept.late_us, 0)} us late,` +
        ` ${number(kept.worst_us, 0)} us at most; plan moved by ${number(kept.slipped_ms, 1)} ms in all` +
        (kept.send_errors ? `; ${kept.send_errors} frames not taken by the interface` : ""),
    );
  };
  const drawState = (state, factor) => {
    at("main").hidden = false;
    build(state);
    document.title = `${state.run} · axisrig live`;
    put(at("run"), state.run);
    put(at("title"), state.title);
    put(at("row"), `row ${state.row}, rig ${state.rig}, program ${state.program}`);
    put(at("channel"), state.channel + (state.is_held ? ", feedhold" : ""));
    put(at("time"), `${number(state.time_ns / 1e9, 3)} s`);
    put(at("factor"), factor === null ? "–" : number(factor, factor < 10 ? 2 : 1));
    put(at("place"), state.block || "");
    put(at("block"), state.block_text || "none");
    put(at("waits"), state.block ? `waits for ${state.waits_for}` : state.waits_for);
    drawRealTime(state.real_time);
    const time = state.time_ns / 1e9;
    state.axes.forEach((axis) => drawAxis(axis, time));
    at("distance-part").hidden = !state.distance.length;
    state.distance.forEach((one) => drawDistance(one, time));
    drawProbes(state.probes);
    drawBus(state.bus);
    at("trouble").hidden = !state.alarms.length;
    list("alarms", state.alarms);
    at("message-part").hidden = !state.messages.length;
    list("messages", state.messages);
  };
  const notice = (text) => {
    at("notice").hidden = !text;
    put(at("notice"), text);
  };
  const drawOld = (look) => {
    const is_old = look.state !== null && look.age_s > OLD_S;
    document.body.classList.toggle("is-old", is_old);
    notice(
      is_old
        ? "No new state: the run is being prepared, judged or written, or a call into an FMU takes long."
        : "",
    );
  };
  const draw = (look) => {
    drawCampaign(look.progress);
    if (look.state) drawState(look.state, look.factor);
    drawOld(look);
  };

  const source = new EventSource("/states");
  source.addEventListener("look", (event) => draw(JSON.parse(event.data)));
  source.addEventListener("end", (event) => {
    source.close();
    draw(JSON.parse(event.data));
    document.body.classList.remove("is-old");
    notice("The campaign has ended. This is the last state of its last run that was seen here.");
    document.body.classList.add("has-ended");
  });
  source.addEventListener("error", () => {
    document.body.classList.add("is-old");
    notice("No connection to axisrig: it has ended, or does not answer. The page goes on trying.");
  });
})();
