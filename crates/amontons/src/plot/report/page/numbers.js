// Numbers and texts.

const report = JSON.parse(document.getElementById("data").textContent);
const PARTS = 65534;
let bytes = new Uint8Array();

/** Reads the arrays of the page: whole numbers by their differences, byte by byte. */
async function unpack() {
  const text = atob(document.getElementById("arrays").textContent);
  const packed = Uint8Array.from(text, (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  bytes = new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The array of a number: counts, or 16-bit shares. */
function counts(index) {
  const [start, count, width] = report.arrays[index];
  const values = width === 2 ? new Uint16Array(count) : new Uint32Array(count);
  let sum = 0;
  for (let i = 0; i < count; i++) {
    let step = 0;
    for (let b = 0; b < width; b++) step |= bytes[start + b * count + i] << (8 * b);
    sum = (sum + step) >>> 0;
    values[i] = sum;
  }
  return values;
}

/** The array of a number as real numbers. */
const reals = (index) => new Float32Array(counts(index).buffer);

/** Values of a field between the ends of its range, each component and snapshot once. */
const kept = new Map();
function values(field, component, frame) {
  const index = field.arrays[component][frame];
  if (!kept.has(index)) {
    const [low, high] = field.range;
    kept.set(index, Float32Array.from(counts(index), (v) =>
      v === report.none ? NaN : low + (high - low) * v / PARTS));
  }
  return kept.get(index);
}

/** The values of a field, of a vector its magnitude. */
function magnitudes(field, frame) {
  if (field.arrays.length === 1) return values(field, 0, frame);
  const all = field.arrays.map((_, c) => values(field, c, frame));
  return all[0].map((_, i) => Math.hypot(...all.map((component) => component[i])));
}

/** A number with four digits. */
function number(v, digits = 4) {
  if (!Number.isFinite(v)) return "–";
  if (v === 0) return "0";
  const size = Math.abs(v);
  if (size >= 1e-3 && size < 1e6) {
    const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
    return v.toFixed(Math.min(decimals, 12)).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "").replace("-", "−");
  }
  const [mantissa, power] = v.toExponential(digits - 1).split("e");
  const raised = power.replace("+", "").replace(/./g, (c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻");
  return `${mantissa.replace(/\.?0+$/, "").replace("-", "−")}·10${raised}`;
}

const withUnit = (text, unit) => (unit ? `${text}\u00a0${unit}` : text);

/** An element with attributes and children; texts may have subscripts and superscripts: σ_{vM}, 10^{3}. */
function element(name, attributes = {}, ...children) {
  const isDrawn = ["svg", "g", "path", "line", "rect", "text"].includes(name);
  const node = isDrawn ? document.createElementNS("http://www.w3.org/2000/svg", name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value !== undefined && value !== null) node.setAttribute(key, value);
  }
  for (const child of children.flat()) {
    if (typeof child === "string" && !isDrawn) node.append(...typeset(child));
    else node.append(child);
  }
  return node;
}

function typeset(text) {
  return text.split(/([_^]\{[^}]*\})/).filter((part) => part).map((part) => {
    const level = part.match(/^([_^])\{([^}]*)\}$/);
    if (!level) return document.createTextNode(part);
    const node = document.createElement(level[1] === "_" ? "sub" : "sup");
    node.textContent = level[2];
    return node;
  });
}

/** `name symbol (unit)` of a field or chart. */
const titled = ({ name, symbol, unit }) => `${name}${symbol ? ` ${symbol}` : ""}${unit ? ` (${unit})` : ""}`;

/** Round numbers within a range, about so many. */
function ticks(low, high, most) {
  if (!(high > low)) return [low];
  const raw = (high - low) / most;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw * (1 - 1e-9));
  const all = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) all.push(i * step);
  return all;
}

/** Smallest and largest finite value. */
function extremes(lists) {
  let [low, high] = [Infinity, -Infinity];
  for (const list of lists) {
    for (const v of list) {
      if (v < low) low = v;
      if (v > high) high = v;
    }
  }
  return low <= high ? [low, high] : [0, 0];
}
