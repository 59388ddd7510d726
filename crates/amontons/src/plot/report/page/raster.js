// Pictures of triangles: a value, a depth and a triangle for every pixel.

/** The colours of a map: 256 times red, green, blue. */
const palettes = Object.fromEntries(Object.entries(report?.maps ?? {}).map(([name, text]) =>
  [name, Uint8Array.from(text.match(/../g), (c) => parseInt(c, 16))]));

class Raster {
  constructor(width, height) {
    [this.width, this.height] = [width, height];
    this.depth = new Float32Array(width * height).fill(-Infinity);
    this.value = new Float32Array(width * height).fill(NaN);
    this.light = new Float32Array(width * height);
    this.triangle = new Int32Array(width * height).fill(-1);
    this.ink = new Float32Array(width * height);
  }

  /** Draws a triangle of points [x, y, depth] with values at its corners; the nearest to the eye stays. */
  fill(points, p, q, r, values, number, light) {
    const [a, b, c] = [3 * p, 3 * q, 3 * r];
    const ax = points[a], ay = points[a + 1], bx = points[b], by = points[b + 1], cx = points[c], cy = points[c + 1];
    const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    if (!area) return;
    const va = values ? values[p] : NaN, vb = values ? values[q] : NaN, vc = values ? values[r] : NaN;
    const left = Math.max(0, Math.ceil(Math.min(ax, bx, cx) - 0.5));
    const right = Math.min(this.width - 1, Math.floor(Math.max(ax, bx, cx) - 0.5));
    const top = Math.max(0, Math.ceil(Math.min(ay, by, cy) - 0.5));
    const bottom = Math.min(this.height - 1, Math.floor(Math.max(ay, by, cy) - 0.5));
    for (let j = top; j <= bottom; j++) {
      for (let i = left; i <= right; i++) {
        const x = i + 0.5, y = j + 0.5;
        const s = ((bx - x) * (cy - y) - (by - y) * (cx - x)) / area;
        const t = ((cx - x) * (ay - y) - (cy - y) * (ax - x)) / area;
        const u = 1 - s - t;
        if (s < -1e-6 || t < -1e-6 || u < -1e-6) continue;
        const depth = s * points[a + 2] + t * points[b + 2] + u * points[c + 2];
        const at = j * this.width + i;
        if (depth <= this.depth[at]) continue;
        this.depth[at] = depth;
        this.value[at] = s * va + t * vb + u * vc;
        this.light[at] = light;
        this.triangle[at] = number;
      }
    }
  }

  /** Darkens the pixels along a line where it is not behind something. */
  line(points, p, q, ink, slack) {
    const [x0, y0, z0] = points.subarray(3 * p, 3 * p + 3);
    const [x1, y1, z1] = points.subarray(3 * q, 3 * q + 3);
    const steps = Math.max(1, Math.ceil(Math.max(Math.abs(x1 - x0), Math.abs(y1 - y0))));
    for (let k = 0; k <= steps; k++) {
      const s = k / steps;
      const [i, j] = [Math.floor(x0 + s * (x1 - x0)), Math.floor(y0 + s * (y1 - y0))];
      if (i < 0 || j < 0 || i >= this.width || j >= this.height) continue;
      const at = j * this.width + i;
      if (z0 + s * (z1 - z0) >= this.depth[at] - slack) this.ink[at] = Math.max(this.ink[at], ink);
    }
  }

  /**
   * The pixels in colours: values by a palette between two ends, what has none in the colour of foundations. Lines are
   * dark, on dark colours light; beside the body they have the colour `ink`.
   */
  image(palette, [low, high], ground, ink) {
    const image = new ImageData(this.width, this.height);
    const factor = high > low ? 255 / (high - low) : 0;
    for (let at = 0; at < this.triangle.length; at++) {
      const isDrawn = this.depth[at] > -Infinity;
      if (!isDrawn && !this.ink[at]) continue;
      const v = this.value[at];
      const place = 3 * Math.max(0, Math.min(255, Math.round(factor ? (v - low) * factor : 127)));
      const [colors, first] = this.triangle[at] < 0 ? [ground, 0] : [palette, place];
      const isDim = 0.3 * colors[first] + 0.6 * colors[first + 1] + 0.1 * colors[first + 2] < 60;
      for (let c = 0; c < 3; c++) {
        const own = colors[first + c] * (isDrawn ? this.light[at] : 1);
        const line = isDrawn ? (isDim ? 0x99 : 0x22) : ink[c];
        image.data[4 * at + c] = own + (line - own) * this.ink[at];
      }
      image.data[4 * at + 3] = isDrawn ? 255 : 255 * this.ink[at];
    }
    return image;
  }
}
