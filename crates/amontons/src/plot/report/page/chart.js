// A chart of lines, with a reading at each point and a table of values.

const MARGIN = { left: 58, right: 12, top: 8, bottom: 34 };

class Chart {
  /**
   * `spec`: name, unit, x: { values, label, unit, text }, series of { label, color, dashes, values }, whether these are
   * `stacked`, the range `y` of all times, the pieces that lines are made of, and what else the caption says.
   */
  constructor(spec) {
    [this.spec, this.at, this.mark] = [spec, null, null];
    this.svg = element("svg", { tabindex: 0, role: "img" });
    this.readout = element("p", { class: "read", "aria-live": "polite" });
    const sign = ({ color, dashes, label }) => {
      const line = element("svg", { width: 26, height: 10, "aria-hidden": "true" },
        spec.stacked ? element("rect", { width: 26, height: 10, fill: color })
          : element("line", { x1: 0, x2: 26, y1: 5, y2: 5, stroke: color, "stroke-width": 2.4,
            "stroke-dasharray": dashes?.join(" ") }));
      return element("span", { class: "entry" }, line, label);
    };
    const entries = spec.series.filter((one) => one.label).map(sign);
    const table = element("details", { class: "table" }, element("summary", {}, "Table of values"));
    table.addEventListener("toggle", () => { if (table.open) this.fillTable(table); });
    this.table = table;
    this.node = element("figure", { class: "chart" },
      element("figcaption", {}, element("span", { class: "title" }, titled(spec)), ...entries),
      this.svg, this.readout, table);
    this.listen();
    new ResizeObserver(() => this.draw()).observe(this.node);
  }

  listen() {
    const { svg } = this;
    for (const kind of ["pointerdown", "pointermove"]) {
      svg.addEventListener(kind, (event) => {
        const box = svg.getBoundingClientRect();
        this.readAt(this.nearest(this.value(event.clientX - box.left)));
      });
    }
    svg.addEventListener("pointerleave", () => this.readAt(null));
    svg.addEventListener("blur", () => this.readAt(null));
    svg.addEventListener("keydown", (event) => {
      const last = this.spec.x.values.length - 1;
      const page = Math.max(1, Math.round(last / 10));
      const steps = { ArrowLeft: -1, ArrowRight: 1, PageUp: page, PageDown: -page, Home: -Infinity, End: Infinity };
      if (!(event.key in steps)) return;
      event.preventDefault();
      const from = this.at ?? (steps[event.key] > 0 ? -1 : last + 1);
      this.readAt(Math.max(0, Math.min(last, from + steps[event.key])));
    });
  }

  /** The tops of the lines: stacked ones stand on those before. */
  tops() {
    const lists = this.spec.series.map((one) => one.values);
    if (!this.spec.stacked) return lists;
    const sums = new Float32Array(this.spec.x.values.length);
    return lists.map((list) => Float32Array.from(list, (v, i) => (sums[i] += v)));
  }

  range() {
    const [low, high] = this.spec.y ?? extremes(this.tops());
    const [least, most] = [Math.min(0, low), Math.max(0, high)];
    const isFar = low > 0.6 * high || high < 0.6 * low;
    const [a, b] = isFar && !this.spec.stacked ? [low, high] : [least, most];
    if (a === b) return a ? [a - 0.5 * Math.abs(a), a + 0.5 * Math.abs(a)] : [0, 1];
    const room = 0.05 * (b - a);
    return [a === 0 ? 0 : a - room, b === 0 ? 0 : b + room];
  }

  nearest(x) {
    const all = this.spec.x.values;
    let best = 0;
    for (let i = 1; i < all.length; i++) if (Math.abs(all[i] - x) < Math.abs(all[best] - x)) best = i;
    return best;
  }

  /** The value of x at a place from the left of the chart. */
  value(pixels) {
    const { left, right } = MARGIN;
    return this.from + (this.to - this.from) * (pixels - left) / (this.width - left - right);
  }

  draw() {
    const { spec } = this;
    this.width = Math.max(240, this.node.clientWidth);
    this.height = spec.tall ? 260 : 190;
    [this.from, this.to] = spec.x.range ?? extremes([spec.x.values]);
    if (this.to === this.from) [this.from, this.to] = [this.from - 0.5, this.to + 0.5];
    [this.low, this.high] = this.range();
    const { left, right, top, bottom } = MARGIN;
    this.x = (v) => left + (this.width - left - right) * (v - this.from) / (this.to - this.from);
    this.y = (v) => this.height - bottom - (this.height - top - bottom) * (v - this.low) / (this.high - this.low);
    this.svg.setAttribute("viewBox", `0 0 ${this.width} ${this.height}`);
    this.svg.setAttribute("height", this.height);
    const tops = this.tops();
    this.svg.replaceChildren(this.grid(), ...spec.series.map((one, k) => this.line(one, tops, k)).reverse());
    this.cursor = element("g", { class: "cursor" });
    this.svg.append(this.cursor);
    this.describe(tops);
    this.drawCursor();
  }

  grid() {
    const grid = element("g", { class: "grid" });
    const text = (x, y, words, anchor) => {
      const node = element("text", { x, y, "text-anchor": anchor });
      node.textContent = words;
      grid.append(node);
    };
    const base = this.height - MARGIN.bottom;
    for (const v of ticks(this.low, this.high, 5)) {
      const y = this.y(v).toFixed(1);
      const ends = { x1: MARGIN.left, x2: this.width - MARGIN.right };
      grid.append(element("line", { ...ends, y1: y, y2: y, class: v ? "" : "zero" }));
      text(MARGIN.left - 6, +y + 4, number(v), "end");
    }
    for (const v of ticks(this.from, this.to, Math.max(2, Math.min(8, Math.floor(this.width / 90))))) {
      const x = this.x(v).toFixed(1);
      grid.append(element("line", { x1: x, x2: x, y1: base, y2: base + 4, class: "zero" }));
      text(x, base + 16, number(v), "middle");
    }
    const { label, unit } = this.spec.x;
    text((MARGIN.left + this.width - MARGIN.right) / 2, base + 30, unit ? `${label} (${unit})` : label, "middle");
    return grid;
  }

  line(one, tops, k) {
    const xs = this.spec.x.values;
    const starts = new Set(this.spec.pieces ?? [0]);
    const point = (i, v) => `${this.x(xs[i]).toFixed(1)} ${this.y(v).toFixed(1)}`;
    let path = "";
    let isOpen = false;
    tops[k].forEach((v, i) => {
      if (!Number.isFinite(v)) { isOpen = false; return; }
      path += `${isOpen && !starts.has(i) ? "L" : "M"}${point(i, v)}`;
      isOpen = true;
    });
    if (this.spec.stacked) {
      for (let i = xs.length - 1; i >= 0; i--) path += `L${point(i, k ? tops[k - 1][i] : 0)}`;
      return element("path", { d: `${path}Z`, fill: one.color });
    }
    if (xs.length === 1) path += `h0.01`;
    return element("path", { d: path, fill: "none", stroke: one.color, "stroke-width": xs.length === 1 ? 6 : 1.8,
      "stroke-linecap": "round", "stroke-dasharray": one.dashes?.join(" ") || null });
  }

  describe() {
    const { spec } = this;
    const ends = spec.series.map((one) => {
      const [low, high] = extremes([one.values]);
      return `${plain(one.label || spec.name)} from ${number(low)} to ${number(high)}`;
    });
    const name = `${plain(spec.name)}${spec.unit ? ` in ${spec.unit}` : ""} over ${plain(spec.x.label)}`;
    this.svg.setAttribute("aria-label", `${name}: ${ends.join(", ")}. Arrow keys read values.`);
  }

  /** Tells the values at a point; null for none. */
  readAt(i) {
    this.at = i;
    const { spec } = this;
    if (i === null) {
      this.readout.textContent = "\u00a0";
    } else {
      const value = (v) => withUnit(spec.word?.(v) ?? number(v), spec.unit);
      const texts = spec.series.map((one) => `${one.label ? `${one.label} ` : ""}${value(one.values[i])}`);
      const place = `${spec.x.short} = ${withUnit(number(spec.x.values[i]), spec.x.unit)}`;
      this.readout.replaceChildren(...typeset(`${place}: ${texts.join(", ")}`));
    }
    this.drawCursor();
  }

  drawCursor() {
    if (!this.cursor) return;
    const base = this.height - MARGIN.bottom;
    const upright = (v, name) =>
      element("line", { x1: this.x(v), x2: this.x(v), y1: MARGIN.top, y2: base, class: name });
    this.cursor.replaceChildren();
    const isMarked = this.mark !== null && this.mark >= this.from && this.mark <= this.to;
    if (isMarked) this.cursor.append(upright(this.mark, "mark"));
    if (this.at === null) return;
    this.cursor.append(upright(this.spec.x.values[this.at], "at"));
    this.tops().forEach((top, k) => {
      if (!Number.isFinite(top[this.at])) return;
      this.cursor.append(element("rect", { x: this.x(this.spec.x.values[this.at]) - 3, y: this.y(top[this.at]) - 3,
        width: 6, height: 6, fill: this.spec.series[k].color, class: "dot" }));
    });
  }

  /** Marks the time that the pictures show. */
  markAt(x) {
    this.mark = x;
    this.drawCursor();
  }

  /** Takes other values of its lines. */
  update(lists) {
    lists.forEach((list, k) => { this.spec.series[k].values = list; });
    this.draw();
    if (this.at !== null) this.readAt(Math.min(this.at, this.spec.x.values.length - 1));
    if (this.table.open) this.fillTable(this.table);
  }

  fillTable(table) {
    const { spec } = this;
    const names = [`${spec.x.short}${spec.x.unit ? ` (${spec.x.unit})` : ""}`,
      ...spec.series.map((one) => titled({ name: one.label || spec.name, unit: spec.unit }))];
    const head = element("tr", {}, names.map((name) => element("th", { scope: "col" }, name)));
    const rows = Array.from(spec.x.values, (x, i) => element("tr", {},
      [number(x, 6), ...spec.series.map((one) => spec.word?.(one.values[i]) ?? number(one.values[i], 6))]
        .map((text) => element("td", {}, text))));
    const node = element("table", { class: "numbers" }, element("thead", {}, head), element("tbody", {}, rows));
    table.replaceChildren(table.firstChild, element("div", { class: "wide tall", tabindex: 0 }, node));
  }
}
