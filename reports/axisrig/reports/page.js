"use strict";
/* The list of runs: find, sort, open, print. What a run opens is packed at the end of the page. */
(() => {
  const WORDS = new TextDecoder();
  const table = document.querySelector(".verdicts");
  const stored = new Map();
  for (const node of document.querySelectorAll("script.stored")) stored.set(node.dataset.run, node);
  const runs = [...table.tBodies].map((body, index) => ({
    id: body.dataset.run,
    body,
    index,
    verdict: body.dataset.verdict,
    find: body.dataset.card ? `${body.dataset.find} ${body.dataset.card}.` : body.dataset.find,
    card: body.dataset.card,
    isExample: "example" in body.dataset,
    opened: null,
    plots: null,
    tools: [],
  }));
  const byId = new Map(runs.map((run) => [run.id, run]));

  const map = axisrigMap.make(document.querySelector(".map"),
    JSON.parse(document.getElementById("map_data").textContent), (id) => show(byId.get(id)));

  /* ---- one run ---- */

  function open(run) {
    if (run.opened) return;
    const [body] = stored.get(run.id).textContent.split("\n", 1);
    const { html, chart } = JSON.parse(WORDS.decode(axisrigPlots.unpack(body)));
    const row = run.body.insertRow();
    row.className = "opened";
    const place = row.insertCell();
    place.colSpan = 6;
    place.innerHTML = `<article class="run">${html}</article>`;
    run.opened = row;
    run.body.querySelector(".opens").setAttribute("aria-expanded", "true");
    const figure = row.querySelector(".plots");
    if (figure) {
      const packed = stored.get(run.id).textContent.slice(body.length + 1);
      run.plots = axisrigPlots.draw(figure, chart, packed, run.id);
    }
    run.tools = [...row.querySelectorAll(".tv")].map((node) => axisrigTool.make(node, run.plots));
  }

  function close(run) {
    if (!run.opened) return;
    run.plots?.remove();
    run.tools.forEach((tool) => tool.remove());
    run.tools = [];
    run.opened.remove();
    run.opened = run.plots = null;
    run.body.querySelector(".opens").setAttribute("aria-expanded", "false");
  }

  function toggle(run) {
    if (run.opened) close(run);
    else open(run);
    keep();
  }

  function show(run) {
    open(run);
    if (run.body.hidden) clearFilter();
    run.body.scrollIntoView({ block: "start" });
    keep();
  }

  /* ---- find, filter, sort ---- */

  const boxes = [...document.querySelectorAll(".filter input")];
  const find = document.getElementById("find");
  const heads = [...document.querySelectorAll(".sort")];
  const order = { by: "", down: false };
  const rank = ["error", "aborted", "fail", "inconclusive", "marginal", "pass"];
  const text = (run, place) => run.body.rows[0].cells[place].textContent.trim();
  const keys = {
    name: (run) => text(run, 0),
    verdict: (run) => rank.indexOf(run.verdict),
    cause: (run) => text(run, 2),
    alarms: (run) => text(run, 3),
    sim: (run) => Number(run.body.dataset.sim),
  };
  const compare = (a, b) => (typeof a === "number"
    ? a - b : a.localeCompare(b, "en", { numeric: true }));

  const cards = [...document.querySelectorAll(".card")];

  /* A card is there while one of its runs is: find and the boxes are for both. */
  function filterCards() {
    const seen = new Set(runs.filter((run) => !run.body.hidden).map((run) => run.card));
    for (const card of cards) card.hidden = !seen.has(card.dataset.card);
    for (const folded of document.querySelectorAll(".folded")) {
      folded.hidden = ![...folded.querySelectorAll(".card")].some((card) => !card.hidden);
    }
  }

  function filter() {
    // A probe may have a verdict that no run has, and so no box
    const unwanted = new Set(boxes.filter((box) => !box.checked).map((box) => box.value));
    const words = find.value.trim().toLowerCase().split(/\s+/).filter(Boolean);
    let shown = 0;
    for (const run of runs) {
      const fits = !unwanted.has(run.verdict) && words.every((word) => run.find.includes(/^card-\d+$/.test(word) ? `${word}.` : word));
      run.body.hidden = !fits;
      shown += fits;
    }
    filterCards();
    document.getElementById("found").textContent =
      shown < runs.length ? `${shown} of ${runs.length}` : "";
    document.getElementById("nothing").hidden = shown > 0;
    map.filter((id) => !byId.get(id).body.hidden);
  }

  function clearFilter() {
    for (const box of boxes) box.checked = true;
    find.value = "";
    filter();
  }

  function sort() {
    const key = keys[order.by];
    const side = order.down ? -1 : 1;
    const values = new Map(key ? runs.map((run) => [run, key(run)]) : []);
    const sorted = [...runs].sort((a, b) =>
      (key ? side * compare(values.get(a), values.get(b)) : 0) || a.index - b.index);
    table.append(...sorted.map((run) => run.body));
    for (const head of heads) {
      const is = head.dataset.sort === order.by;
      if (is) head.closest("th").setAttribute("aria-sort", order.down ? "descending" : "ascending");
      else head.closest("th").removeAttribute("aria-sort");
    }
  }

  /* ---- the address holds what is shown: #find=…&verdict=fail,error&sort=sim&down&open=run ---- */

  function keep() {
    const parts = [];
    const words = find.value.trim();
    if (words) parts.push(`find=${encodeURIComponent(words)}`);
    if (boxes.some((box) => !box.checked)) {
      parts.push(`verdict=${boxes.filter((box) => box.checked).map((box) => box.value)}`);
    }
    if (order.by) parts.push(`sort=${order.by}${order.down ? "&down" : ""}`);
    const opened = runs.filter((run) => run.opened).map((run) => encodeURIComponent(run.id));
    if (opened.length) parts.push(`open=${opened}`);
    history.replaceState(null, "", `#${parts.join("&")}`);
  }

  function restore() {
    const hash = location.hash.slice(1);
    const id = decodeURIComponent(hash);
    if (byId.has(id)) return show(byId.get(id));
    if (id && document.getElementById(id)) return; // a place of the page: what is shown stays
    const asked = new URLSearchParams(hash);
    find.value = asked.get("find") || "";
    const verdicts = asked.get("verdict")?.split(",");
    for (const box of boxes) box.checked = !verdicts || verdicts.includes(box.value);
    order.by = keys[asked.get("sort")] ? asked.get("sort") : "";
    order.down = asked.has("down");
    filter();
    if (order.by) sort();
    if (/^card-\d+$/.test(find.value)) document.getElementById("summary").scrollIntoView();
    const wanted = (asked.get("open") || "").split(",").filter((name) => byId.has(name));
    for (const name of wanted) open(byId.get(name));
    if (wanted.length) byId.get(wanted[0]).body.scrollIntoView({ block: "start" });
  }

  /* ---- printing: runs that did not pass are opened and drawn, in light colours ---- */

  const all = document.getElementById("print_all");
  let openedToPrint = [];

  /* Of equal failures one is printed: the example of their card. */
  const printed = (run) => !run.body.hidden && (all.checked || run.isExample);

  /* Words that the printed part does not use are not printed. */
  const words = [...document.querySelectorAll(".words > div")].map((entry) => ({
    entry,
    names: entry.querySelector("dt").textContent.split(", ").map((name) => ` ${plain(name)} `),
  }));

  function plain(value) {
    return value.toLowerCase().replace(/[^\p{L}\p{N}]+/gu, " ").trim();
  }

  function chooseWords() {
    const parts = [".top", "#failures", "tbody:not(.unprinted) > tr", ".sweeps", ".statistics", ".coverage"]
      .flatMap((part) => [...document.querySelectorAll(part)]);
    const used = ` ${plain(parts.map((part) => part.innerText).join(" "))} `;
    const isUsed = ({ names }) => names.some((name) => used.includes(name)
      || used.includes(`${name.trimEnd()}s `));
    for (const word of words) word.entry.classList.toggle("unprinted", !isUsed(word));
  }

  function beforePrint() {
    document.documentElement.classList.add("printing");
    for (const run of runs) {
      run.body.classList.toggle("unprinted", !printed(run));
      if (!printed(run) || run.opened) continue;
      open(run);
      openedToPrint.push(run);
    }
    chooseWords();
    repaint();
  }

  function afterPrint() {
    document.documentElement.classList.remove("printing");
    for (const run of openedToPrint) close(run);
    for (const word of words) word.entry.classList.remove("unprinted");
    openedToPrint = [];
    repaint();
  }

  const repaint = () => {
    map.draw();
    for (const run of runs) if (run.plots) axisrigPlots.redraw(run.plots);
  };

  /* ---- what the reader does ---- */

  boxes.forEach((box) => box.addEventListener("change", () => { filter(); keep(); }));
  find.addEventListener("input", () => { filter(); keep(); });
  heads.forEach((head) => head.addEventListener("click", () => {
    const by = head.dataset.sort;
    const isAgain = order.by === by;
    if (isAgain && order.down) order.by = "";
    else order.by = by;
    order.down = isAgain && !order.down;
    sort();
    keep();
  }));
  document.addEventListener("click", (event) => {
    const link = event.target.closest("a[href^='#']");
    const run = link && byId.get(link.hash.slice(1));
    if (run) {
      event.preventDefault();
      if (link.classList.contains("opens")) toggle(run);
      else show(run);
      return;
    }
    const row = event.target.closest(".verdicts .row");
    if (row && !event.target.closest("a, button") && !String(getSelection())) {
      toggle(byId.get(row.parentNode.dataset.run));
    }
  });
  document.addEventListener("click", (event) => {
    const node = event.target.closest(".copy");
    if (!node) return;
    const area = document.createElement("textarea");
    area.value = node.dataset.text;
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
    node.textContent = "copied";
    setTimeout(() => { node.textContent = "copy"; }, 1500);
  });
  document.getElementById("print").addEventListener("click", () => print());
  addEventListener("beforeprint", beforePrint);
  addEventListener("afterprint", afterPrint);
  addEventListener("hashchange", restore);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
  restore();
})();
