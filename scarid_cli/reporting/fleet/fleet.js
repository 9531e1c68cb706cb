"use strict";
// The table of logs: searched, filtered, sorted and shown page by page, so that ten thousand rows
// open as fast as a hundred.
const SIZE = 100;
const data = JSON.parse(document.getElementById("data").textContent);
const labels = new Map([...document.querySelectorAll("[data-state]")].map(b => [b.dataset.state, b.lastChild.textContent.trim()]));
const find = id => document.getElementById(id), table = find("table"), body = table.tBodies[0];
const chosen = {state: "", robot: "", text: "", sort: null, down: false, page: 0};
let rows = data.rows, texts = null;

function searchable() {
  return texts ||= new Map(data.rows.map(row => [row, row[1].join("\t").toLowerCase()]));
}

function select() {
  const words = chosen.text.toLowerCase().split(/\s+/).filter(Boolean);
  rows = data.rows.filter(row =>
    (!chosen.state || row[0] === chosen.state) && (!chosen.robot || row[1][0] === chosen.robot)
    && words.every(word => searchable().get(row).includes(word)));
  if (chosen.sort !== null) {
    const at = chosen.sort, sign = chosen.down ? -1 : 1;
    if (data.numeric.includes(data.headers[at])) {
      const key = new Map(rows.map(row => [row, Math.min(...row[1][at].split(" ± ")[0].split(" ").map(parseFloat))]));
      const last = v => Number.isNaN(v) ? Infinity : sign * v;
      rows.sort((a, b) => last(key.get(a)) - last(key.get(b)) || 0);
    } else {
      const compare = new Intl.Collator("en", {numeric: true}).compare;
      rows.sort((a, b) => sign * compare(a[1][at], b[1][at]));
    }
  }
  chosen.page = 0;
  show();
}

function element(name, text, style) {
  const made = document.createElement(name);
  if (text) made.textContent = text;
  if (style) made.className = style;
  return made;
}

function drawn(row) {
  const [state, cells, link] = row, line = element("tr", "", state), tag = element("td");
  tag.append(element("span", labels.get(state), "tag " + state));
  line.append(tag);
  cells.forEach((cell, i) => {
    const place = element("td", i === 1 && link ? "" : cell);
    if (i === 1 && link) {
      const to = element("a", cell);
      to.href = link;
      place.append(to);
    }
    line.append(place);
  });
  return line;
}

function show() {
  const pages = Math.max(1, Math.ceil(rows.length / SIZE));
  chosen.page = Math.min(Math.max(chosen.page, 0), pages - 1);
  body.replaceChildren(...rows.slice(chosen.page * SIZE, (chosen.page + 1) * SIZE).map(drawn));
  const robot = chosen.robot ? " of " + chosen.robot : "";
  find("shown").textContent = `${rows.length.toLocaleString("en")} of ${data.rows.length.toLocaleString("en")} logs${robot}`;
  find("place").textContent = ` ${chosen.page + 1} / ${pages} `;
  find("before").disabled = chosen.page === 0;
  find("after").disabled = chosen.page === pages - 1;
  for (const head of table.tHead.rows[0].cells) {
    const button = head.querySelector("button");
    if (button && +button.dataset.sort === chosen.sort) head.setAttribute("aria-sort", chosen.down ? "descending" : "ascending");
    else head.removeAttribute("aria-sort");
  }
}

function opened(line) {
  if (line.nextSibling?.className === "detail") return line.nextSibling.remove();
  const row = rows[chosen.page * SIZE + [...body.querySelectorAll("tr:not(.detail)")].indexOf(line)];
  const detail = element("tr", "", "detail"), cell = element("td"), list = element("dl");
  cell.colSpan = data.headers.length + 1;
  for (const [name, text] of row[3]) list.append(element("dt", name), element("dd", text));
  cell.append(list);
  detail.append(cell);
  line.after(detail);
}

function saved(kind) {
  const objects = rows.map(([state, cells, page, details]) => ({
    outcome: labels.get(state), ...Object.fromEntries(data.headers.map((name, i) => [name, cells[i]])), page,
    ...(kind === "json" ? {details: Object.fromEntries(details)} : {}),
  }));
  const names = ["outcome", ...data.headers, "page"], clean = text => text.replace(/[\t\n\r]/g, " ");
  const text = kind === "json" ? JSON.stringify(objects, null, 1)
    : [names, ...objects.map(o => names.map(n => clean(o[n])))].map(line => line.join("\t") + "\n").join("");
  const link = element("a");
  link.href = URL.createObjectURL(new Blob([text], {type: "text/plain"}));
  link.download = "logs." + kind;
  link.click();
  URL.revokeObjectURL(link.href);
}

for (const button of document.querySelectorAll("[data-state]"))
  button.addEventListener("click", () => {
    chosen.state = button.dataset.state;
    if (!chosen.state) chosen.robot = "";
    for (const other of document.querySelectorAll("[data-state]")) other.setAttribute("aria-pressed", other === button);
    select();
  });
for (const button of document.querySelectorAll("[data-robot]"))
  button.addEventListener("click", () => {
    chosen.robot = button.dataset.robot;
    select();
    find("logs").scrollIntoView();
  });
for (const button of document.querySelectorAll("[data-sort]"))
  button.addEventListener("click", () => {
    const at = +button.dataset.sort;
    chosen.down = chosen.sort === at && !chosen.down;
    chosen.sort = at;
    select();
  });
for (const button of document.querySelectorAll("[data-save]"))
  button.addEventListener("click", () => saved(button.dataset.save));
let waiting;
find("search").addEventListener("input", event => {
  clearTimeout(waiting);
  waiting = setTimeout(() => { chosen.text = event.target.value; select(); }, 120);
});
find("before").addEventListener("click", () => { chosen.page--; show(); });
find("after").addEventListener("click", () => { chosen.page++; show(); });
body.addEventListener("click", event => {
  const line = event.target.closest("tr");
  if (line && line.className !== "detail" && !event.target.closest("a")) opened(line);
});
show();
