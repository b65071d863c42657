// The panel at which objects are moved while the arm plans.
let rows = null;
listen((state) => {
  rows ??= state.sliders.map((s, i) => slider(element("objects"), s.name, s.low, s.high,
    (value) => send({ slider: i, value })));
  for (const id of ["title", "headline", "mode", "outcome", "done"]) {
    element(id).textContent = state[id];
  }
  element("start").textContent = state.start;
  element("start").onclick = () => send({ do: "start" });
  state.sliders.forEach((s, i) => {
    if (!dragging.has(rows[i].input)) rows[i].input.value = s.value;
    rows[i].value.textContent = s.value.toFixed(3) + " " + s.unit;
  });
});
window.dispatchEvent(new Event("resize"));
