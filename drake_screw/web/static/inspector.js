// The inspector's panel. `saved_state` is that of a saved page, null where a program is behind it.
let state = null, selected = null, against = null, sample = 0, timer = null;

function drawn_of(number) { return number === null ? null : state.attempts[number].drawn; }
function drawn() { return drawn_of(selected); }

function update(next) {
  const same = state && drawn() && next.selected !== null && next.attempts[next.selected].drawn &&
    next.round === state.round &&
    String(next.instance.key) === String(state.instance.key) && next.selected === selected;
  if (!state || state.against !== next.against || next.live) against = next.against;
  state = next;
  stop();
  element("title").textContent = state.title;
  element("round-headline").textContent = state.headline;
  fill_select("round", state.rounds, state.round);
  fill_select("region", state.regions, state.region);
  element("places").hidden = element("steps").hidden = !state.live;
  element("map").innerHTML = state.map;
  const map = element("map").firstElementChild;
  map.classList.toggle("pick", state.live);
  if (state.live) map.onclick = pick;
  element("map-words").textContent = state.map_words;
  element("before").hidden = !state.before;
  if (state.before) {
    element("before-title").textContent = state.before.title;
    element("before-map").innerHTML = state.before.map;
    element("before-words").textContent = state.before.words;
  }
  element("where-it-is").textContent = state.instance.where;
  element("which").textContent = state.instance.which;
  for (const button of document.querySelectorAll("#steps button")) {
    button.disabled = !state.steps.includes(button.dataset.step);
    button.onclick = () => send({ step: button.dataset.step });
  }
  if (same) { select_attempt(selected, sample); } else { select_attempt(state.selected); }
}

function fill_select(id, options, value) {
  const select = element(id), text = JSON.stringify(options);
  if (select.dataset.options !== text) {
    select.dataset.options = text;
    select.replaceChildren(...options.map((option) => {
      const item = make("option", option.text);
      item.value = option.value === null ? "" : option.value;
      return item;
    }));
  }
  select.value = value === null ? "" : value;
  select.onchange = () => send({ [id]: select.value === "" ? null : Number(select.value) });
}

function pick(event) {
  const map = event.currentTarget;
  const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(
    map.getScreenCTM().inverse());
  const [first, down, second, right] = map.dataset.at.split(",").map(Number);
  send({ at: [first + point.y / down, second + point.x / right] });
}

function select_attempt(index, at) {
  if (index === against && index !== selected) against = selected;
  selected = index;
  scene.clear();
  element("demonstrations").replaceChildren(...state.attempts.map((attempt, i) => {
    const item = entry(attempt.number, attempt.color, `${attempt.name}: ${attempt.words}`);
    item.setAttribute("aria-current", i === selected);
    activate(item, () => (state.live ? send({ demonstration: i }) : select_attempt(i)));
    return item;
  }));
  for (const [i, attempt] of state.attempts.entries())
    if (attempt.drawn) scene.show(attempt.drawn.path, i === selected);
  list_others();
  const attempt = drawn();
  element("no-demonstration").hidden = state.attempts.length > 0;
  for (const id of ["track", "headline", "plan-part", "reach-part"]) element(id).hidden = !attempt;
  if (!attempt) { scene.apply(); return; }
  element("headline").textContent = attempt.headline;
  element("headline").style.borderColor = attempt.color;
  element("segments").replaceChildren(...attempt.segments.map((segment, i) => {
    const item = entry(i + 1, segment.color, segment.words);
    item.title = segment.status;
    activate(item, () => show_sample(attempt.at.findIndex((a) => a[0] >= i)));
    if (segment.first < 0) { item.removeAttribute("tabindex"); item.classList.add("ahead"); }
    return item;
  }));
  element("bands").replaceChildren(...attempt.segments.filter((s) => s.share > 0).map((s) => {
    const band = make("span");
    band.style.cssText = `flex: ${s.share}; background: ${s.color}`;
    return band;
  }));
  document.querySelector("#joints tbody").replaceChildren(...attempt.joints.map((joint) => {
    const row = make("tr");
    const strip = make("td", "", "strip");
    strip.innerHTML = joint.strip;
    lay_over(strip, joint.name);
    row.append(make("td", joint.name), strip, make("td"), make("td"));
    return row;
  }));
  element("reach-part").hidden = attempt.reach.length === 0;
  document.querySelector("#reach tbody").replaceChildren(...attempt.reach.map((curve) => {
    const row = make("tr"), strip = make("td", "", "strip");
    strip.innerHTML = curve.strip;
    row.append(make("td", curve.name), strip, make("td"), make("td", curve.bound));
    row.classList.toggle("limit", curve.failed);
    return row;
  }));
  element("slider").max = attempt.at.length - 1;
  show_sample(at === undefined ? attempt.start : Math.min(at, attempt.at.length - 1));
}

// The list of demonstrations that may be shown beside the selected one.
function list_others() {
  const select = element("against"), others = state.attempts.filter((_, i) => i !== selected);
  element("beside").hidden = others.length === 0 || selected === null;
  select.replaceChildren(...[null, ...others].map((attempt) => {
    const item = make("option", attempt ? `${attempt.number}: ${attempt.name}` : "no other");
    item.value = attempt ? attempt.number - 1 : "";
    return item;
  }));
  select.value = against === null ? "" : against;
  select.onchange = () => {
    const number = select.value === "" ? null : Number(select.value);
    if (state.live) { send({ against: number }); return; }
    against = number;
    select_attempt(selected, sample);
  };
  element("beside").querySelector(".chip").classList.toggle("other", against !== null);
}

// The curve of the same joint of the demonstration beside, in the strip of the selected one's.
function lay_over(strip, name) {
  const other = drawn_of(against), joint = other && other.joints.find((j) => j.name === name);
  if (!joint) return;
  const there = make("div");
  there.innerHTML = joint.strip;
  const line = there.querySelector(".angle");
  line.removeAttribute("stroke");
  line.classList.add("other");
  strip.firstElementChild.insertBefore(line, strip.querySelector(".cursor"));
}

// As far along its own plan as the selected one, or where it ended; null if there is none.
function show_beside(share) {
  for (const [i, attempt] of state.attempts.entries())
    if (attempt.drawn) scene.show(`/copies/${String(i + 1).padStart(2, "0")}`, i === against);
  const other = drawn_of(against);
  if (!other) return null;
  const total = other.segments.length, root = `/copies/${String(against + 1).padStart(2, "0")}/`;
  let at = other.at.findIndex(([segment, s]) => (segment + s) / total > share + 1e-9);
  at = Math.max(0, (at < 0 ? other.at.length : at) - 1);
  for (const name of other.copied) scene.place(root + name, other.moving["/workcell/" + name][at]);
  const [segment, s] = other.at[at];
  return { at, joints: other.joints, q: other.q[at],
    words: `demonstration ${against + 1}: segment ${segment + 1} of ${total}, ` +
      `${(100 * s).toFixed(0)} %${at + 1 === other.at.length && share < 1 ? ", its end" : ""}` };
}

function activate(item, action) {
  item.tabIndex = 0;
  item.onclick = action;
  item.onkeydown = (event) => { if (event.key === "Enter") action(); };
}

function show_sample(index) {
  const attempt = drawn();
  sample = Math.max(0, index);
  element("slider").value = sample;
  const [segment, s] = attempt.at[sample];
  const total = attempt.segments.length;
  for (const [path, poses] of Object.entries(attempt.moving)) scene.place(path, poses[sample]);
  const all = element("all-axes").checked;
  attempt.segments.forEach((s, i) => scene.show(
    `${attempt.path}/axes/${String(i + 1).padStart(2, "0")}`,
    all || i === segment || s.status === "failed"));
  scene.show(attempt.path + "/ghost", element("ghost-shown").checked);
  for (const path of Object.keys(attempt.moving))
    if (path.startsWith("/workcell/")) scene.show(path, element("arm-shown").checked);
  scene.show("instances", element("dots-shown").checked);
  const beside = show_beside((segment + s) / total);
  scene.apply();
  element("where").replaceChildren(
    make("div", `screw segment ${segment + 1} of ${total}, ${(100 * s).toFixed(0)} %`),
    ...(beside ? [make("div", beside.words, "other")] : []));
  document.querySelectorAll("#segments li").forEach((item, i) =>
    item.setAttribute("aria-current", i === segment));
  const x = 100 * (segment + s) / total;
  document.querySelectorAll("#reach tbody tr").forEach((row, i) => {
    const { values, unit } = attempt.reach[i], value = values[sample];
    row.cells[2].textContent = value === null ? "" : `${value.toPrecision(3)} ${unit}`;
    point_at(row, x);
  });
  document.querySelectorAll("#joints tbody tr").forEach((row, j) => {
    const joint = attempt.joints[j], q = attempt.q[sample][j];
    const endless = joint.lower === null;  // a joint without limits
    const margin = endless ? Infinity : Math.min(q - joint.lower, joint.upper - q);
    row.cells[2].textContent = q.toFixed(3);
    const same = beside ? beside.joints.findIndex((other) => other.name === joint.name) : -1;
    if (same >= 0) row.cells[2].append(make("div", beside.q[same].toFixed(3), "other"));
    row.cells[3].textContent = endless ? "no limit" : `${margin.toFixed(3)} ${joint.unit}`;
    row.classList.toggle("limit", margin < 1e-4);
    row.classList.toggle("near", margin >= 1e-4 && margin < 0.1);
    point_at(row, x);
  });
}

function point_at(row, x) {
  const cursor = row.querySelector(".cursor");
  cursor.setAttribute("x1", x);
  cursor.setAttribute("x2", x);
}

function stop() {
  clearInterval(timer);
  timer = null;
  element("play").textContent = "play";
}

function play() {
  if (timer) { stop(); return; }
  if (sample >= drawn().at.length - 1) show_sample(0);
  element("play").textContent = "pause";
  timer = setInterval(() => {
    if (sample >= drawn().at.length - 1) stop(); else show_sample(sample + 1);
  }, 50);
}

// Meshcat's camera counts y upwards.
function look(distance) {
  const poses = Object.entries(drawn().moving).filter(([path]) => path.startsWith("/workcell/"));
  const [x, y, z] = poses[poses.length - 1][1][sample].slice(12, 15);
  const eye = [x + 0.75 * distance, y - 0.5 * distance, z + 0.45 * distance];
  viewer.set_property(["Cameras", "default", "rotated", "<object>"], "position",
    [eye[0], eye[2], -eye[1]]);
  viewer.set_camera_target([x, z, -y]);
  viewer.set_dirty();
}

element("play").onclick = play;
element("slider").oninput = (event) => { stop(); show_sample(Number(event.target.value)); };
element("near").onclick = () => drawn() && look(0.75);
element("far").onclick = () => drawn() && look(1.9);
for (const box of document.querySelectorAll("#key input")) box.onchange = () => drawn() && show_sample(sample);
if (innerWidth < 1280) element("key").open = false;
window.dispatchEvent(new Event("resize"));
if (saved_state) update(saved_state); else listen(update);
