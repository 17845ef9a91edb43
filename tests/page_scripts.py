"""Scripts of pages in node, without a browser; with as little of a page as they need."""

import json
import shutil
import subprocess
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

needs_node = pytest.mark.skipif(shutil.which("node") is None, reason="needs node")

ELEMENTS = r"""
class Classes {
  constructor(owner) { this.owner = owner; }
  get all() { return this.owner.className.split(" ").filter(Boolean); }
  set all(names) { this.owner.className = [...new Set(names)].join(" "); }
  contains(name) { return this.all.includes(name); }
  add(name) { this.all = [...this.all, name]; }
  remove(name) { this.all = this.all.filter((one) => one !== name); }
  toggle(name, is = !this.contains(name)) { if (is) this.add(name); else this.remove(name); }
}
class Shown {
  constructor(tag) {
    Object.assign(this, {tag, className: "", children: [], set: {}, dataset: {}, heard: {},
      style: {}, hidden: false, parent: null, made: 0});
    this.classList = new Classes(this);
  }
  append(...inside) {
    for (const one of inside) {
      one?.remove?.();
      if (one instanceof Shown) one.parent = this;
      this.children.push(one);
    }
  }
  replaceChildren(...inside) { this.children = []; this.made += 1; this.append(...inside); }
  remove() {
    if (this.parent) this.parent.children = this.parent.children.filter((one) => one !== this);
    this.parent = null;
  }
  get textContent() { return this.children.map((one) => one.textContent ?? String(one)).join(""); }
  set textContent(text) { this.replaceChildren(String(text)); }
  setAttribute(key, value) {
    this.set[key] = String(value);
    if (key === "class") this.className = String(value);
  }
  getAttribute(key) { return this.set[key] ?? null; }
  removeAttribute(key) { delete this.set[key]; }
  addEventListener(kind, act) { (this.heard[kind] ??= []).push(act); }
  fire(kind, event = {}) {
    for (const act of this.heard[kind] ?? []) act({target: this, preventDefault() {}, ...event});
  }
  get every() { return this.children.flatMap((one) => one.every ? [one, ...one.every] : []); }
  fits(one) {
    return one.startsWith(".") ? this.classList.contains(one.slice(1)) : this.tag === one;
  }
  querySelectorAll(path) {
    const inside = (part) => (place) => place.every.filter((one) => one.fits(part));
    return path.trim().split(/\s+/).reduce((all, part) => all.flatMap(inside(part)), [this]);
  }
  querySelector(path) { return this.querySelectorAll(path)[0] ?? null; }
}
const places = {};
globalThis.document = {
  documentElement: new Shown("html"), body: new Shown("body"), title: "",
  createElement: (tag) => new Shown(tag),
  createElementNS: (space, tag) => new Shown(tag),
  getElementById: (id) => places[id] ??= new Shown(id),
};
globalThis.devicePixelRatio = 1;
globalThis.getComputedStyle = () => ({getPropertyValue: (name) => name});
globalThis.ResizeObserver = class {
  constructor(act) { globalThis.resized = act; }
  observe() {}
  disconnect() { globalThis.resized = null; }
};
"""
"""Elements that can be asked for what they show, and a document of them; a colour is its name."""


def value_in_node(expression: str, scripts: Iterable[Path], page: str = "") -> Any:
    """The value of an expression after the scripts, which find `page` before them."""
    texts = [page, *(script.read_text("utf-8") for script in scripts)]
    texts.append(f"console.log(JSON.stringify({expression}));")
    out = subprocess.run(
        ["node", "-"], input="\n".join(texts), capture_output=True, text=True, check=True,
        encoding="utf-8",
    )  # fmt: skip
    return json.loads(out.stdout)
