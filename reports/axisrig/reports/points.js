"use strict";
/* The value under the pointer: of the dot of a drawing that is nearest, in words at its top. */
(() => {
  const NEAR_PX = 28;
  const places = new WeakMap();
  let said = null;

  /* The dots of a drawing with their middles, in its own units. */
  function dotsOf(svg) {
    if (!places.has(svg)) {
      places.set(svg, [...svg.querySelectorAll(".dot")].map((dot) => {
        const { x, y, width, height } = dot.getBBox();
        return { dot, x: x + width / 2, y: y + height / 2 };
      }));
    }
    return places.get(svg);
  }

  function forget() {
    if (!said) return;
    said.words.remove();
    said.dot.classList.remove("near");
    said = null;
  }

  document.addEventListener("pointermove", (event) => {
    const svg = event.target.closest?.("svg.dots");
    if (!svg) return forget();
    const box = svg.getBoundingClientRect();
    const { width, height } = svg.viewBox.baseVal;
    const x = (event.clientX - box.left) / box.width * width;
    const y = (event.clientY - box.top) / box.height * height;
    let least = NEAR_PX, nearest = null;
    for (const one of dotsOf(svg)) {
      const far = Math.hypot(one.x - x, one.y - y);
      if (far < least) [least, nearest] = [far, one];
    }
    if (said && said.dot === nearest?.dot) return;
    forget();
    if (!nearest) return;
    const words = document.createElementNS("http://www.w3.org/2000/svg", "text");
    words.setAttribute("class", "dots-at");
    words.setAttribute("x", width - 8);
    words.setAttribute("y", 11);
    words.setAttribute("text-anchor", "end");
    words.textContent = nearest.dot.querySelector("title").textContent;
    nearest.dot.classList.add("near");
    svg.append(words);
    said = { dot: nearest.dot, words };
  });
})();
