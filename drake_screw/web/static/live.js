// The panel beside a run that is going on.
listen((state) => {
  element("title").textContent = state.title;
  element("headline").textContent = state.headline;
  element("headline").style.borderColor = state.color;
  element("details").textContent = state.details;
  element("finished").textContent = state.finished;
  document.body.classList.toggle("finished", Boolean(state.finished));
  element("teach").hidden = !state.teach;
  element("teach").firstElementChild.href = state.teach;
  element("goal").textContent = state.goal;
  element("map").innerHTML = state.map;
  element("map-words").textContent = state.map_words;
  for (const id of ["rounds", "demonstrations"]) {
    element(id).replaceChildren(
      ...state[id].map((line) => entry(line.number, line.color, line.words)));
  }
});
window.dispatchEvent(new Event("resize"));
