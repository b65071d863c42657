// The panel at which a person leads the arm.
let rows = null, leading = false;
const handle = new Handle(AXES, (pose) => send({ hand: pose }));
jogging(() => leading, send);
// While nobody is asked for anything, the lists of a state are empty.
function build(state) {
  rows = {
    pose: state.pose.map((h, i) => slider(element("pose"), h.name, h.low, h.high,
      (value) => send({ pose: i, value }), h.unit === "m" ? 0.001 : 1)),
    arm: state.joints.map((j, i) => slider(element("arm"), j.name, j.low, j.high,
      (value) => send({ joint: i, value }), j.unit === "m" ? 0.001 : Math.PI / 180)),
    ends: ["from", "to"].map((name) => slider(element("ends"), name, 0, 1, trim, 0.02)),
  };
}
function trim() {
  const [from, to] = rows.ends.map((row) => Number(row.input.value));
  send({ trim: [Math.min(from, to), Math.max(from, to)] });
}
listen((state) => {
  leading = state.leading;
  element("lead").hidden = !state.joints.length;
  element("shown").hidden = !state.duration;
  element("leading").hidden = !state.leading;
  if (!rows && state.joints.length) build(state);
  for (const id of ["title", "headline", "message", "hint", "clock"]) {
    element(id).textContent = state[id];
  }
  for (const button of document.querySelectorAll("[data-do]")) {
    button.disabled = !state.can.includes(button.dataset.do);
    button.onclick = () => send({ do: button.dataset.do });
  }
  handle.show(state.hand, state.leading);
  state.pose.forEach((h, i) => {
    const row = rows.pose[i];
    if (!dragging.has(row.input)) row.input.value = h.value;
    row.value.textContent = h.value.toFixed(h.unit === "m" ? 3 : 1) + " " + h.unit;
  });
  state.joints.forEach((j, i) => {
    const row = rows.arm[i];
    if (!dragging.has(row.input)) row.input.value = j.value;
    row.value.textContent = j.value.toFixed(3);
    const margin = j.margin === null ? Infinity : j.margin;  // null: a joint without limits
    row.margin.textContent = j.margin === null ? "no limit" : margin.toFixed(3) + " " + j.unit;
    row.row.className = margin < 0.01 ? "limit" : margin < 0.1 ? "near" : "";
    row.input.disabled = !state.leading;
  });
  if (state.duration) {
    rows.ends.forEach((row, i) => {
      row.input.max = state.duration;
      if (!dragging.has(row.input)) row.input.value = state.ends[i];
      row.value.textContent = state.ends[i].toFixed(2) + " s";
    });
  }
  element("chart").innerHTML = state.chart;
  for (const id of ["segments", "kept"]) {
    element(id).replaceChildren(
      ...state[id].map((line, i) => entry(i + 1, line.color, line.words)));
  }
});
window.dispatchEvent(new Event("resize"));
