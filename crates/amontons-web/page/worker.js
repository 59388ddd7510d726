// Runs cases and draws them, beside the page. `wasm_bindgen` is the library.
let play = null;
const answers = {
  load: ({ library }) => { wasm_bindgen.initSync({ module: library }); return {}; },
  run: ({ text, overrides, frames }) => {
    const next = new wasm_bindgen.Play(text, overrides, frames);
    play?.free();
    play = next;
    return { told: JSON.parse(play.told()) };
  },
  draw: ({ names, frame }) => ({ frame, drawn: names.map((name) => {
    try { return play.picture(name, frame); } catch { return null; }
  }) }),
};
onmessage = ({ data }) => {
  try { postMessage({ job: data.job, ...answers[data.job](data) }); }
  catch (error) { postMessage({ job: data.job, error: error instanceof Error ? error.message : String(error) }); }
};
