"use strict";
// Without this script the page is complete; with it, figures can be enlarged, curves hidden and
// shown, and commands copied.
const GRID = [4000, 1000];

function ticks(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find(s => s * power >= rough * (1 - 1e-9));
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k <= high / step + 1e-9; k++) found.push(k * step);
  const places = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return found.map(v => [v, Math.abs(v) >= 1e5 || step < 1e-4 ? v.toPrecision(2) : v.toFixed(places)]);
}

function points(path) {
  if (path.points) return path.points;
  const found = [];
  let x = 0, y = 0;
  for (const piece of path.getAttribute("d").split("M").slice(1)) {
    const [start, steps] = piece.split("l");
    [x, y] = start.split(" ").map(parseFloat);
    found.push([x, y]);
    const moves = (steps || "").split(" ");
    for (let i = 0; i + 1 < moves.length; i += 2) found.push([x += +moves[i], y += +moves[i + 1]]);
  }
  return path.points = found;
}

// The vertical range, on the grid, of the curves that are shown between two places on it.
function shown(plot, from, to) {
  let top = Infinity, bottom = -Infinity;
  for (const path of plot.querySelectorAll(".curve:not(.off)"))
    for (const [x, y] of points(path))
      if (x >= from && x <= to) { top = Math.min(top, y); bottom = Math.max(bottom, y); }
  if (!(bottom > top)) return [0, GRID[1]];
  const more = 0.06 * (bottom - top);
  return [top - more, bottom + more];
}

function axis(chart, name, values, place) {
  const old = [...chart.querySelectorAll("text." + name)], made = old[0];
  if (!made) return;
  for (const one of old.slice(1)) one.remove();
  values.forEach(([value, label], i) => {
    const text = i ? made.cloneNode() : made;
    text.textContent = label;
    text.setAttribute(name, place(value));
    if (i) made.parentNode.insertBefore(text, made);
  });
}

function zoom(figure, from, to) {
  const whole = from <= 0 && to >= GRID[0];
  if (whole) [from, to] = [0, GRID[0]];
  figure.range = [from, to];
  for (const chart of figure.querySelectorAll(".chart")) {
    const plot = chart.querySelector(".plot"), box = n => +plot.getAttribute(n);
    const [top, bottom] = whole ? [0, GRID[1]] : shown(plot, from, to);
    plot.setAttribute("viewBox", [from, top, to - from, bottom - top].join(" "));
    const [t0, t1] = chart.dataset.x.split(" ").map(Number);
    const [y0, y1] = chart.dataset.y.split(" ").map(Number);
    const at = x => t0 + (t1 - t0) * x / GRID[0], up = y => y1 - (y1 - y0) * y / GRID[1];
    const a = at(from), b = at(to), high = up(top), low = up(bottom);
    axis(chart, "x", ticks(a, b, 5), v => box("x") + box("width") * (v - a) / (b - a));
    axis(chart, "y", ticks(low, high, 4), v => box("y") + box("height") * (high - v) / (high - low) + 3.5);
  }
}

function move(figure, what) {
  const [from, to] = figure.range || [0, GRID[0]], wide = to - from;
  const [start, end] = {
    in: [from + wide / 4, to - wide / 4], out: [from - wide / 2, to + wide / 2],
    left: [from - wide / 2, to - wide / 2], right: [from + wide / 2, to + wide / 2], reset: [0, GRID[0]],
  }[what];
  const shift = Math.max(0, -start) - Math.max(0, end - GRID[0]);
  if (end - start >= GRID[0]) zoom(figure, 0, GRID[0]);
  else zoom(figure, start + shift, end + shift);
}

function dragging(figure, plot) {
  const place = event => {
    const box = plot.getScreenCTM().inverse();
    return box.a * event.clientX + box.e;
  };
  plot.addEventListener("pointerdown", event => {
    if (event.pointerType === "touch") return;
    event.preventDefault();
    const from = place(event), mark = document.createElementNS(plot.namespaceURI, "rect");
    const box = plot.viewBox.baseVal;
    mark.setAttribute("class", "select");
    mark.setAttribute("y", box.y);
    mark.setAttribute("height", box.height);
    plot.append(mark);
    plot.setPointerCapture(event.pointerId);
    const draw = e => {
      mark.setAttribute("x", Math.min(from, place(e)));
      mark.setAttribute("width", Math.abs(place(e) - from));
    };
    plot.addEventListener("pointermove", draw);
    plot.addEventListener("pointerup", e => {
      plot.removeEventListener("pointermove", draw);
      mark.remove();
      const ends = [from, place(e)].sort((a, b) => a - b);
      if (ends[1] - ends[0] > 0.01 * box.width) zoom(figure, Math.max(0, ends[0]), Math.min(GRID[0], ends[1]));
    }, {once: true});
  });
  plot.addEventListener("dblclick", () => zoom(figure, 0, GRID[0]));
}

for (const figure of document.querySelectorAll(".zoomable")) {
  for (const button of figure.querySelectorAll("[data-do]"))
    button.addEventListener("click", () => move(figure, button.dataset.do));
  for (const plot of figure.querySelectorAll(".plot")) dragging(figure, plot);
  for (const box of figure.querySelectorAll("[data-style]"))
    box.addEventListener("change", () => {
      for (const path of figure.querySelectorAll(".curve." + box.dataset.style)) path.classList.toggle("off", !box.checked);
    });
}

for (const button of document.querySelectorAll("[data-copy]"))
  button.addEventListener("click", async () => {
    const text = button.parentNode.querySelector("pre");
    try {
      await navigator.clipboard.writeText(text.textContent);
      button.textContent = "copied";
    } catch {
      getSelection().selectAllChildren(text);
    }
  });

const links = new Map([...document.querySelectorAll("nav a")].map(a => [a.hash.slice(1), a]));
const seen = new IntersectionObserver(entries => {
  for (const entry of entries)
    if (entry.isIntersecting) {
      for (const link of links.values()) link.removeAttribute("aria-current");
      const link = links.get(entry.target.id);
      link.setAttribute("aria-current", "true");
      const list = link.closest("ol");
      if (list.scrollWidth > list.clientWidth) list.scrollLeft = link.offsetLeft - list.clientWidth / 3;
    }
}, {rootMargin: "0px 0px -70% 0px"});
for (const section of document.querySelectorAll("main > section")) seen.observe(section);
