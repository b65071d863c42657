// Shows one round of the run. `slides` are all rounds, as the template gives them.
const legend = document.getElementById("legend");
const show = (name, visible) => viewer.set_property(name.split("/"), "visible", visible);
function open_round(index) {
  const last = slides.length - 1, demonstrations = slides[index].demonstrations;
  slides.forEach((slide, i) => show("rounds/" + slide.name, i === index));
  for (let i = 1; i <= slides[last].demonstrations; ++i)
    show("demonstrations/" + String(i).padStart(2, "0"), i <= demonstrations);
  for (const name of ["instances", "objects"]) show(name, index === last);
  legend.querySelector("#headline").textContent = slides[index].headline;
  legend.querySelector("#details").textContent = slides[index].details;
  legend.querySelector("#instances").hidden = index !== last;
  legend.querySelectorAll("button").forEach((b, i) => b.setAttribute("aria-pressed", i === index));
  viewer.set_dirty();
}
legend.querySelectorAll("button").forEach((b, i) => { b.onclick = () => open_round(i); });
