// A handle on the hand, drawn over the 3-D view: arrows move it, arcs turn it, the ball moves it in
// the plane of the screen. It has one size on the screen, whatever the camera's distance.
const ARROW = 92, RING = 64, BALL = 11, FRAME = 40, GRIP = 26, SAMPLES = 48;  // pixels, points
const SVG = "http://www.w3.org/2000/svg";
function drawn(tag, parent, attributes = {}) {
  const item = parent.appendChild(document.createElementNS(SVG, tag));
  for (const [name, value] of Object.entries(attributes)) item.setAttribute(name, value);
  return item;
}
const add = (a, b, s = 1) => a.map((v, i) => v + s * b[i]);
const dot = (a, b) => a.reduce((sum, v, i) => sum + v * b[i], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((v) => v / Math.hypot(...a));
// Quaternions have w first.
const times = ([a, b, c, d], [e, f, g, h]) => [a * e - b * f - c * g - d * h,
  a * f + b * e + c * h - d * g, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e];
const about = (axis, angle) => [Math.cos(angle / 2), ...axis.map((v) => v * Math.sin(angle / 2))];
function axes([w, x, y, z]) {
  return [[1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]];
}

// The camera, in the coordinates of the world: Meshcat's scene is turned by a quarter.
const view = {
  look() {
    const camera = viewer.camera, box = viewer.dom_element.getBoundingClientRect();
    camera.updateWorldMatrix(true, false);
    const m = camera.matrixWorld.elements, turned = (x, y, z) => [x, -z, y];
    this.eye = turned(m[12], m[13], m[14]);
    this.right = unit(turned(m[0], m[1], m[2]));
    this.up = unit(turned(m[4], m[5], m[6]));
    this.ahead = unit(turned(-m[8], -m[9], -m[10]));
    this.width = box.width;
    this.height = box.height;
    this.box = box;
    const e = camera.projectionMatrix.elements;
    this.fx = e[0] * box.width / 2;
    this.fy = e[5] * box.height / 2;
  },
  // Where a point is on the pane, in pixels, and how deep.
  pixel(p) {
    const away = add(p, this.eye, -1), deep = dot(away, this.ahead);
    return [this.width / 2 + this.fx * dot(away, this.right) / deep,
      this.height / 2 - this.fy * dot(away, this.up) / deep, deep];
  },
  // The direction in which an event's place on the pane is seen.
  ray(event) {
    const u = (event.clientX - this.box.left - this.width / 2) / this.fx;
    const v = (this.height / 2 - event.clientY + this.box.top) / this.fy;
    return unit(add(add(this.ahead, this.right, u), this.up, v));
  },
  // Where that ray meets a plane; null if it does not.
  onPlane(event, point, normal) {
    const ray = this.ray(event), fall = dot(ray, normal);
    const far = dot(add(point, this.eye, -1), normal) / fall;
    return Math.abs(fall) > 1e-3 && far > 0 ? add(this.eye, ray, far) : null;
  },
};

// How far along an axis through a point an event is.
function along(event, point, axis) {
  const ray = view.ray(event), from = add(view.eye, point, -1), b = dot(axis, ray);
  if (1 - b * b < 0.01) return null;
  return (dot(from, axis) - b * dot(from, ray)) / (1 - b * b);
}
// The angle of an event about an axis through a point, from a direction across it.
function around(event, point, axis, side) {
  const met = view.onPlane(event, point, axis);
  if (!met) return null;
  const away = add(met, point, -1);
  return Math.atan2(dot(away, cross(axis, side)), dot(away, side));
}

class Handle {
  // colors: of the axes; moved(pose): is told where the hand is dragged to.
  constructor(colors, moved) {
    this.svg = drawn("svg", viewer.dom_element, { id: "handle", "aria-hidden": "true" });
    this.moved = moved;
    this.hand = null;
    this.pull = null;
    const part = (kind, axis, color) => {
      const group = drawn("g", this.svg, { class: "grip", "data-grip": kind + (axis ?? "") });
      const lines = { group, kind, axis,
        wide: drawn("path", group, { class: "wide", "stroke-width": GRIP }),
        back: drawn("path", group, { class: "back", stroke: color }),
        line: drawn("path", group, { class: "line", stroke: color }) };
      if (kind === "move") lines.head = drawn("path", group, { class: "head", fill: color });
      group.addEventListener("pointerdown", (event) => this.take(event, kind, axis));
      group.addEventListener("pointermove", (event) => this.drag(event));
      for (const end of ["pointerup", "pointercancel"]) {
        group.addEventListener(end, () => this.release());
      }
      return lines;
    };
    this.lag = drawn("path", this.svg, { class: "lag" });
    this.frame = colors.map((color) => drawn("path", this.svg, { class: "frame", stroke: color }));
    this.parts = [...[0, 1, 2].map((i) => part("turn", i, colors[i])),
      ...[0, 1, 2].map((i) => part("move", i, colors[i])), part("slide", null, "#1c1b22")];
    this.letters = colors.map((color, i) => {
      const letter = drawn("text", this.svg, { class: "letter", fill: color });
      letter.textContent = "xyz"[i];
      return letter;
    });
    this.name = drawn("text", this.svg, { class: "name" });
    this.tell = seldom(() => this.moved([...this.p, ...this.q]));
    const each = () => { this.draw(); requestAnimationFrame(each); };
    requestAnimationFrame(each);
  }
  // hand: its name, where it is and where it is wanted (x, y, z, and a quaternion); or null.
  show(hand, leading) {
    this.hand = hand;
    this.leading = leading;
    this.stale = true;
    if (hand && !this.pull) [this.p, this.q] = [hand.wanted.slice(0, 3), hand.wanted.slice(3)];
    if (!leading) this.pull = null;
  }
  take(event, kind, axis) {
    if (event.button !== 0 || !this.leading) return;
    event.stopPropagation();  // the camera stays
    event.preventDefault();
    event.currentTarget.setPointerCapture(event.pointerId);
    const axisW = axis === null ? view.ahead : axes(this.q)[axis];
    const pull = { kind, axis: axisW, p: this.p, q: this.q, turned: 0 };
    if (kind === "move") pull.from = along(event, this.p, axisW);
    if (kind === "slide") pull.from = view.onPlane(event, this.p, axisW);
    if (kind === "turn") this.grasp(event, pull);
    if (pull.from === null) return;
    this.pull = pull;
    event.currentTarget.classList.add("held");
  }
  // A ring that is seen from its side is pulled along its tangent, any other one around.
  grasp(event, pull) {
    const out = unit(add(view.eye, this.p, -1));
    pull.side = unit(cross(pull.axis, Math.abs(pull.axis[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
    pull.flat = Math.abs(dot(out, pull.axis)) < 0.25;
    if (!pull.flat) {
      pull.from = around(event, this.p, pull.axis, pull.side);
      return;
    }
    const size = RING * view.pixel(this.p)[2] / view.fy;
    const front = unit(add(out, pull.axis, -dot(out, pull.axis)));
    const a = view.pixel(add(this.p, front, size));
    const b = view.pixel(add(add(this.p, front, size), cross(pull.axis, front), 0.01 * size));
    pull.tangent = [(b[0] - a[0]) / 0.01, (b[1] - a[1]) / 0.01];  // pixels for a radian
    pull.from = [event.clientX, event.clientY];
  }
  drag(event) {
    const pull = this.pull;
    if (!pull) return;
    if (pull.kind === "move") {
      const s = along(event, pull.p, pull.axis);
      if (s !== null) this.p = add(pull.p, pull.axis, s - pull.from);
    } else if (pull.kind === "slide") {
      const met = view.onPlane(event, pull.p, pull.axis);
      if (met) this.p = add(pull.p, add(met, pull.from, -1));
    } else if (pull.flat) {
      const moved = [event.clientX - pull.from[0], event.clientY - pull.from[1]];
      this.turn(pull, dot(moved, pull.tangent) / dot(pull.tangent, pull.tangent));
    } else {
      const angle = around(event, pull.p, pull.axis, pull.side);
      if (angle === null) return;
      let more = angle - pull.from - pull.turned;
      more -= 2 * Math.PI * Math.round(more / (2 * Math.PI));
      this.turn(pull, pull.turned + more);
    }
    this.stale = true;
    this.tell();
  }
  turn(pull, angle) {
    pull.turned = angle;
    this.q = times(about(pull.axis, angle), pull.q);
  }
  release() {
    this.pull = null;
    for (const held of this.svg.querySelectorAll(".held")) held.classList.remove("held");
  }
  draw() {
    const seen = viewer.camera.matrixWorld.elements.join() + innerWidth + "," + innerHeight;
    if (!this.stale && seen === this.seen) return;
    view.look();
    this.stale = false;
    this.seen = viewer.camera.matrixWorld.elements.join() + innerWidth + "," + innerHeight;
    const deep = this.hand ? view.pixel(this.p)[2] : 0;
    this.svg.style.display = deep > 0.05 ? "" : "none";
    if (deep <= 0.05) return;
    const at = (p) => view.pixel(p).slice(0, 2).map((v) => v.toFixed(1)).join(" ");
    const scale = deep / view.fy, own = axes(this.q), here = this.hand.is.slice(0, 3);
    const mine = axes(this.hand.is.slice(3));
    for (const { group, kind, axis, wide, back, line, head } of this.parts) {
      group.style.display = this.leading ? "" : "none";
      if (kind === "slide") {
        const [u, v] = view.pixel(this.p);
        const ball = `M${u - BALL} ${v}a${BALL} ${BALL} 0 1 0 ${2 * BALL} 0a${BALL} ${BALL} 0 1 0 ${-2 * BALL} 0`;
        line.setAttribute("d", ball);
        wide.setAttribute("d", `M${u - 2} ${v}h4`);
      } else if (kind === "move") {
        const tip = add(this.p, own[axis], ARROW * scale);
        const way = `M${at(add(this.p, own[axis], 0.3 * ARROW * scale))}L${at(tip)}`;
        line.setAttribute("d", way);
        wide.setAttribute("d", way);
        const [a, b] = [view.pixel(add(this.p, own[axis], 0.84 * ARROW * scale)), view.pixel(tip)];
        const [x, y] = [b[0] - a[0], b[1] - a[1]], size = Math.hypot(x, y) || 1;
        const [nx, ny] = [-7 * y / size, 7 * x / size];
        head.setAttribute("d", `M${b[0]} ${b[1]}L${a[0] + nx} ${a[1] + ny}L${a[0] - nx} ${a[1] - ny}Z`);
      } else {
        const halves = this.ring(own, axis, scale, at);
        line.setAttribute("d", halves[0]);
        back.setAttribute("d", halves[1]);
        wide.setAttribute("d", halves[0]);
      }
    }
    this.lag.setAttribute("d", `M${at(here)}L${at(this.p)}`);
    const deepHere = view.pixel(here)[2] / view.fy;
    this.frame.forEach((path, i) =>
      path.setAttribute("d", `M${at(here)}L${at(add(here, mine[i], FRAME * deepHere))}`));
    this.letters.forEach((letter, i) => {
      const reach = this.leading ? ARROW + 13 : FRAME + 11;
      const [u, v] = view.pixel(this.leading ? add(this.p, own[i], reach * scale)
        : add(here, mine[i], reach * deepHere));
      letter.setAttribute("x", u);
      letter.setAttribute("y", v + 5);
    });
    const [u, v] = view.pixel(here);
    this.name.textContent = this.hand.name;
    this.name.setAttribute("x", u + 14);
    this.name.setAttribute("y", v - 14);
  }
  // The near and the far half of a ring.
  ring(own, axis, scale, at) {
    const [a, b] = [own[(axis + 1) % 3], own[(axis + 2) % 3]], halves = ["", ""], pen = [false, false];
    let before = null;
    for (let i = 0; i <= SAMPLES; ++i) {
      const angle = 2 * Math.PI * i / SAMPLES;
      const out = add(a.map((v) => v * Math.cos(angle)), b, Math.sin(angle));
      const p = add(this.p, out, RING * scale), near = dot(out, add(view.eye, this.p, -1)) >= 0;
      const half = near ? 0 : 1;
      if (!pen[half]) halves[half] += before ? `M${at(before)}` : `M${at(p)}`;
      halves[half] += `L${at(p)}`;
      pen[half] = true;
      pen[1 - half] = false;
      before = p;
    }
    return halves;
  }
}

// Keys move the hand: a tap by a millimetre or a degree, one that is held by more.
const WAYS = { w: [0, 1], s: [0, -1], a: [1, 1], d: [1, -1], r: [2, 1], f: [2, -1] };
function jogging(may, send) {
  addEventListener("keydown", (event) => {
    const way = WAYS[event.key.toLowerCase()], typing = "input:not([type=range]), select, textarea";
    if (!way || event.ctrlKey || event.altKey || event.metaKey || !may()) return;
    if (event.target.matches?.(typing)) return;
    const [axis, sign] = way, steps = sign * (event.repeat ? 5 : 1);
    const value = event.shiftKey ? steps * Math.PI / 180 : steps / 1000;
    send({ jog: event.shiftKey ? axis + 3 : axis, value });
  });
}
