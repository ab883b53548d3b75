/* The explorer of a sweep: sliders choose a computed cell, whose verdict is said and whose motion is drawn.
 * Data: the element #explorer (see fem/report/explorer.py). Cells are numbered as in table.csv: the last axis is the
 * fastest. x to the right, z up, rotation > 0 tilts toward +x. The address may name a cell: explorer.html#cell=12
 */
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("explorer").textContent);
  const byId = (id) => document.getElementById(id);
  const canvas = byId("stage"), pen = canvas.getContext("2d"), time = byId("time"), speed = byId("speed");
  const INK = "#1c2330", QUIET = "#55606f", STEEL = "#dfe7ee";

  const bytes = (text) => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0)).buffer;
  const outcome = new Uint8Array(bytes(data.outcome)), last = data.samples - 1;
  const motion = Object.fromEntries(Object.entries(data.motion).map(([name, { largest, values }]) =>
    [name, { unit: largest / 32767, values: new Int16Array(bytes(values)) }]));
  const sizes = data.axes.map(({ values }) => values.length);
  const strides = sizes.map((_, k) => sizes.slice(k + 1).reduce((a, b) => a * b, 1));
  const place = sizes.map((size) => Math.floor(size / 2));     // index along every axis: the chosen cell
  const cellAt = (where) => where.reduce((sum, k, axis) => sum + k * strides[axis], 0);
  const sliders = data.axes.map((_, k) => byId(`axis-${k}`));
  let cell = 0, now = 0, playing = false;

  // ---- the chosen cell --------------------------------------------------------------------------------------
  const say = () => {
    const found = data.cells[cell], word = data.outcomes[outcome[cell]];
    byId("first").textContent = found.first || `${word.label}.`;
    for (const name of ["far", "sure", "rule"]) byId(name).textContent = found[name] || "";
    byId("command").textContent = found.command;
    const where = data.axes.map(({ values }, k) => values[place[k]]).join(", ");
    byId("said").textContent = `${where}: ${byId("first").textContent}`;
    byId("chosen").parentElement.classList.toggle("fell", word.label === "overturned");
  };
  const strips = () => data.axes.forEach(({ values, marks }, k) => {
    byId(`strip-${k}`).replaceChildren(...values.map((_, i) => {
      const one = document.createElement("span"), word = data.outcomes[outcome[cell + (i - place[k]) * strides[k]]];
      one.style.background = word.colour; one.title = `${values[i]}: ${word.label}`;
      one.textContent = marks.includes(i) ? "●" : "";
      one.classList.toggle("here", i === place[k]);
      one.addEventListener("click", () => { place[k] = i; choose(); });
      return one;
    }));
    byId(`value-${k}`).textContent = values[place[k]];
    sliders[k].value = place[k];
    sliders[k].setAttribute("aria-valuetext", values[place[k]]);
  });
  const choose = () => {
    cell = cellAt(place);
    strips(); say();
    time.max = last; now = 0; show();
    history.replaceState(null, "", `#cell=${cell}`);
  };
  sliders.forEach((slider, k) => slider.addEventListener("input", () => { place[k] = Number(slider.value); choose(); }));

  const paper = data.axes.map(({ marks }) => marks[marks.length - 1]);   // 4.0 m/s2 rather than 2.4
  byId("paper").hidden = !paper.some((mark) => mark !== undefined);
  byId("paper").addEventListener("click", () => {
    paper.forEach((mark, k) => { if (mark !== undefined) place[k] = mark; });
    choose();
  });
  const seen = new Set(outcome);
  data.outcomes.forEach(({ label, colour }, k) => {
    if (!seen.has(k)) return;
    const item = document.createElement("span"), patch = document.createElement("span");
    patch.className = "swatch"; patch.style.background = colour; item.append(patch, label); byId("legend").append(item);
  });

  // ---- the motion -------------------------------------------------------------------------------------------
  const value = (name, t) => {
    const { unit, values } = motion[name], at = Math.min(Math.max((t / data.cells[cell].end) * last, 0), last);
    const i = Math.min(Math.floor(at), last - 1), first = values[cell * data.samples + i];
    return unit * (first + (at - i) * (values[cell * data.samples + i + 1] - first));
  };
  const reach = () => {       // of all samples of the cell
    const [width, height, boxes] = data.cells[cell].size, half = 0.5 * width, tall = boxes * height;
    let left = -half, right = half;
    for (let i = 0; i <= last; i++) {
      const k = cell * data.samples + i, at = (name) => motion[name].unit * motion[name].values[k];
      const x = at("x") + at("base"), lean = Math.sin(at("rotation")) * tall;
      left = Math.min(left, x - half + Math.min(lean, 0)); right = Math.max(right, x + half + Math.max(lean, 0));
    }
    return { left, right, top: Math.max(tall, width) };
  };
  let box = null, boxOf = -1;
  const draw = () => {
    const ratio = window.devicePixelRatio || 1, wide = canvas.clientWidth, high = canvas.clientHeight;
    canvas.width = Math.round(wide * ratio); canvas.height = Math.round(high * ratio);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0); pen.clearRect(0, 0, wide, high);
    const found = data.cells[cell];
    if (!found.size) return;                                  // no run, no motion
    if (boxOf !== cell) { box = reach(); boxOf = cell; }
    const margin = 16, under = 34, scale = Math.min((wide - 2 * margin) / (box.right - box.left), (high - margin - under) / (1.05 * box.top));
    const ground = high - under, X = (x) => 0.5 * wide + scale * (x - 0.5 * (box.left + box.right)), Z = (z) => ground - scale * z;
    const [width, height, boxes] = found.size, base = value("base", now);
    pen.strokeStyle = INK; pen.lineWidth = 2;
    pen.beginPath(); pen.moveTo(0, ground); pen.lineTo(wide, ground); pen.stroke();
    pen.strokeStyle = QUIET; pen.lineWidth = 1; pen.beginPath();
    const pitch = 0.25 * width, start = Math.floor((box.left - (0.5 * wide) / scale - base) / pitch);
    for (let k = start; X(base + k * pitch) < wide + 20; k++) {   // the hatching moves with the floor
      const x = X(base + k * pitch);
      pen.moveTo(x, ground); pen.lineTo(x - 9, ground + 9);
    }
    pen.stroke();
    pen.setLineDash([4, 4]);
    pen.strokeRect(X(base - 0.5 * width), Z(boxes * height), scale * width, scale * boxes * height);
    pen.setLineDash([]);
    pen.fillStyle = INK; pen.beginPath();
    pen.moveTo(X(0), ground + 13); pen.lineTo(X(0) - 5, ground + 22); pen.lineTo(X(0) + 5, ground + 22); pen.fill();
    pen.save();
    pen.translate(X(base + value("x", now)), Z(value("z", now)));
    pen.rotate(value("rotation", now));                       // the canvas turns to the right, as x points
    pen.fillStyle = STEEL; pen.strokeStyle = INK; pen.lineWidth = 1.4;
    for (let k = 0; k < boxes; k++) {
      pen.beginPath(); pen.rect(-scale * (0.5 * width + found.centre[0]), scale * (found.centre[1] - (k + 1) * height), scale * width, scale * height);
      pen.fill(); pen.stroke();
    }
    pen.restore();
  };
  const show = () => {
    const { end } = data.cells[cell];
    time.value = end ? Math.round((now / end) * last) : 0;
    byId("clock").textContent = end ? `${now.toFixed(2)} of ${end.toFixed(1)} s` : "";
    time.setAttribute("aria-valuetext", byId("clock").textContent);
    draw();
  };
  let before = null;
  const step = (stamp) => {
    if (!playing) { before = null; return; }
    const { end } = data.cells[cell];
    now += before === null ? 0 : (Number(speed.value) * (stamp - before)) / 1000;
    before = stamp;
    if (!end || now >= end) { now = end || 0; play(false); }
    show();
    requestAnimationFrame(step);
  };
  const play = (wanted) => {
    if (wanted && now >= data.cells[cell].end) now = 0;
    playing = wanted; byId("play").textContent = playing ? "Pause" : "Play";
    if (playing) requestAnimationFrame(step);
  };
  byId("play").addEventListener("click", () => play(!playing));
  time.addEventListener("input", () => { now = (Number(time.value) / last) * (data.cells[cell].end || 0); show(); });
  document.addEventListener("keydown", (event) => {
    if ((event.key === " " || event.key === "k") && !["INPUT", "BUTTON", "SELECT"].includes(event.target.tagName)) {
      event.preventDefault(); play(!playing);
    }
  });

  const asked = Number((/^#cell=(\d+)$/.exec(location.hash) || [])[1]);
  if (asked < data.cells.length) strides.forEach((stride, k) => { place[k] = Math.floor(asked / stride) % sizes[k]; });
  else paper.forEach((mark, k) => { if (mark !== undefined) place[k] = mark; });
  new ResizeObserver(draw).observe(canvas);
  choose();
})();
