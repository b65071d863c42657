// What all pages with a panel beside Meshcat share: its scene tree, elements, and the program.
const scene = {
  wanted: new Map(),
  place(path, matrix) { this.wanted.set("t" + path, () => viewer.set_transform(parts(path), matrix)); },
  show(path, visible) {
    this.wanted.set("v" + path, () => viewer.set_property(parts(path), "visible", visible));
  },
  apply() {
    for (const change of this.wanted.values()) change();
    viewer.set_dirty();
  },
  clear() { this.wanted.clear(); },
};
function parts(path) { return path.split("/").filter((part) => part); }
function element(id) { return document.getElementById(id); }
function make(tag, text, classes) {
  const item = document.createElement(tag);
  if (text !== undefined) item.textContent = text;
  if (classes) item.className = classes;
  return item;
}
function send(message) {
  return fetch("do", { method: "POST", headers: { "Content-Type": "application/json" },
    body: JSON.stringify(message) });
}
async function listen(update) {
  let seen = 0;
  for (;;) {
    let received = null;
    try {
      const answer = await fetch("state?after=" + seen);
      if (document.body.classList.contains("gone")) location.reload();
      if (answer.status === 200) received = await answer.json();
    } catch (error) {
      seen = 0;
      document.body.classList.add("gone");
      await new Promise((wake) => setTimeout(wake, 1000));
    }
    if (received) {
      seen = received.version;
      try { update(received.state); } catch (error) { console.error(error); }
    }
  }
}
// A list's item: its number, a chip of a colour, and words.
function entry(number, color, words) {
  const item = make("li"), chip = make("span", "", "chip");
  chip.style.background = color;
  item.append(make("span", number, "number"), chip, make("span", words));
  return item;
}
// A saved page carries its scene out after its scripts, one command at a time.
const carry_out = viewer.handle_command_bytearray.bind(viewer);
viewer.handle_command_bytearray = (bytes) => {
  carry_out(bytes);
  window.dispatchEvent(new Event("meshcat-message"));
};
window.addEventListener("meshcat-message", (() => {
  let timer;
  return () => { clearTimeout(timer); timer = setTimeout(() => scene.apply(), 40); };
})());
