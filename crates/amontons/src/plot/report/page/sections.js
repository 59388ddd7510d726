// The sections that are drawn.

const section = (id) => document.getElementById(id);
const heading = (text) => element("h3", {}, text);
/** What changes with the time: functions of the number of the snapshot. */
const followers = [];
const timeAxis = (array) => ({ values: reals(array), label: "time t", short: "t", unit: report.second });

/** Pictures of a view at several times; a click shows one in full. */
function strip(view, seek) {
  const last = report.t.length - 1;
  const frames = [...new Set([0.25, 0.5, 0.75, 1].map((share) => Math.round(share * last)))];
  const draw = () => frames.forEach((frame, k) => {
    const [width, height] = view.size();
    const canvas = pictures[k].firstChild;
    [canvas.width, canvas.height] = [300, Math.round(300 * height / width)];
    canvas.getContext("2d").putImageData(view.image(view.rasterize(canvas.width, canvas.height, frame).raster), 0, 0);
  });
  const pictures = frames.map((frame) => {
    const button = element("button", { type: "button", "aria-label": `show ${report.times[frame]}` },
      element("canvas", { "aria-hidden": "true" }), report.times[frame]);
    button.addEventListener("click", () => seek(frame));
    return button;
  });
  view.redraw = draw;
  return element("div", { class: "strip" }, pictures);
}

function bodySection(seek) {
  const node = section("body");
  if (report.body?.fields.length) {
    const view = new View(report.body, "The body");
    node.append(view.node);
    if (report.t.length > 1) {
      node.append(heading("At several times"), strip(view, seek));
      view.changed = view.redraw;
      requestAnimationFrame(() => view.redraw());
    }
    followers.push((frame) => view.show(frame));
    return [view];
  }
  const { rod } = report;
  for (const field of rod?.fields ?? []) {
    const all = field.arrays[0].map((_, frame) => magnitudes(field, frame));
    const chart = new Chart({
      ...field, x: { values: reals(rod.s), label: "x", short: "x", unit: rod.unit }, y: extremes(all), tall: true,
      series: [{ label: "", color: "#0072b2", values: all[0] }],
    });
    followers.push((frame) => chart.update([all[frame]]));
    node.append(chart.node);
  }
  if (!report.body?.fields.length && !rod?.fields?.length) node.append(element("p", {}, "All fields are zero."));
  return [];
}

/** A side in the plane: over place and time, and along the side at the time of the slider. */
function lineOfSide(side, at, node) {
  const fields = side.fields;
  let field = fields[0];
  let frame = 0;
  const choice = element("select", {}, fields.map((one, i) => element("option", { value: i }, plain(one.name))));
  const places = element("div", {});
  const map = at.length > 1 && side.s !== null ? new TimeMap(side, at) : null;
  const all = () => at.map((_, k) => magnitudes(field, k));
  let chart = null;
  const build = () => {
    const lists = all();
    const isState = field.name === "status";
    chart = new Chart({
      ...field, x: { values: reals(side.s), label: "along the side", short: "s", unit: side.length.unit },
      y: isState ? [0, 2] : extremes(lists), pieces: side.pieces, tall: true,
      word: isState ? stateName : undefined, series: [{ label: "", color: "#0072b2", values: lists[frame] }],
    });
    places.replaceChildren(chart.node);
  };
  choice.addEventListener("change", () => {
    field = fields[choice.value];
    if (map) { map.field = field; map.draw(); }
    build();
  });
  node.append(element("p", { class: "controls" }, element("label", {}, "Quantity ", choice)));
  if (map) node.append(map.node);
  const when = element("h4", {}, "");
  node.append(when, places);
  build();
  followers.push((now) => {
    frame = Math.max(0, at.findLastIndex((k) => k <= now));
    when.textContent = `Along the side, ${report.times[at[frame]]}`;
    map?.show(frame);
    chart.update([magnitudes(field, frame)]);
  });
}

/** A side that is a point: over the snapshots, or its values at the only one. */
function pointOfSide(side, at, node) {
  if (at.length === 1) {
    const rows = side.fields.map((field) => {
      const value = magnitudes(field, 0)[0];
      const text = field.name === "status" ? stateName(value) : withUnit(number(value), field.unit);
      return element("tr", {}, element("th", { scope: "row" }, field.name), element("td", {}, text));
    });
    const table = element("table", { class: "rows" }, element("tbody", {}, rows));
    node.append(element("h4", {}, report.times[at[0]]), table);
    return;
  }
  for (const field of side.fields) {
    const values = Float32Array.from(at, (_, k) => magnitudes(field, k)[0]);
    const chart = new Chart({
      ...field,
      x: { values: Float32Array.from(at, (k) => report.t[k]), label: "time t", short: "t", unit: report.second },
      word: field.name === "status" ? stateName : undefined, series: [{ label: "", color: "#0072b2", values }],
    });
    followers.push((frame) => chart.markAt(report.t[frame]));
    node.append(chart.node);
  }
}

function contactSection() {
  const node = section("contact");
  if (!node || !report.contact) return [];
  const { at, sides } = report.contact;
  const views = [];
  if (!at.length) node.append(element("p", {}, "No snapshot has contact."));
  for (const side of at.length ? sides : []) {
    const part = element("div", { class: "side" }, heading(`Side “${side.name}”`));
    node.append(part);
    if (side.dimension === 3) {
      const view = new View({ ...side, at }, `The side ${side.name}`);
      part.append(view.node);
      views.push(view);
      followers.push((now) => view.show(Math.max(0, at.findLastIndex((k) => k <= now))));
    } else if (side.dimension === 2) {
      lineOfSide(side, at, part);
    } else {
      pointOfSide(side, at, part);
    }
  }
  return views;
}

const lines = (chart) => ({
  ...chart, x: timeAxis(chart.times), series: chart.series.map((one) => ({ ...one, values: reals(one.values) })),
});

function chartGrid(charts) {
  const made = charts.map((chart) => new Chart(lines(chart)));
  followers.push((frame) => made.forEach((chart) => chart.markAt(report.t[frame])));
  return element("div", { class: "charts" }, made.map((chart) => chart.node));
}

function historySection() {
  const node = section("history");
  if (!node || !report.history) return;
  node.append(chartGrid(report.history.charts));
  const { columns } = report.history;
  if (!columns.length) return;
  const choice = element("select", {}, columns.map((column, i) => element("option", { value: i }, column.name)));
  const place = element("div", {});
  let chart = null;
  const show = () => {
    chart = new Chart({ ...lines(columns[choice.value]), tall: true });
    place.replaceChildren(chart.node);
  };
  choice.addEventListener("change", show);
  show();
  followers.push((frame) => chart.markAt(report.t[frame]));
  node.append(element("div", { class: "screen" }, heading("Every column of history.csv"),
    element("p", { class: "controls" }, element("label", {}, "Column ", choice)), place));
}

function probesSection() {
  const node = section("probes");
  if (node && report.probes) node.append(chartGrid(report.probes.charts));
}
