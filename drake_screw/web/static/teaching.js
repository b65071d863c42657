// The panel at which a person leads the arm.
let rows = null;
// While nobody is asked for anything, the lists of a state are empty.
function build(state) {
  rows = {
    pose: state.pose.map((h, i) => slider(element("pose"), h.name, h.low, h.high,
      (value) => send({ pose: i, value }))),
    arm: state.joints.map((j, i) => slider(element("arm"), j.name, j.low, j.high,
      (value) => send({ joint: i, value }))),
  };
}
listen((state) => {
  element("lead").hidden = !state.joints.length;
  if (!rows && state.joints.length) build(state);
  element("title").textContent = state.title;
  element("headline").textContent = state.headline;
  element("message").textContent = state.message;
  element("hint").textContent = state.hint;
  element("clock").textContent = state.clock;
  for (const button of document.querySelectorAll("[data-do]")) {
    button.disabled = !state.can.includes(button.dataset.do);
    button.onclick = () => send({ do: button.dataset.do });
  }
  state.pose.forEach((h, i) => {
    const row = rows.pose[i];
    if (!dragging.has(row.input)) row.input.value = h.value;
    row.value.textContent = h.value.toFixed(3) + " " + h.unit;
    row.input.disabled = !state.leading;
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
  element("segments").replaceChildren(
    ...state.segments.map((segment, i) => entry(i + 1, segment.color, segment.words)));
});
window.dispatchEvent(new Event("resize"));
