// What happens along a side over time: place upwards, time to the right.

class TimeMap {
  /** `side` as the page has it, the snapshots `at` which it is known. */
  constructor(side, at) {
    [this.side, this.at, this.s, this.field, this.frame] = [side, at, reals(side.s), side.fields[0], 0];
    this.canvas = element("canvas", { tabindex: 0, role: "img" });
    this.readout = element("p", { class: "read", "aria-live": "polite" });
    this.bar = element("div", { class: "scale" });
    this.node = element("figure", { class: "map" }, this.canvas, this.bar, this.readout,
      element("p", { class: "hint" }, "Point at the map, or press arrow keys, to read values."));
    for (const kind of ["pointerdown", "pointermove"]) {
      this.canvas.addEventListener(kind, (event) => {
        const box = this.canvas.getBoundingClientRect();
        this.read(event.clientX - box.left, event.clientY - box.top);
      });
    }
    this.canvas.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (!step) return;
      event.preventDefault();
      const [k, i] = this.cross ?? [this.frame, Math.floor(this.s.length / 2)];
      const within = (v, most) => Math.max(0, Math.min(most, v));
      this.tell(within(k + step[0], at.length - 1), within(i + step[1], this.s.length - 1));
    });
    new ResizeObserver(() => this.draw()).observe(this.node);
  }

  times() {
    return this.at.map((frame) => report.t[frame]);
  }

  /** Ends of the stretch of time that each snapshot stands for. */
  ends() {
    const t = this.times();
    const middle = t.slice(1).map((v, k) => (v + t[k]) / 2);
    return [t[0] - (middle[0] - t[0]), ...middle, t[t.length - 1]].map((v) => Math.max(v, Math.min(0, t[0])));
  }

  show(frame) {
    this.frame = frame;
    this.draw();
  }

  draw() {
    const width = this.node.clientWidth;
    if (!width) return;
    const [height, ratio] = [260, Math.min(devicePixelRatio || 1, 2)];
    Object.assign(this.canvas, { width: width * ratio, height: height * ratio });
    this.canvas.style.height = `${height}px`;
    const pen = this.canvas.getContext("2d");
    pen.scale(ratio, ratio);
    this.box = { left: 58, right: width - 12, top: 8, bottom: height - 36 };
    const { left, right, top, bottom } = this.box;
    const ends = this.ends();
    const [from, to] = [ends[0], ends[ends.length - 1]];
    const [low, high] = extremes([this.s]);
    this.x = (t) => left + (right - left) * (t - from) / (to - from);
    this.y = (s) => bottom - (bottom - top) * (s - low) / (high - low || 1);
    const isState = this.field.name === "status";
    const [palette, shown] = isState ? [statePalette(), [0, 2]] : [palettes[this.field.map], this.field.shown];
    const places = this.ends_of_places();
    this.at.forEach((_, k) => {
      const column = magnitudes(this.field, k);
      const [x0, x1] = [this.x(ends[k]), this.x(ends[k + 1])];
      column.forEach((v, i) => {
        if (!Number.isFinite(v)) return;
        const place = 3 * Math.round(255 * Math.max(0, Math.min(1, (v - shown[0]) / (shown[1] - shown[0] || 1))));
        pen.fillStyle = `rgb(${palette[place]},${palette[place + 1]},${palette[place + 2]})`;
        const [y0, y1] = [this.y(places[i][1]), this.y(places[i][0])];
        pen.fillRect(x0, y0, x1 - x0 + 0.6, y1 - y0 + 0.6);
      });
    });
    this.frameAndMarks(pen, [from, to], [low, high]);
    colorBar(this.bar, this.field);
    const { name, unit, extent } = this.field;
    this.canvas.setAttribute("aria-label", `${plain(name)} on the side ${this.side.name} over place and time, ` +
      `from ${number(extent[0])} to ${withUnit(number(extent[1]), unit)}. Arrow keys read values.`);
  }

  /** The stretch of the side that each node stands for, within its piece. */
  ends_of_places() {
    const starts = new Set([...this.side.pieces, this.s.length]);
    return Array.from(this.s, (s, i) => [
      starts.has(i) ? s : (this.s[i - 1] + s) / 2, starts.has(i + 1) ? s : (s + this.s[i + 1]) / 2]);
  }

  frameAndMarks(pen, times, places) {
    const { left, right, top, bottom } = this.box;
    pen.strokeStyle = pen.fillStyle = isDark() ? "#ddd" : "#222";
    pen.font = "12px system-ui, sans-serif";
    pen.strokeRect(left, top, right - left, bottom - top);
    [pen.textAlign, pen.textBaseline] = ["center", "top"];
    const marks = ticks(...times, Math.max(2, Math.floor((right - left) / 90)));
    for (const t of marks) pen.fillText(number(t), this.x(t), bottom + 4);
    pen.fillText(report.second ? `time t (${report.second})` : "time t", (left + right) / 2, bottom + 20);
    [pen.textAlign, pen.textBaseline] = ["right", "middle"];
    for (const s of ticks(...places, 5)) pen.fillText(number(s), left - 5, this.y(s));
    pen.save();
    pen.translate(10, (top + bottom) / 2);
    pen.rotate(-Math.PI / 2);
    [pen.textAlign, pen.textBaseline] = ["center", "middle"];
    const { unit } = this.side.length;
    pen.fillText(unit ? `along the side (${unit})` : "along the side", 0, 0);
    pen.restore();
    pen.setLineDash([5, 4]);
    pen.strokeStyle = isDark() ? "#fff" : "#000";
    const now = this.x(this.times()[this.frame]);
    pen.beginPath();
    pen.moveTo(now, top);
    pen.lineTo(now, bottom);
    pen.stroke();
    pen.setLineDash([]);
    if (this.cross) {
      const [k, i] = this.cross;
      pen.strokeRect(this.x(this.times()[k]) - 5, this.y(this.s[i]) - 5, 10, 10);
    }
  }

  read(x, y) {
    const closest = (all, place, wanted) => all.reduce((best, v, i) =>
      (Math.abs(place(v) - wanted) < Math.abs(place(all[best]) - wanted) ? i : best), 0);
    this.tell(closest(this.times(), this.x, x), closest(Array.from(this.s), this.y, y));
  }

  tell(k, i) {
    this.cross = [k, i];
    const value = magnitudes(this.field, k)[i];
    const text = this.field.name === "status" ? stateName(value) : withUnit(number(value), this.field.unit);
    const place = `${withUnit(number(this.s[i]), this.side.length.unit)} along the side`;
    this.readout.replaceChildren(...typeset(`${this.field.name} ${text} at ${place}, ${report.times[this.at[k]]}`));
    this.draw();
  }
}
