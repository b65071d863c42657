// The panel beside a run that is going on.
listen((state) => {
  element("title").textContent = state.title;
  element("headline").textContent = state.headline;
  element("headline").style.borderColor = state.color;
  element("details").textContent = state.details;
  element("teach").hidden = !state.teach;
  element("teach").firstElementChild.href = state.teach;
  element("goal").textContent = state.goal;
  element("map").innerHTML = state.map;
  element("map-words").textContent = state.map_words;
  for (const id of ["rounds", "demonstrations"]) {
    element(id).replaceChildren(...state[id].map((line) => {
      const item = make("li"), chip = make("span", "", "chip");
      chip.style.background = line.color;
      item.append(make("span", line.number, "number"), chip, make("span", line.words));
      return item;
    }));
  }
});
element("key").innerHTML =
  `<div class="scale" style="background: linear-gradient(to right, ${SCALE.join(", ")})"></div>` +
  '<div class="ends"><span>0</span><span>failure probability</span><span>1</span></div>' +
  KEY.map(([color, text]) => `<div><i style="background: ${color}"></i>${text}</div>`).join("");
window.dispatchEvent(new Event("resize"));
