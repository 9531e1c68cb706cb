"use strict";
(() => {
  const { robots, logs } = JSON.parse(document.getElementById("data").textContent);
  const FINE = 4, ROWS = 50, SHOWN = 4;
  const SVG = "http://www.w3.org/2000/svg";
  const live = document.getElementById("live");
  const [head, body] = [live.querySelector("thead"), live.querySelector("tbody")];
  const form = live.querySelector("form");
  const pages = live.querySelector("nav");

  // Elements: text is always set as text, never as markup.
  const make = (tag, attributes = {}, ...children) =>
    filled(document.createElement(tag), attributes, children);
  const draw = (tag, attributes, ...children) =>
    filled(document.createElementNS(SVG, tag), attributes, children);
  function filled(element, attributes, children) {
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.append(...children.filter((child) => child !== null && child !== ""));
    return element;
  }

  // The history of a parameter, and where this log stands in it.
  const x = (robot, order, width) => ((order - 0.5) * width) / robot.logs;
  function y(parameter, value, height) {
    const [low, high] = parameter.limits;
    const inside = Math.min(Math.max(value, low), high);
    return height - 3 - ((height - 6) * (inside - low)) / (high - low || 1);
  }
  const point = (a, b) => `${a.toFixed(1)},${b.toFixed(1)}`;
  function paths(robot, parameter, width, height) {
    const count = parameter.order.length, groups = Math.min(count, width >> 1);
    const top = [], bottom = [], line = [];
    for (let g = 0; g < groups; g++) {
      const from = Math.round((g * count) / groups), to = Math.round(((g + 1) * count) / groups);
      let [low, high, least, greatest] = [Infinity, -Infinity, Infinity, -Infinity];
      for (let i = from; i < to; i++) {
        const value = parameter.estimate[i], half = parameter.half[i];
        low = Math.min(low, value - half);
        high = Math.max(high, value + half);
        least = Math.min(least, value);
        greatest = Math.max(greatest, value);
      }
      const at = x(robot, (parameter.order[from] + parameter.order[to - 1]) / 2, width);
      top.push(point(at, y(parameter, high, height)));
      bottom.unshift(point(at, y(parameter, low, height)));
      line.push(point(at, y(parameter, least, height)), point(at, y(parameter, greatest, height)));
    }
    return [top.concat(bottom).join(" "), line.join(" ")];
  }
  const drawn = new Map();
  function background(robot, parameter, width, height) {
    const sizes = drawn.get(parameter) ?? drawn.set(parameter, {}).get(parameter);
    return (sizes[width] ??= paths(robot, parameter, width, height));
  }
  const shown = (parameter, value) =>
    (value / 10 ** parameter.decimals).toFixed(Math.max(0, parameter.decimals));
  function spark(i, parameter, width, height) {
    const robot = robots[logs.robot[i]], k = parameter.order.indexOf(logs.order[i]);
    const [value, half] = [parameter.estimate[k], parameter.half[k]];
    const [band, line] = background(robot, parameter, width, height);
    const at = x(robot, logs.order[i], width).toFixed(1);
    const level = (v) => y(parameter, v, height).toFixed(1);
    const differs = logs.differing[i].includes(parameter.name);
    const trend = robot.trending.includes(parameter.name);
    const words = `${shown(parameter, value)} ± ${shown(parameter, half)} ${parameter.unit}`;
    const said = (differs ? ", differs from the reference" : "") + (trend ? ", has a trend" : "");
    const svg = draw("svg", { width, height, viewBox: `0 0 ${width} ${height}`, role: "img",
      "aria-label": `${parameter.name} ${words}${said}` },
      draw("title", {}, `${parameter.name} ${words}${said}`),
      draw("polygon", { class: "band", points: band }),
      draw("polyline", { class: "line", points: line }),
      draw("line", { class: "here", x1: at, x2: at, y1: level(value - half), y2: level(value + half) }),
      draw("circle", { class: "here", cx: at, cy: level(value), r: 2.2 }));
    const sign = (differs ? " ◆" : "") + (trend ? " ↗" : "");
    const number = width > 100 ? words : shown(parameter, value);
    return make("span", { class: differs ? "spark differs" : "spark" },
      make("small", {}, make("b", {}, parameter.name), `${sign} ${number}`), svg);
  }
  function parametersOf(i) {
    const robot = robots[logs.robot[i]];
    const weight = (p) => {
      const differs = logs.differing[i].indexOf(p.name), trend = robot.trending.indexOf(p.name);
      return differs >= 0 ? differs : trend >= 0 ? 1000 + trend : 10000;
    };
    return robot.parameters.filter((p) => p.order.includes(logs.order[i]))
      .sort((a, b) => weight(a) - weight(b));
  }

  // The cells of a row.
  const marks = (i) => logs.marks[i].flatMap(([need, label]) =>
    [make("span", { class: `mark need${need}` }, label), " "]);
  const least = (values) => Math.min(...values.filter((v) => v !== null));
  const joints = (values) => make("span", { class: "joints" },
    ...values.map((v) => make("span", {}, v === null ? "-" : v.toFixed(4))));
  function delay(i, margin) {
    if (logs.delay[i] === null) return "";
    const half = logs.error[i] === null ? "" : ` ± ${(1960 * logs.error[i]).toFixed(2)}`;
    return (1000 * logs.delay[i]).toFixed(2) + half + margin;
  }
  function nameOf(i) {
    const log = logs.log[i], page = logs.page[i], date = logs.date[i];
    const link = page ? make("a", { href: page }, log) : log;
    const dated = date && !log.includes(date) ? make("small", {}, make("br"), date) : "";
    return [link, dated];
  }
  function toggle(i) {
    const text = `Details of ${robots[logs.robot[i]].name}, ${logs.log[i]}`;
    const button = make("button", { type: "button", class: "toggle", "aria-expanded": "false",
      "aria-label": text }, "+");
    button.addEventListener("click", () => {
      const open = button.getAttribute("aria-expanded") === "true", row = button.closest("tr");
      button.setAttribute("aria-expanded", String(!open));
      button.textContent = open ? "+" : "−";
      open ? row.nextSibling.remove() : row.after(details(i));
    });
    return button;
  }
  const why = (i) => (logs.notes[i].length ? make("span", { class: "why" }, logs.notes[i][0][1]) : "");
  const CHECKS = ["failed", "warning", "ok"], VERDICTS = ["not identifiable", "doubtful", "good"];
  const rank = (names, name) => (name === null ? null : names.indexOf(name));
  const columns = [
    { title: "Robot", key: (i) => robots[logs.robot[i]].name, fill: (i) => [robots[logs.robot[i]].name] },
    { title: "Log", key: (i) => logs.date[i] ?? logs.log[i], fill: (i) => [toggle(i), ...nameOf(i)] },
    { title: "Finding", key: (i) => logs.place[i], fill: (i) => [...marks(i), why(i)] },
    { title: "Check", named: true, key: (i) => rank(CHECKS, logs.check[i]),
      fill: (i) => [logs.check[i] ?? ""] },
    { title: "Verdict", named: true, key: (i) => rank(VERDICTS, logs.verdict[i]),
      fill: (i) => [logs.verdict[i] ?? ""] },
    { title: "R² of joints", named: true, key: (i) => (logs.r2[i].length ? least(logs.r2[i]) : null),
      fill: (i) => (logs.r2[i].length ? [joints(logs.r2[i])] : []) },
    { title: "Delay [ms]", named: true, key: (i) => logs.delay[i], fill: (i) => [delay(i, "")] },
    { title: "Parameters", down: true, key: (i) => logs.apart[i],
      fill: (i) => parametersOf(i).slice(0, SHOWN).map((p) => spark(i, p, 92, 24)) },
  ];
  function row(i) {
    return make("tr", {}, ...columns.map((column, c) => {
      const cell = column.fill(i).filter((part) => part !== "");
      const name = { class: `c${c}`, ...(column.named ? { "data-name": column.title } : {}) };
      return c === 1 ? make("th", { scope: "row", class: "c1" }, ...cell) : make("td", name, ...cell);
    }));
  }
  function details(i) {
    const robot = robots[logs.robot[i]], list = make("dl");
    const say = (name, ...value) => list.append(make("dt", {}, name), make("dd", {}, ...value));
    for (const [command, text] of logs.notes[i]) say(command, text);
    say("Place in the robot's logs", `${logs.order[i]} of ${robot.logs}`);
    if (logs.reference[i]) say("Reference", logs.reference[i]);
    if (logs.validated[i].length) say("R² by the parameters of other logs", joints(logs.validated[i]));
    if (logs.samples[i]) say("Samples", logs.samples[i].toLocaleString("en"));
    if (logs.condition[i]) say("Condition number", String(logs.condition[i]));
    if (logs.delay[i] !== null) say("Delay", delay(i, " ms"));
    if (logs.apart[i] !== null) say("Largest difference", `${logs.apart[i]} standard errors`);
    const all = parametersOf(i).map((p) => spark(i, p, 160, 44));
    const trends = robot.trending.length ? [make("p", {}, `Trend: ${robot.trending.join(", ")}`)] : [];
    return make("tr", { class: "more" }, make("td", { colspan: columns.length }, list, ...trends, ...all));
  }

  // What is shown: filtered, sorted, one page at a time.
  const all = logs.robot.map((_, i) => i);
  const texts = [];
  const textOf = (i) => (texts[i] ??= [robots[logs.robot[i]].name, logs.log[i], logs.date[i],
    logs.check[i], logs.verdict[i], logs.differing[i].join(" "), ...logs.marks[i].flat(), ...logs.notes[i].flat()].join("\n").toLowerCase());
  let [sorted, down, page] = [2, false, 0];
  function fits(i, need) {
    const found = logs.marks[i].map(([rank]) => rank);
    return need === "look" ? found.length > 0 : +need === FINE ? !found.length : found.includes(+need);
  }
  function found() {
    const words = form.elements.text.value.toLowerCase().split(/\s+/).filter(Boolean);
    const { value: robot } = form.elements.robot, { value: need } = form.elements.need;
    return all.filter((i) => (robot === "" || logs.robot[i] === +robot)
      && (need === "" || fits(i, need))
      && words.every((word) => textOf(i).includes(word)));
  }
  const natural = new Intl.Collator("en", { numeric: true });
  const missing = (key) => key === null || key === undefined || Number.isNaN(key);
  function ordered(rows) {
    const keys = new Map(rows.map((i) => [i, columns[sorted].key(i)])), sign = down ? -1 : 1;
    const compare = (a, b) => (typeof a === "string" ? natural.compare(a, b) : a - b);
    return rows.sort((i, j) => {
      const [a, b] = [keys.get(i), keys.get(j)];
      if (missing(a) || missing(b)) return missing(a) - missing(b) || i - j;
      return sign * compare(a, b) || i - j;
    });
  }
  function turn(text, to, possible) {
    const button = make("button", { type: "button" }, text);
    button.disabled = !possible;
    button.addEventListener("click", () => { page = to; show(); live.scrollIntoView(); });
    return button;
  }
  function show() {
    const rows = ordered(found()), last = Math.max(0, Math.ceil(rows.length / ROWS) - 1);
    page = Math.min(page, last);
    const start = page * ROWS, part = rows.slice(start, start + ROWS);
    body.replaceChildren(...part.map(row));
    const [count, total] = [rows.length, all.length].map((n) => n.toLocaleString("en"));
    form.querySelector("output").textContent = `${count} of ${total} logs`;
    pages.hidden = last === 0;
    pages.replaceChildren(turn("Previous", page - 1, page > 0),
      `Rows ${start + 1} to ${start + part.length} of ${count}`, turn("Next", page + 1, page < last));
    head.firstChild.childNodes.forEach((cell, c) =>
      cell.setAttribute("aria-sort", c !== sorted ? "none" : down ? "descending" : "ascending"));
  }
  function header(column, c) {
    const button = make("button", { type: "button", title: "Sort by this column" }, column.title);
    button.addEventListener("click", () => {
      down = sorted === c ? !down : Boolean(column.down);
      [sorted, page] = [c, 0];
      show();
    });
    return make("th", { scope: "col" }, button);
  }

  // Set up: the static table is for print, and for browsers without scripts.
  head.append(make("tr", {}, ...columns.map(header)));
  form.elements.robot.append(...robots.map((robot, i) => make("option", { value: i }, robot.name)));
  form.addEventListener("input", () => { page = 0; show(); });
  form.addEventListener("submit", (event) => event.preventDefault());
  document.querySelectorAll("a[data-need], a[data-robot]").forEach((link) =>
    link.addEventListener("click", () => {
      form.elements.text.value = "";
      form.elements.need.value = link.dataset.need ?? "";
      form.elements.robot.value = link.dataset.robot ?? "";
      [sorted, down, page] = [2, false, 0];
      show();
    }));
  document.getElementById("static").classList.add("printed");
  live.hidden = false;
  show();
})();
