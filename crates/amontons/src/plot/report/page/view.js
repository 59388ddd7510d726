// A surface with a field in colours: a plane body as it lies, a body in space to turn.

const SLIP = "#d55e00";
const isDark = () => matchMedia("(prefers-color-scheme: dark)").matches && !matchMedia("print").matches;

/** The foundation's line, hatched on its right. */
function hatched(pen, points) {
  const [each, length] = [9, 7];
  pen.strokeStyle = SLIP;
  pen.lineWidth = 1.6;
  pen.beginPath();
  points.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.stroke();
  pen.lineWidth = 0.7;
  pen.beginPath();
  let along = each / 2;
  for (let i = 1; i < points.length; i++) {
    const [[x, y], [u, v]] = [points[i - 1], points[i]];
    const size = Math.hypot(u - x, v - y);
    const [s, t] = [(u - x) / size, (v - y) / size];
    for (; along < size; along += each) {
      const [p, q] = [x + along * s, y + along * t];
      pen.moveTo(p, q);
      pen.lineTo(p - length * (t + 0.8 * s), q + length * (s - 0.8 * t));
    }
    along -= size;
  }
  pen.stroke();
}

/** Where an eye sees the contact with these normals: the nearer one of two before a body, turned until the contact is 35° below it. */
function onto(normals) {
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const unit = (a) => a.map((c) => c / (Math.hypot(...a) || 1));
  const sum = normals.reduce((sum, n) => sum.map((c, d) => c + n[d]), [0, 0, 0]);
  const all = normals.reduce((all, n) => all + Math.hypot(...n), 0);
  const [above, below] = [unit([0.5, -0.87, 0.62]), unit([0.5, -0.87, -0.62])];
  // Sides that face each other have no common direction.
  if (Math.hypot(...sum) <= 0.35 * all) return above;
  const n = unit(sum);
  const eye = dot(below, n) > dot(above, n) + 1e-6 ? below : above;
  const [height, sine, cosine] = [dot(eye, n), Math.sin(35 * Math.PI / 180), Math.cos(35 * Math.PI / 180)];
  if (height >= sine) return eye;
  const flat = unit(eye.map((c, d) => c - height * n[d]));
  return flat.map((c, d) => sine * n[d] + cosine * c);
}

class View {
  /** `surface` as the page has it; `name` for those who cannot see it; `changed` is called with a new field. */
  constructor(surface, name) {
    this.surface = surface;
    this.name = name;
    this.isSolid = surface.dimension === 3;
    this.points = reals(surface.points);
    this.triangles = counts(surface.triangles);
    this.outline = counts(surface.outline);
    this.mesh = counts(surface.mesh);
    this.moving = surface.moves ? surface.fields[0] : null;
    [this.field, this.frame, this.zoom, this.showsMesh] = [surface.fields[0], 0, 1, false];
    this.reset();
    this.build();
  }

  /** The first direction of view: on a side from outside, on a body from the front, turned onto its contact. */
  reset() {
    const normal = this.surface.normal ?? onto((report.contact?.sides ?? []).map((side) => side.normal));
    const size = Math.hypot(...normal) || 1;
    this.azimuth = Math.hypot(normal[0], normal[1]) > 1e-6 * size ? Math.atan2(normal[1], normal[0]) : -Math.PI / 2;
    this.elevation = Math.asin(Math.max(-1, Math.min(1, normal[2] / size)));
    this.zoom = 1;
  }

  build() {
    this.canvas = element("canvas", { tabindex: 0, role: "img" });
    this.canvas.classList.toggle("turns", this.isSolid);
    this.readout = element("p", { class: "read", "aria-live": "polite" });
    this.bar = element("div", { class: "scale" });
    const fields = this.surface.fields;
    this.choice = element("select", {}, fields.map((field, i) => element("option", { value: i }, plain(field.name))));
    this.choice.addEventListener("change", () => {
      this.field = fields[this.choice.value];
      this.draw();
      this.changed?.();
    });
    const controls = element("p", { class: "controls" }, element("label", {}, "Field ", this.choice));
    if (this.mesh.length) {
      const mesh = element("input", { type: "checkbox" });
      mesh.addEventListener("change", () => { this.showsMesh = mesh.checked; this.draw(); });
      controls.append(element("label", {}, mesh, " Mesh"));
    }
    if (this.isSolid) {
      const press = (text, label, action) => {
        const button = element("button", { type: "button", "aria-label": label }, text);
        button.addEventListener("click", () => { action(); this.draw(); });
        return button;
      };
      controls.append(
        press("◀", "turn to the left", () => this.turn(-15, 0)),
        press("▶", "turn to the right", () => this.turn(15, 0)),
        press("▲", "turn upwards", () => this.turn(0, 15)),
        press("▼", "turn downwards", () => this.turn(0, -15)),
        press("+", "larger", () => { this.zoom *= 1.25; }), press("−", "smaller", () => { this.zoom /= 1.25; }),
        press("Reset", "first view", () => this.reset()));
    }
    const hint = this.isSolid
      ? "Drag, or press arrow keys, to turn. Point at the surface, or press Shift and arrow keys, to read values."
      : "Point at the body, or press arrow keys, to read values.";
    this.caption = element("figcaption", {});
    this.node = element("figure", { class: "view" }, controls, this.canvas, this.bar, this.readout, this.caption,
      element("p", { class: "hint" }, hint));
    this.listen();
    new ResizeObserver(() => this.draw()).observe(this.node);
  }

  listen() {
    let from = null;
    const readHere = (event) => {
      const box = this.canvas.getBoundingClientRect();
      this.read((event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height);
    };
    this.canvas.addEventListener("pointerdown", (event) => {
      from = [event.clientX, event.clientY];
      if (this.isSolid) this.canvas.setPointerCapture(event.pointerId);
      readHere(event);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (this.isSolid && from && event.buttons) {
        this.turn((event.clientX - from[0]) * -0.5, (event.clientY - from[1]) * 0.5);
        from = [event.clientX, event.clientY];
        this.draw();
      } else {
        readHere(event);
      }
    });
    this.canvas.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      if ("+-".includes(event.key) && this.isSolid) {
        this.zoom *= event.key === "+" ? 1.25 : 0.8;
      } else if (!step) {
        return;
      } else if (this.isSolid && !event.shiftKey) {
        this.turn(-10 * step[0], 10 * step[1]);
      } else {
        const [x, y] = this.cross ?? [0.5, 0.5];
        this.cross = [x + 0.02 * step[0], y + 0.02 * step[1]].map((v) => Math.max(0, Math.min(1, v)));
        this.read(...this.cross);
      }
      event.preventDefault();
      this.draw();
    });
    this.canvas.addEventListener("blur", () => { this.cross = null; this.draw(); });
  }

  /** Turns the body by angles in degrees. */
  turn(azimuth, elevation) {
    this.azimuth += azimuth * Math.PI / 180;
    this.elevation = Math.max(-1.5708, Math.min(1.5708, this.elevation + elevation * Math.PI / 180));
  }

  /** Right, up and towards the eye. */
  axes() {
    if (!this.isSolid) return [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    const [a, e] = [this.azimuth, this.elevation];
    const eye = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
    return [[-Math.sin(a), Math.cos(a), 0],
      [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)], eye];
  }

  /** Positions of the nodes at a frame, displaced as far as the picture enlarges displacements. */
  places(frame) {
    if (!this.moving) return this.points;
    const dim = this.moving.arrays.length;
    const moved = Float32Array.from(this.points);
    const factor = this.surface.factor / this.moving.factor;
    for (let c = 0; c < dim; c++) {
      const u = values(this.moving, c, frame);
      for (let i = 0; i < u.length; i++) moved[3 * i + c] += factor * u[i];
    }
    return moved;
  }

  /** From places to pixels. */
  camera(width, height) {
    const axes = this.axes();
    if (!this.isSolid) {
      const [[left, right], [bottom, top]] = this.surface.window;
      const scale = Math.min(width / (right - left), height / (top - bottom));
      return { axes, scale, middle: [(left + right) / 2, (bottom + top) / 2, 0] };
    }
    this.ball ??= ball(this.points);
    return { axes, scale: this.zoom * this.fit(width, height), middle: this.ball.middle };
  }

  /** Pixels per metre with which the body fills the picture in its first view. */
  fit(width, height) {
    const now = [this.azimuth, this.elevation, this.zoom];
    this.reset();
    const [right, up] = this.axes();
    [this.azimuth, this.elevation, this.zoom] = now;
    const { middle, radius } = this.ball;
    const reach = (axis) => {
      let most = 1e-9 * radius;
      // The outline of the foundation is larger than the side on it.
      const parts = (this.surface.foundation?.[0] ?? []).map((part) => reals(part.points));
      for (const points of [this.points, ...parts]) {
        for (let i = 0; i < points.length; i += 3) {
          const along = axis.reduce((sum, a, d) => sum + a * (points[i + d] - middle[d]), 0);
          most = Math.max(most, Math.abs(along));
        }
      }
      return most;
    };
    this.reaches ??= [reach(right), reach(up)];
    return 0.46 * Math.min(width / this.reaches[0], height / this.reaches[1]);
  }

  /** Places as pixels, with their depth. */
  seen(places, camera, width, height) {
    const all = new Float32Array(places.length);
    const { axes: [right, up, eye], scale, middle } = camera;
    for (let i = 0; i < places.length; i += 3) {
      const x = places[i] - middle[0], y = places[i + 1] - middle[1], z = places[i + 2] - middle[2];
      all[i] = width / 2 + scale * (x * right[0] + y * right[1] + z * right[2]);
      all[i + 1] = height / 2 - scale * (x * up[0] + y * up[1] + z * up[2]);
      all[i + 2] = scale * (x * eye[0] + y * eye[1] + z * eye[2]);
    }
    return all;
  }

  /** Draws a frame into a raster. */
  rasterize(width, height, frame) {
    const raster = new Raster(width, height);
    const camera = this.camera(width, height);
    const points = this.seen(this.places(frame), camera, width, height);
    const shown = this.surface.foundation?.[frame] ?? [];
    if (this.isSolid) {
      for (const patch of shown) this.patch(raster, patch, camera);
    }
    const [fields, t] = [magnitudes(this.field, frame), this.triangles];
    for (let i = 0; i < t.length; i += 3) {
      raster.fill(points, t[i], t[i + 1], t[i + 2], fields, i / 3, this.isSolid ? light(points, t, i) : 1);
    }
    const slack = this.isSolid ? 0.004 * Math.min(width, height) : Infinity;
    if (this.showsMesh) {
      for (let i = 0; i < this.mesh.length; i += 2) raster.line(points, this.mesh[i], this.mesh[i + 1], 0.45, slack);
    }
    for (let i = 0; i < this.outline.length; i += 2) {
      raster.line(points, this.outline[i], this.outline[i + 1], 0.85, slack);
    }
    return { raster, camera, points };
  }

  /** The foundation behind the body, in space. */
  patch(raster, patch, camera) {
    const [, , eye] = camera.axes;
    if (patch.normal[0] * eye[0] + patch.normal[1] * eye[1] + patch.normal[2] * eye[2] > 0) return;
    const points = this.seen(reals(patch.points), camera, raster.width, raster.height);
    const t = counts(patch.triangles);
    for (let i = 0; i < t.length; i += 3) {
      raster.fill(points, t[i], t[i + 1], t[i + 2], null, -2, light(points, t, i));
    }
  }

  image(raster) {
    const isState = this.field.name === "status";
    const range = isState ? [0, 2] : this.field.shown;
    const palette = isState ? statePalette() : palettes[this.field.map];
    const ink = isDark() ? [0xee, 0xee, 0xee] : [0x22, 0x22, 0x22];
    return raster.image(palette, range, isDark() ? [0x55, 0x52, 0x4e] : [0xdd, 0xd6, 0xce], ink);
  }

  /** Width and height on the page. */
  size() {
    const width = Math.max(120, this.node.clientWidth);
    if (this.isSolid) return [width, Math.round(Math.min(0.72 * width, 540))];
    const [[left, right], [bottom, top]] = this.surface.window;
    return [width, Math.round(Math.max(120, Math.min(width * (top - bottom) / (right - left), 540)))];
  }

  draw() {
    if (!this.node.isConnected || !this.node.clientWidth) return;
    cancelAnimationFrame(this.due);
    this.due = requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    const [width, height] = this.size();
    const ratio = Math.min(devicePixelRatio || 1, Math.sqrt(1.2e6 / (width * height)));
    const { canvas } = this;
    [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
    canvas.style.height = `${height}px`;
    this.last = this.rasterize(canvas.width, canvas.height, this.frame);
    const pen = canvas.getContext("2d");
    pen.putImageData(this.image(this.last.raster), 0, 0);
    pen.scale(ratio, ratio);
    this.foreground(pen, width, height, ratio);
    this.describe();
  }

  /** Foundation, axes and the point that is read. */
  foreground(pen, width, height, ratio) {
    const { camera } = this.last;
    const at = (p) => {
      const [x, y] = this.seen(Float32Array.from(p), camera, canvas.width, canvas.height);
      return [x / ratio, y / ratio];
    };
    const canvas = this.canvas;
    const shown = this.surface.foundation?.[this.frame] ?? [];
    for (const part of shown) {
      if (!this.isSolid) {
        const flat = reals(part);
        const points = [];
        for (let i = 0; i < flat.length; i += 2) points.push(at([flat[i], flat[i + 1], 0]));
        hatched(pen, points);
      } else {
        this.rim(pen, part, camera, ratio);
      }
    }
    if (this.isSolid) this.compass(pen, height);
    if (this.cross) {
      const [x, y] = [this.cross[0] * width, this.cross[1] * height];
      pen.strokeStyle = isDark() ? "#fff" : "#000";
      pen.lineWidth = 1.5;
      pen.strokeRect(x - 5, y - 5, 10, 10);
    }
  }

  /** The outline of the foundation in front of the body. */
  rim(pen, patch, camera, ratio) {
    const [, , eye] = camera.axes;
    if (patch.normal[0] * eye[0] + patch.normal[1] * eye[1] + patch.normal[2] * eye[2] <= 0) return;
    const points = this.seen(reals(patch.points), camera, this.canvas.width, this.canvas.height);
    const edges = counts(patch.rim);
    pen.strokeStyle = SLIP;
    pen.lineWidth = 1.2;
    pen.beginPath();
    for (let i = 0; i < edges.length; i += 2) {
      pen.moveTo(points[3 * edges[i]] / ratio, points[3 * edges[i] + 1] / ratio);
      pen.lineTo(points[3 * edges[i + 1]] / ratio, points[3 * edges[i + 1] + 1] / ratio);
    }
    pen.stroke();
  }

  /** The directions of x, y and z. */
  compass(pen, height) {
    const [right, up] = this.axes();
    pen.strokeStyle = pen.fillStyle = isDark() ? "#bbb" : "#555";
    pen.font = "13px system-ui, sans-serif";
    [pen.lineWidth, pen.textAlign, pen.textBaseline] = [1.2, "center", "middle"];
    ["x", "y", "z"].forEach((name, d) => {
      const [x, y] = [34, height - 34];
      pen.beginPath();
      pen.moveTo(x, y);
      pen.lineTo(x + 22 * right[d], y - 22 * up[d]);
      pen.stroke();
      if (Math.hypot(right[d], up[d]) > 0.2) pen.fillText(name, x + 29 * right[d], y - 29 * up[d]);
    });
  }

  /** The texts beside the picture: scale, extremes, and what it shows for those who cannot see it. */
  describe() {
    const field = this.field;
    const all = magnitudes(field, this.frame);
    let [low, high] = [0, 0];
    all.forEach((v, i) => {
      if (v < all[low] || Number.isNaN(all[low])) low = i;
      if (v > all[high] || Number.isNaN(all[high])) high = i;
    });
    const isState = field.name === "status";
    const ends = isState ? shares(all)
      : `least ${withUnit(number(all[low]), field.unit)} at the node ${this.place(low)}, ` +
        `largest ${withUnit(number(all[high]), field.unit)} at the node ${this.place(high)}`;
    const when = `${this.name}, ${report.times[this.surface.at?.[this.frame] ?? this.frame]}`;
    const scale = this.surface.scale ? ` Drawn with ${this.surface.scale}.` : "";
    this.caption.replaceChildren(...typeset(`${when}: ${field.name}, ${ends}.${scale}`));
    this.canvas.setAttribute("aria-label", plain(`${when}: ${field.name}, ${ends}`));
    colorBar(this.bar, field);
  }

  /** The place of a node. */
  place(node) {
    return this.position(Array.from(this.points.subarray(3 * node, 3 * node + 3)));
  }

  position(point) {
    const { unit, factor } = this.surface.length;
    const dim = this.isSolid ? 3 : 2;
    const names = (this.surface.axes ?? ["x", "y", "z"]).slice(0, dim);
    this.far ??= extremes([this.points.map(Math.abs)])[1];
    point = point.map((v) => (Math.abs(v) < 1e-6 * this.far ? 0 : v));
    return withUnit(`(${names.join(", ")}) = (${point.slice(0, dim).map((v) => number(v * factor)).join(", ")})`, unit);
  }

  /** Tells the value at a place of the picture, from 0 to 1 in both directions. */
  read(x, y) {
    if (!this.last) return;
    const { raster, points } = this.last;
    const i = Math.min(raster.width - 1, Math.floor(x * raster.width));
    const j = Math.min(raster.height - 1, Math.floor(y * raster.height));
    const triangle = raster.triangle[j * raster.width + i];
    if (!(triangle >= 0)) {
      this.readout.textContent = "\u00a0";
      return;
    }
    const corners = [0, 1, 2].map((k) => this.triangles[3 * triangle + k]);
    const shares = inside(points, corners, i + 0.5, j + 0.5);
    const point = [0, 1, 2].map((d) => corners.reduce((sum, v, k) => sum + shares[k] * this.points[3 * v + d], 0));
    const value = raster.value[j * raster.width + i];
    const text = this.field.name === "status" ? stateName(value) : withUnit(number(value), this.field.unit);
    this.readout.replaceChildren(...typeset(`${this.field.name} ${text} at ${this.position(point)}`));
  }

  show(frame) {
    this.frame = frame;
    this.draw();
  }
}

/** A name without the signs of subscripts. */
const plain = (text) => text.replace(/[_^]\{([^}]*)\}/g, "$1");

/** Shares of three corners in a point of the picture. */
function inside(points, [a, b, c], x, y) {
  const [ax, ay, bx, by, cx, cy] = [a, b, c].flatMap((v) => [points[3 * v], points[3 * v + 1]]);
  const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
  const s = ((bx - x) * (cy - y) - (by - y) * (cx - x)) / area;
  const t = ((cx - x) * (ay - y) - (cy - y) * (ax - x)) / area;
  return [s, t, 1 - s - t];
}

/** How bright a triangle is: most where it faces the eye. */
function light(points, t, i) {
  const [a, b, c] = [3 * t[i], 3 * t[i + 1], 3 * t[i + 2]];
  const p = [0, 1, 2].map((d) => points[b + d] - points[a + d]);
  const q = [0, 1, 2].map((d) => points[c + d] - points[a + d]);
  const n = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
  return 0.72 + 0.28 * Math.abs(n[2]) / (Math.hypot(...n) || 1);
}

/** The ball about all points. */
function ball(points) {
  const axis = (d) => extremes([points.filter((_, i) => i % 3 === d)]);
  const middle = [0, 1, 2].map((d) => (axis(d)[0] + axis(d)[1]) / 2);
  let radius = 0;
  for (let i = 0; i < points.length; i += 3) {
    radius = Math.max(radius, Math.hypot(...middle.map((m, d) => points[i + d] - m)));
  }
  return { middle, radius: radius || 1 };
}

const stateName = (code) => report.states[Math.round(code)]?.[0] ?? "–";

/** `3 open, 4 stick, 5 slip`. */
function shares(codes) {
  const of = (code) => codes.reduce((sum, v) => sum + (Math.round(v) === code), 0);
  return report.states.map(([name], code) => `${of(code)} ${name}`).join(", ") + " (nodes)";
}

const rgb = (text) => text.match(/[0-9a-f]{2}/g).map((c) => parseInt(c, 16));

/** The states as a palette from 0 to 2. */
function statePalette() {
  const colors = report.states.map(([, color]) => rgb(color));
  return Uint8Array.from({ length: 768 }, (_, i) => colors[Math.min(2, Math.floor(Math.floor(i / 3) / 85.4))][i % 3]);
}

/** Fills a scale of colours with numbers, or the states with theirs. */
function colorBar(node, field) {
  const key = titled(field);
  if (node.dataset.key === key) return;
  node.dataset.key = key;
  if (field.name === "status") {
    node.replaceChildren(...report.states.map(([name, color]) => {
      const box = element("span", { class: "box" });
      box.style.background = color;
      return element("span", { class: "state" }, box, name);
    }));
    return;
  }
  const [low, high] = field.shown;
  const strip = element("canvas", { width: 256, height: 1, "aria-hidden": "true" });
  const raster = new ImageData(256, 1);
  palettes[field.map].forEach((c, i) => { raster.data[4 * Math.floor(i / 3) + i % 3] = c; });
  for (let i = 0; i < 256; i++) raster.data[4 * i + 3] = 255;
  strip.getContext("2d").putImageData(raster, 0, 0);
  const marks = ticks(low, high, 5).map((v) => {
    const mark = element("span", {}, number(v));
    mark.style.left = `${high > low ? 100 * (v - low) / (high - low) : 50}%`;
    return mark;
  });
  const more = field.extent[1] > high ? `; above ${number(high)} in one colour, up to ${number(field.extent[1])}` : "";
  node.replaceChildren(element("span", { class: "title" }, titled(field) + more), strip,
    element("div", { class: "marks" }, marks));
}
