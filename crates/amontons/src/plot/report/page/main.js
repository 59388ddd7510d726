// The slider over the run, and the start of all.

/** The bar with the slider; `seek` shows a snapshot everywhere. */
function timeBar() {
  const last = report.t.length - 1;
  const range = { type: "range", min: 0, max: last, step: 1, value: last };
  const slider = element("input", { ...range, id: "frame", "aria-label": "Time" });
  const text = element("output", { for: "frame" });
  const play = element("button", { type: "button", "aria-label": "play" }, "▶");
  let timer = null;
  const stop = () => {
    clearInterval(timer);
    timer = null;
    play.textContent = "▶";
    play.setAttribute("aria-label", "play");
  };
  const show = (frame) => {
    slider.value = frame;
    text.textContent = `${report.times[frame]}, ${frame + 1} of ${last + 1}`;
    slider.setAttribute("aria-valuetext", report.times[frame]);
    followers.forEach((follow) => follow(frame));
  };
  const seek = (frame) => {
    stop();
    show(frame);
  };
  slider.addEventListener("input", () => seek(Number(slider.value)));
  play.addEventListener("click", () => {
    if (timer) return stop();
    let frame = Number(slider.value) === last ? -1 : Number(slider.value);
    timer = setInterval(() => {
      frame += 1;
      show(frame);
      if (frame === last) stop();
    }, Math.max(80, Math.min(600, 5000 / (last + 1))));
    play.textContent = "❚❚";
    play.setAttribute("aria-label", "pause");
  });
  const name = { class: "time", role: "group", "aria-label": "Time of the pictures" };
  const node = element("div", name, play, slider, text);
  return { node, seek, show: () => show(last), isNeeded: last > 0 };
}

async function draw() {
  await unpack();
  const bar = timeBar();
  const views = [...bodySection(bar.seek), ...contactSection()];
  historySection();
  probesSection();
  if (bar.isNeeded) section("body").before(bar.node);
  bar.show();
  const redraw = () => views.forEach((view) => { view.drawNow?.(); view.redraw?.(); });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  addEventListener("beforeprint", redraw);
  addEventListener("afterprint", redraw);
}

/** A study has nothing to draw. */
async function start() {
  if (report) await draw();
  document.documentElement.dataset.ready = "yes";
}

start().catch((error) => {
  const note = element("p", { class: "fails" }, `The pictures cannot be drawn: ${error.message}`);
  document.querySelector("main").prepend(note);
  throw error;
});
