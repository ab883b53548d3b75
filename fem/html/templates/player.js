/* The animation of a run: container, floor and contact forces at any instant, in step with a cursor on the curves.
 * Data: the element #run (see fem/report/animation.py). x to the right, z up, rotation > 0 tilts toward +x.
 * The address of the page may name an instant: report.html#t=3.2
 */
"use strict";
(() => {
  const run = JSON.parse(document.getElementById("run").textContent);
  const byId = (id) => document.getElementById(id);
  const canvas = byId("stage"), pen = canvas.getContext("2d");
  const controls = { play: byId("play"), time: byId("time"), speed: byId("speed"), exaggeration: byId("exaggeration"),
    forces: byId("forces"), stress: byId("stress"), mesh: byId("mesh"), view: byId("view") };
  const INK = "#1c2330", QUIET = "#55606f", STEEL = "#dfe7ee", NORMAL = "#a3211b", SHEAR = "#0b5a8a", WALL = "#c9c4bc";

  // ---- data -------------------------------------------------------------------------------------------------
  const bytes = (text) => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0)).buffer;
  const floats = (packed) => {
    const whole = new Int16Array(bytes(packed.values)), out = new Float32Array(whole.length);
    for (let i = 0; i < whole.length; i++) out[i] = whole[i] * packed.largest / 32767;
    return out;
  };
  const indices = (text) => new (run.wide ? Uint32Array : Uint16Array)(bytes(text));
  const columns = Object.fromEntries(Object.entries(run.columns).map(([name, packed]) => [name, floats(packed)]));
  const mode = new Uint8Array(bytes(run.mode));
  const points = floats(run.points), quads = indices(run.quads), edges = indices(run.edges);
  const elastic = floats(run.elastic), normals = floats(run.normal), stress = new Uint8Array(bytes(run.stress));
  const body = new Uint8Array(bytes(run.body)), bodies = run.bodies;  // of each node; the boxes of a loose stack
  const count = points.length / 2, contacts = run.contact.length;
  const last = Math.max(run.samples - 1, 0), end = last * run.step;

  // ---- state at an instant ----------------------------------------------------------------------------------
  const value = (name, t) => {
    const column = columns[name], place = Math.min(Math.max(t / run.step, 0), last), i = Math.floor(place);
    return i >= last ? column[last] : column[i] + (place - i) * (column[i + 1] - column[i]);
  };
  const modeAt = (t) => run.modes[mode[Math.min(Math.round(t / run.step), last)]];
  const frameAt = (t) => {  // the frames before and after, and how far between them
    const times = run.times;
    if (!times.length) return null;
    let a = 0, b = times.length - 1;
    if (t >= times[b]) return { a: b, b, share: 0 };
    while (b - a > 1) { const m = (a + b) >> 1; if (times[m] <= t) a = m; else b = m; }
    return { a, b, share: Math.max(0, (t - times[a]) / (times[b] - times[a])) };
  };
  const between = (array, size, frame, i) => {
    const first = array[frame.a * size + i];
    return first + frame.share * (array[frame.b * size + i] - first);
  };

  // ---- what is in view --------------------------------------------------------------------------------------
  const extents = (onFloor) => {
    const box = { left: -0.75 * run.width, right: 0.75 * run.width, top: run.height, low: 0 };
    for (let i = 0; i <= last; i++) {
      for (const { outer, height } of run.links) {
        const x = outer + (onFloor ? 0 : columns.base[i]);
        box.left = Math.min(box.left, x); box.right = Math.max(box.right, x); box.top = Math.max(box.top, height);
      }
      const lift = onFloor || !columns.lift ? 0 : columns.lift[i];
      box.low = Math.min(box.low, lift);
      for (const { suffix, hull } of bodies) {
        const rotation = columns[`rotation${suffix}`][i], c = Math.cos(rotation), s = Math.sin(rotation);
        const x0 = columns[`x${suffix}`][i] + (onFloor ? 0 : columns.base[i]), z0 = lift + columns[`z${suffix}`][i];
        for (const [x, z] of hull) {
          const right = x0 + c * x + s * z;
          box.left = Math.min(box.left, right); box.right = Math.max(box.right, right);
          box.top = Math.max(box.top, z0 - s * x + c * z);
        }
      }
    }
    return box;
  };
  const boxes = { ground: extents(false), floor: extents(true) };
  const unit = 0.17 * Math.max(run.height, run.width);  // length of the arrow of a force as large as the weight
  const below = 1.95 * unit;

  // ---- drawing ----------------------------------------------------------------------------------------------
  let now = 0;
  const draw = () => {
    const ratio = window.devicePixelRatio || 1, wide = canvas.clientWidth, high = canvas.clientHeight;
    if (canvas.width !== Math.round(wide * ratio) || canvas.height !== Math.round(high * ratio)) {
      canvas.width = Math.round(wide * ratio); canvas.height = Math.round(high * ratio);
    }
    const onFloor = controls.view.value === "floor", box = onFloor ? boxes.floor : boxes.ground;
    const margin = 14;
    const scale = Math.min((wide - 2 * margin) / (box.right - box.left), (high - 2 * margin) / (box.top - box.low + below));
    const shift = 0.5 * wide - 0.5 * scale * (box.left + box.right), ground = high - margin - scale * (below - box.low);
    const base = value("base", now), origin = onFloor ? 0 : base;
    const lift = onFloor || !columns.lift ? 0 : value("lift", now);
    const X = (x) => shift + scale * x, Z = (z) => ground - scale * (lift + z);  // z from the floor
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, wide, high);
    drawFloor(X, Z, wide, onFloor ? 0 : base, scale, ground);
    drawStops(X, Z, origin);
    drawContainer(X, Z, origin);
    drawTies(X, Z, origin);
    if (controls.forces.checked) drawForces(X, Z, scale, origin);
    readOut();
    moveCursors();
  };

  const drawFloor = (X, Z, wide, base, scale, ground) => {
    const z = Z(0), pitch = 0.25 * run.width;
    pen.strokeStyle = INK; pen.lineWidth = 2;
    pen.beginPath(); pen.moveTo(0, z); pen.lineTo(wide, z); pen.stroke();
    pen.strokeStyle = QUIET; pen.lineWidth = 1; pen.beginPath();
    const first = Math.floor((-X(0) / scale - base) / pitch) - 1;
    for (let k = first; k < first + 3000; k++) {  // the hatching moves with the floor
      const x = X(base + k * pitch);
      if (x > wide + 20) break;
      pen.moveTo(x, z); pen.lineTo(x - 9, z + 9);
    }
    pen.stroke();
    // Where the container first stood, on the floor: the distance from it is slip.
    pen.setLineDash([4, 4]);
    for (const [left, bottom, right, top] of run.rests) {
      pen.strokeRect(X(base + left), Z(top), scale * (right - left), scale * (top - bottom));
    }
    pen.setLineDash([]);
    if (controls.view.value === "ground") {  // a mark that stays, and how far the floor is from it
      pen.fillStyle = INK; pen.beginPath();  // below the words of the friction
      pen.moveTo(X(0), ground + 23); pen.lineTo(X(0) - 5, ground + 32); pen.lineTo(X(0) + 5, ground + 32); pen.fill();
    }
  };

  const links = (pulls) => run.links.filter(({ anchor, until }) => (anchor !== null) === pulls && now < until);
  const drawStops = (X, Z, origin) => {  // until they break
    pen.strokeStyle = INK; pen.fillStyle = WALL; pen.lineWidth = 1.4;
    for (const { x, outer, height } of links(false)) {
      pen.beginPath(); pen.rect(X(origin + x), Z(height), X(outer) - X(x), Z(0) - Z(height)); pen.fill(); pen.stroke();
    }
  };
  const drawTies = (X, Z, origin) => {
    pen.strokeStyle = INK; pen.lineWidth = 2.5;
    for (const { outer, anchor, node } of links(true)) {
      pen.beginPath();
      pen.moveTo(X(origin + outer), Z(anchor));
      pen.lineTo(placed[2 * node], placed[2 * node + 1]); pen.stroke();
    }
  };

  // Where the bodies are. An enlarged elastic part moves them: the loaded base points stay where they are, and a box on
  // a box stands on its corners; those of a row stand on the floor.
  const posesOf = (frame, factor, origin) => {
    let ahead = [0, 0];
    return bodies.map(({ suffix, corners }, k) => {
      if (run.row) ahead = [0, 0];
      const rotation = value(`rotation${suffix}`, now), c = Math.cos(rotation), s = Math.sin(rotation);
      const mean = (nodes, weights) => {  // elastic displacement of some nodes, as it is seen
        let ex = 0, ez = 0, sum = 0;
        nodes.forEach((i, n) => {
          ex += weights[n] * between(elastic, 2 * count, frame, 2 * i);
          ez += weights[n] * between(elastic, 2 * count, frame, 2 * i + 1); sum += weights[n];
        });
        return [(c * ex + s * ez) / sum, (c * ez - s * ex) / sum];
      };
      if (frame && factor) {
        const loads = run.contact.map((_, n) => Math.max(between(normals, contacts, frame, n), 0) + 1e-3 * run.weight);
        const [x, z] = k ? mean(corners.slice(0, 2), [1, 1]) : mean(run.contact, loads);
        ahead = [ahead[0] - (factor - 1) * x, ahead[1] - (factor - 1) * z];
      }
      const pose = { c, s, x: origin + value(`x${suffix}`, now) + ahead[0], z: value(`z${suffix}`, now) + ahead[1] };
      if (frame && factor) {
        const [x, z] = mean(corners.slice(2), [1, 1]);
        ahead = [ahead[0] + (factor - 1) * x, ahead[1] + (factor - 1) * z];
      }
      return pose;
    });
  };

  const placed = new Float32Array(2 * count);
  const drawContainer = (X, Z, origin) => {
    const frame = frameAt(now), factor = controls.exaggeration ? Number(controls.exaggeration.value) : 0;
    const poses = posesOf(frame, factor, origin);
    for (let i = 0; i < count; i++) {
      const { c, s, x: x0, z: z0 } = poses[body[i]];
      let x = points[2 * i], z = points[2 * i + 1];
      if (frame && factor) {
        x += factor * between(elastic, 2 * count, frame, 2 * i);
        z += factor * between(elastic, 2 * count, frame, 2 * i + 1);
      }
      placed[2 * i] = X(x0 + c * x + s * z); placed[2 * i + 1] = Z(z0 - s * x + c * z);
    }
    const coloured = frame && run.stress_scale > 0 && controls.stress && controls.stress.checked;
    for (let q = 0; q < quads.length; q += 4) {
      let level = 0;
      pen.beginPath();
      for (let k = 0; k < 4; k++) {
        const i = quads[q + k];
        pen[k ? "lineTo" : "moveTo"](placed[2 * i], placed[2 * i + 1]);
        if (coloured) level += 0.25 * between(stress, count, frame, i);
      }
      pen.closePath();
      const paint = coloured ? run.colours[Math.min(Math.round(level * (run.colours.length - 1) / 255), run.colours.length - 1)] : STEEL;
      pen.fillStyle = paint; pen.fill();
      const lines = controls.mesh && controls.mesh.checked;
      pen.strokeStyle = lines ? "rgba(28,35,48,.35)" : paint; pen.lineWidth = 0.6; pen.stroke();
    }
    pen.lineWidth = 1.4;
    if (quads.length || !coloured) {
      pen.strokeStyle = INK; pen.beginPath();
      for (let e = 0; e < edges.length; e += 2) {
        pen.moveTo(placed[2 * edges[e]], placed[2 * edges[e] + 1]);
        pen.lineTo(placed[2 * edges[e + 1]], placed[2 * edges[e + 1] + 1]);
      }
      pen.stroke();
    } else {  // of a mesh too fine to be sent, the outline alone carries the colours
      for (let e = 0; e < edges.length; e += 2) {
        const level = 0.5 * (between(stress, count, frame, edges[e]) + between(stress, count, frame, edges[e + 1]));
        pen.strokeStyle = run.colours[Math.round(level * (run.colours.length - 1) / 255)]; pen.lineWidth = 3;
        pen.beginPath(); pen.moveTo(placed[2 * edges[e]], placed[2 * edges[e] + 1]);
        pen.lineTo(placed[2 * edges[e + 1]], placed[2 * edges[e + 1] + 1]); pen.stroke();
      }
    }
    pen.fillStyle = "#fff"; pen.strokeStyle = INK; pen.lineWidth = 1.4;  // mass centres
    for (const { suffix } of bodies) {
      pen.beginPath(); pen.arc(X(origin + value(`x${suffix}`, now)), Z(value(`z${suffix}`, now)), 4, 0, 7); pen.fill(); pen.stroke();
    }
  };

  const arrow = (x, y, dx, dy, colour) => {  // ends at (x, y)
    const size = Math.hypot(dx, dy);
    if (size < 1) return;
    const ux = dx / size, uy = dy / size, head = Math.min(9, size);
    pen.strokeStyle = pen.fillStyle = colour; pen.lineWidth = 2.5;
    pen.beginPath(); pen.moveTo(x - dx, y - dy); pen.lineTo(x - 0.7 * head * ux, y - 0.7 * head * uy); pen.stroke();
    pen.beginPath(); pen.moveTo(x, y); pen.lineTo(x - head * ux - 0.5 * head * uy, y - head * uy + 0.5 * head * ux);
    pen.lineTo(x - head * ux + 0.5 * head * uy, y - head * uy - 0.5 * head * ux); pen.fill();
  };
  const label = (text, x, y) => {  // readable on hatches and arrows
    pen.strokeStyle = "#fff"; pen.lineWidth = 3.5; pen.lineJoin = "round"; pen.strokeText(text, x, y);
    pen.fillText(text, x, y);
  };
  const drawForces = (X, Z, scale, origin) => {
    const frame = frameAt(now), most = 1.6 * unit * scale, of = (force) => scale * unit * Math.abs(force) / run.weight;
    const total = value("normal", now), shear = value("shear", now);
    const c = Math.cos(value("rotation", now)), s = Math.sin(value("rotation", now));
    const x0 = origin + value("x", now), places = run.contact.map((i) => x0 + c * points[2 * i] + s * points[2 * i + 1]);
    let centre = 0, sum = 0;
    // Between frames the history knows the sum: the frames share it out.
    const shares = places.map((_, k) => frame ? Math.max(between(normals, contacts, frame, k), 0) : 0);
    for (let k = 0; k < contacts; k++) sum += shares[k];
    if (!(sum > 0) || Math.abs(value("rotation", now)) > 0.02 * run.angle) {  // it stands on one side
      const rightmost = places.indexOf(Math.max(...places)), leftmost = places.indexOf(Math.min(...places));
      shares.fill(0); shares[value("rotation", now) > 0 ? rightmost : leftmost] = 1; sum = 1;
    }
    places.forEach((x, k) => {
      const force = total * shares[k] / sum;
      centre += x * shares[k] / sum;
      if (force > 2e-3 * run.weight) arrow(X(x), Z(0) + 3, 0, -Math.min(of(force), most), NORMAL);
    });
    if (total > 2e-3 * run.weight) {
      pen.font = "12px system-ui, sans-serif"; pen.fillStyle = NORMAL; pen.textAlign = "left";
      const cut = of(total) > most ? " (arrow cut)" : "";
      label(`N ${kilo(total)} kN${cut}`, X(centre) + 8, Z(0) + Math.min(of(total), most) + 4);
    }
    if (Math.abs(shear) > 2e-3 * run.weight) {
      const dx = Math.sign(shear) * Math.min(of(shear), most), y = Z(0) + 14;
      arrow(X(centre) + (dx > 0 ? 6 + dx : -6 + dx), y, dx, 0, SHEAR);
      pen.font = "12px system-ui, sans-serif"; pen.fillStyle = SHEAR; pen.textAlign = dx > 0 ? "left" : "right";
      label(`T ${kilo(shear)} kN`, X(centre) + (dx > 0 ? dx + 12 : dx - 12), y + 4);
    }
  };

  // ---- words ------------------------------------------------------------------------------------------------
  const minus = (text) => text.replace(/^-(?=[0.]+$)/, "").replace("-", "−");
  const kilo = (force) => minus((force / 1e3).toFixed(Math.abs(force) < 1e5 ? 1 : 0));
  const millimetres = (length) => minus((1e3 * length).toFixed(1));
  const MOST_SHOWN = 5;  // boxes side by side; of more, the one with the largest value
  const ofBodies = (name, words) => {
    const all = bodies.map(({ suffix }) => value(`${name}${suffix}`, now));
    if (all.length <= MOST_SHOWN) return all.map(words).join(" · ");
    const most = all.reduce((best, v, k) => (Math.abs(v) > Math.abs(all[best]) ? k : best), 0);
    return `box ${most + 1}: ${words(all[most])}`;
  };
  const readOut = () => {
    const words = { clock: `${now.toFixed(3)} s`, rotation: `${ofBodies("rotation", (v) => minus((v * 180 / Math.PI).toFixed(bodies.length > 2 ? 1 : 3)))}°`,
      ratio: ofBodies("rotation", (v) => minus((v / run.angle).toFixed(bodies.length > 2 ? 2 : 3))), slip: `${ofBodies("slip", millimetres)} mm`,
      uplift: `${millimetres(value("uplift", now))} mm`,
      floor: `${millimetres(value("base", now))} mm` + (columns.lift ? `, ${millimetres(value("lift", now))} mm up` : ""),
      state: modeAt(now) };
    for (const [name, text] of Object.entries(words)) byId(`now-${name}`).textContent = text;
    controls.time.value = Math.round(now / run.step);
    if (!playing) controls.time.setAttribute("aria-valuetext",
      `${now.toFixed(3)} s, ${words.state}, rotation ${words.rotation}, ${words.ratio} of the slenderness angle`);
  };

  // ---- cursors on the curves --------------------------------------------------------------------------------
  const cursors = [...document.querySelectorAll("[data-axes]")].map((figure) => {
    const axes = JSON.parse(figure.dataset.axes), mark = document.createElement("div");
    mark.className = axes.kind === "time" ? "cursor" : "spot";
    mark.setAttribute("aria-hidden", "true");
    figure.append(mark);
    if (axes.kind === "time") {
      mark.style.top = `${100 * (1 - axes.top)}%`; mark.style.height = `${100 * (axes.top - axes.bottom)}%`;
      figure.addEventListener("click", (event) => {  // a short cut; the slider does the same
        const box = figure.getBoundingClientRect();
        const share = ((event.clientX - box.left) / box.width - axes.left) / (axes.right - axes.left);
        if (share >= 0 && share <= 1) { stop(); show(axes.x[0] + share * (axes.x[1] - axes.x[0])); }
      });
    }
    return { axes, mark };
  });
  const moveCursors = () => {
    for (const { axes, mark } of cursors) {
      const along = (v, [from, to], low, high) => low + (v - from) / (to - from) * (high - low);
      const x = axes.kind === "time" ? now : value(axes.horizontal, now) * axes.factors[0];
      mark.style.left = `${100 * along(x, axes.x, axes.left, axes.right)}%`;
      if (axes.kind !== "time") {
        mark.style.top = `${100 * (1 - along(value(axes.vertical, now) * axes.factors[1], axes.y, axes.bottom, axes.top))}%`;
      }
    }
  };

  // ---- time -------------------------------------------------------------------------------------------------
  const calm = window.matchMedia("(prefers-reduced-motion: reduce)");
  const CALM_PAUSE = 700, CALM_STEP = 0.5;  // ms between stills, simulated s from one to the next
  let playing = false, before = 0, timer = 0;
  const show = (t) => { now = Math.min(Math.max(t, 0), end); draw(); };
  const tick = (stamp) => {
    if (!playing) return;
    show(now + Number(controls.speed.value) * Math.min(stamp - before, 100) / 1e3);
    before = stamp;
    if (now >= end) stop(); else requestAnimationFrame(tick);
  };
  const calmTick = () => { show(now + CALM_STEP); if (now >= end) stop(); };
  const start = () => {
    if (now >= end) show(0);
    playing = true; controls.play.textContent = "Pause"; before = performance.now();
    if (calm.matches) timer = setInterval(calmTick, CALM_PAUSE); else requestAnimationFrame(tick);
  };
  const stop = () => {
    playing = false; clearInterval(timer); controls.play.textContent = "Play"; readOut();
  };
  const toggle = () => (playing ? stop() : start());

  controls.play.addEventListener("click", toggle);
  controls.time.max = last;
  controls.time.addEventListener("input", () => { if (playing) stop(); show(Number(controls.time.value) * run.step); });
  for (const name of ["exaggeration", "forces", "stress", "mesh", "view"]) {
    if (controls[name]) controls[name].addEventListener("change", draw);
  }
  byId("player").addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const own = event.target.tagName === "SELECT" || event.target.tagName === "BUTTON" || event.target.type === "checkbox";
    const steps = { ",": -run.step, ".": run.step, j: -0.1, l: 0.1 };
    if (event.key === "k" || (event.key === " " && !own)) { event.preventDefault(); toggle(); }
    else if (event.key in steps && event.target.tagName !== "SELECT") { stop(); show(now + steps[event.key]); }
  });
  const named = () => {
    const found = /[#&]t=([0-9.]+)/.exec(location.hash);
    if (found) { stop(); show(Number(found[1])); }
  };
  window.addEventListener("hashchange", named);
  new ResizeObserver(draw).observe(canvas);
  controls.view.value = run.follow ? "floor" : "ground";
  show(run.first);
  named();
})();
