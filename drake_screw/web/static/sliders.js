// Sliders that tell the program where they are, thirty times a second at most.
const dragging = new Set();
// A function that is called at most every 30 ms, the last time in any case.
function seldom(action) {
  let last = 0, later;
  const pass = () => { last = Date.now(); action(); };
  return () => {
    clearTimeout(later);
    if (Date.now() - last > 30) pass(); else later = setTimeout(pass, 30);
  };
}
function slider(table, name, low, high, changed, step = (high - low) / 2000) {
  const row = make("tr"), input = make("input"), value = make("td"), margin = make("td");
  Object.assign(input, { type: "range", min: low, max: high, step });
  input.setAttribute("aria-label", name);
  input.oninput = seldom(() => changed(Number(input.value)));
  input.onpointerdown = () => dragging.add(input);
  for (const end of ["pointerup", "pointercancel", "blur"]) {
    input.addEventListener(end, () => dragging.delete(input));
  }
  const cell = make("td");
  cell.append(input);
  row.append(make("td", name), cell, value, margin);
  table.append(row);
  return { row, input, value, margin };
}
