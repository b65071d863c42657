// Sliders that tell the program where they are, thirty times a second at most.
const dragging = new Set();
function slider(table, name, low, high, changed) {
  const row = make("tr"), input = make("input"), value = make("td"), margin = make("td");
  Object.assign(input, { type: "range", min: low, max: high, step: (high - low) / 2000 });
  input.setAttribute("aria-label", name);
  let last = 0, later;
  const pass = () => { last = Date.now(); changed(Number(input.value)); };
  input.oninput = () => {
    clearTimeout(later);
    if (Date.now() - last > 30) pass(); else later = setTimeout(pass, 30);
  };
  input.onpointerdown = () => dragging.add(input);
  input.onpointerup = () => dragging.delete(input);
  const cell = make("td");
  cell.append(input);
  row.append(make("td", name), cell, value, margin);
  table.append(row);
  return { row, input, value, margin };
}
