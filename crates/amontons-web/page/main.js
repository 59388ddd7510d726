"use strict";
const FRAMES = 16;
const TITLES = { deformed: "Displacement", temperature: "Temperature", "von-mises": "Von Mises stress", contact: "Contact", wear: "Wear", history: "History" };
const get = (id) => document.getElementById(id);
const make = (name, text = "", kind = "") => Object.assign(document.createElement(name), { textContent: text, className: kind });
const paper = get("paper").textContent;
const address = URL.createObjectURL(new Blob([get("worker").textContent], { type: "text/javascript" }));

// The library, unpacked once.
const library = (async () => {
  const bytes = Uint8Array.from(atob(get("library").textContent), (c) => c.charCodeAt(0));
  const whole = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(whole).arrayBuffer();
})();

let worker = null, busy = false, shown = null, own = null;
// Whether the text of the case was changed since it was last run: it is not written over then.
let edited = false;
// What is asked for while the worker is busy: the latest of each kind alone.
const waiting = { load: null, run: null, draw: null };

function ask(job, data) {
  waiting[job] = { job, ...data };
  next();
}

function next() {
  if (busy || !worker) return;
  const job = ["load", "run", "draw"].find((name) => waiting[name]);
  get("stop").disabled = job !== "run";
  if (!job) { document.documentElement.dataset.ready = "yes"; return; }
  document.documentElement.dataset.ready = "no";
  busy = true;
  if (job === "run") get("state").textContent = "The case is being solved.";
  worker.postMessage(waiting[job]);
  waiting[job] = null;
}

async function begin() {
  const bytes = await library;
  worker = new Worker(address);
  worker.onmessage = ({ data }) => {
    busy = false;
    answered[data.job](data);
    next();
  };
  worker.onerror = (event) => {
    event.preventDefault();
    restart();
    fail(`The run ended: ${event.message || "the browser gave it no more memory"}. A smaller case may fit.`);
  };
  ask("load", { library: bytes });
}

function restart() {
  worker.terminate();
  [worker, busy, waiting.load, waiting.run, waiting.draw] = [null, false, null, null, null];
  get("stop").disabled = true;
  begin();
}

function fail(text) {
  get("state").textContent = "The pictures show the last case that was solved.";
  get("error").textContent = text;
  get("error").hidden = !text;
}

const answered = {
  load: ({ error }) => { if (error) fail(`The library could not be loaded: ${error}`); },
  run: ({ error, told }) => {
    if (error) return fail(error);
    shown = told;
    fail(told.error ?? "");
    get("state").textContent = `${told.headline}.`;
    lay(told);
    draw();
  },
  draw: ({ drawn, frame }) => {
    for (const [i, figure] of [...get("pictures").children].entries()) {
      const image = figure.querySelector("img");
      if (!drawn?.[i]) { figure.hidden = true; continue; }
      URL.revokeObjectURL(image.src);
      image.src = URL.createObjectURL(new Blob([drawn[i]], { type: "image/svg+xml" }));
      image.dataset.frame = frame;
      figure.hidden = false;
    }
  },
};

// Lays out what a run has to show; pictures that stay are kept, so that the page does not jump.
function lay(told) {
  const frame = get("frame"), last = told.times.length - 1;
  const follows = Number(frame.value) >= Number(frame.max);
  frame.max = last;
  if (follows || Number(frame.value) > last) frame.value = last;
  const names = [...get("pictures").children].map((figure) => figure.id);
  if (names.join() !== told.pictures.join()) {
    get("pictures").replaceChildren(...told.pictures.map((name) => {
      const figure = Object.assign(make("figure"), { id: name });
      figure.append(make("figcaption", TITLES[name] ?? name), Object.assign(make("img"), { alt: TITLES[name] ?? name }));
      return figure;
    }));
  }
  get("rows").replaceChildren(...told.rows.map(([name, text]) => {
    const row = make("tr");
    row.append(Object.assign(make("th", name), { scope: "row" }), make("td", text));
    return row;
  }));
  get("verdicts").replaceChildren(...told.findings.map((finding) => {
    const item = make("li", "", finding.status), line = make("p");
    line.append(make("strong", finding.id), make("span", finding.status, "status"));
    item.append(line, make("p", `${finding.message} (${finding.where})`));
    if (finding.repair) item.append(make("p", `to repair it: ${finding.repair}`, "repair"));
    return item;
  }));
  const link = get("download");
  URL.revokeObjectURL(link.href);
  link.href = URL.createObjectURL(new Blob([JSON.stringify(told.summary, null, 2)], { type: "application/json" }));
  link.hidden = false;
  if (!edited) get("case").value = told.case;
}

function draw() {
  if (!shown) return;
  const frame = Number(get("frame").value);
  document.querySelector(".time output").textContent = `t = ${Number(shown.times[frame].toPrecision(6))}`;
  ask("draw", { names: shown.pictures, frame });
}

// Solves the paper's case with the sliders, or a case of one's own as it stands.
function solve() {
  const [friction, foundation, cells] = ["friction", "foundation", "cells"].map((id) => get(id).value);
  for (const id of ["friction", "foundation"]) document.querySelector(`output[for=${id}]`).textContent = get(id).value;
  const sliders = [`contact.friction.coefficient=${friction}`, `contact.heat.foundation_temperature=${foundation}`, `mesh.n=${cells}`, `time.steps=${cells}`];
  ask("run", { text: own ?? paper, overrides: own === null ? sliders : [], frames: FRAMES });
}

function use(text) {
  [own, edited] = [text, false];
  get("own").hidden = own === null;
  for (const id of ["friction", "foundation", "cells"]) get(id).disabled = own !== null;
  solve();
}

get("controls").addEventListener("input", solve);
get("controls").addEventListener("submit", (event) => event.preventDefault());
get("frame").addEventListener("input", draw);
get("case").addEventListener("input", () => { edited = true; });
get("run").addEventListener("click", () => use(get("case").value));
get("back").addEventListener("click", () => use(null));
get("stop").addEventListener("click", () => { restart(); fail("The run was stopped."); });
solve();
begin();
